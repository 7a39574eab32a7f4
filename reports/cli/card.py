"""``python -m reports card``: the numbers of one engine that its maintainer would quote."""

from pathlib import Path
from typing import Annotated

import typer

from engines.completion import complete_engine
from scenarios.cli.options import Limit, Store, Workers
from scenarios.execution.limits import TIME_LIMIT


def card(
    engine: Annotated[
        str, typer.Argument(metavar="NAME", help="The engine, or NAME@VERSION.", autocompletion=complete_engine)
    ],
    out: Annotated[Path, typer.Option(help="Folder of the card; made if it is missing.")] = Path("report"),
    store: Store = None,
    workers: Workers = None,
    time_limit: Limit = TIME_LIMIT,
) -> None:
    """Write the card of an engine as HTML, Markdown and JSON: its errors to the truth, default and tuned.

    Results that the store lacks are computed: about a hundred steady states a preset. A report that is written into the
    same folder afterwards links the card.
    Exit code 0: the card is written; 2: wrong input, or the engine is not installed; 3: results or the card could not
    be written; 130: interrupted.

    Example: python -m reports card mujoco --store results.sqlite
    """
    from reports.cli.cards import write_engine_card

    write_engine_card(engine, out, store, workers, time_limit)
