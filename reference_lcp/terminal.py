"""What people see on a terminal: how far a work is, and texts of others shown and not obeyed."""

import re
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from typing import TypeVar

_CONTROLS = re.compile(
    "["
    "\x00-\x1f\x7f-\x9f"  # C0 with line feeds and escape sequences, C1
    "\u061c\u200e\u200f\u2028-\u202e\u2066-\u2069"  # the order in which letters are shown, and ends of lines
    "\ud800-\udfff"  # bytes of file names that are no UTF-8
    "\ufffe\uffff"  # no characters; XML refuses them
    "]"
)

_Item = TypeVar("_Item")


def visible(text: str) -> str:
    r"""Give a text in one line that no terminal obeys: an escape character becomes the letters ``\x1b``."""
    return _CONTROLS.sub(lambda control: control[0].encode("unicode_escape").decode(), text)


def tracked(items: Sequence[_Item], unit: str) -> Iterator[_Item]:
    """Give items one after the other, with a bar on a terminal."""
    with counted(unit, len(items)) as advance:
        for item in items:
            yield item
            advance()


@contextmanager
def counted(unit: str, total: int) -> Iterator[Callable[[], None]]:
    """Show on a terminal how many of so many are done; gives what counts one."""
    from rich.console import Console
    from rich.progress import Progress

    console = Console(stderr=True)
    with Progress(console=console, transient=True, disable=not console.is_terminal) as progress:
        bar = progress.add_task(unit, total=total)
        yield lambda: progress.advance(bar)
