"""``python -m scenarios store``: what is damaged in a store, and its intact rows in a new one."""

from pathlib import Path
from typing import Annotated

import typer

from reference_lcp.console import checked_output_file
from reference_lcp.exit_code import ExitCode
from reference_lcp.visible import visible

store_app = typer.Typer(
    help="Check a store of results, and save the intact rows of a damaged one.", no_args_is_help=True
)


@store_app.callback()
def store() -> None:
    """Check a store of results, and save the intact rows of a damaged one."""


@store_app.command()
def check(
    file: Annotated[Path, typer.Argument(help="The store. It is not changed.")],
    new: Annotated[
        Path | None, typer.Option("--salvage", metavar="NEW", help="Write the intact rows into this new store.")
    ] = None,
) -> None:
    """Read every row of a store, and say what is damaged.

    Exit code 0: everything is intact, or the intact rows are in NEW; 2: damaged, or no store; 3: NEW could not be
    written; 130: interrupted.

    Example: python -m scenarios store check results.sqlite --salvage good.sqlite
    """
    from scenarios.execution.storage.store_check import check_store, salvage

    if new is not None:
        checked_output_file("--salvage", new, [file])
    found = check_store(file)
    for text in found.damage:
        print(visible(f"{file}: {text}"))
    results, sweeps = len(found.good["answers"]), len(found.good["sweeps"])
    damages = len(found.damage) or "no"
    print(visible(f"{file}: {results} intact results, {sweeps} intact sweeps, {damages} damages"))
    if new is not None:
        salvage(found, new)
        print(visible(f"{new}: {results} results; what is missing is computed again"))
    elif found.damage:
        raise typer.Exit(ExitCode.WRONG_INPUT)
