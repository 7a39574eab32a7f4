"""Tables in a terminal."""

from rich import box
from rich.console import Console
from rich.markup import escape
from rich.table import Table


def printed_table(*headings: str) -> Table:
    """Give an empty table; columns of names (with a colon in the heading) are not wrapped."""
    table = Table(box=box.SIMPLE_HEAD, padding=(0, 1, 0, 0))
    for heading in headings:
        table.add_column(escape(heading), no_wrap=":" in heading)
    return table


def print_table(table: Table) -> None:
    """Print a table as wide as its rows are: numbers are never cut off."""
    width = Console(width=WIDEST).measure(table).maximum
    Console(width=max(Console().width, width)).print(table)


WIDEST = 1000
"""More characters than the longest row has."""
