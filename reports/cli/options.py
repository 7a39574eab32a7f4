"""Options that several commands have in common, and their checks; see `evaluation`."""

import shlex
from collections.abc import Iterable, Sequence
from pathlib import Path
from typing import Annotated

import typer

from engines.completion import complete_variant
from reference_lcp.errors import ParameterError
from reference_lcp.output import checked_output_file

NAME_METAVAR = "NAME[:FORMULATION[:PRESET]]"

ENGINE_HELP = (
    "An engine; without FORMULATION and PRESET, its joint with the preset tuned. `all` stands for all engines, "
    "formulations or presets. May be repeated. "
)

Chosen = Annotated[
    list[str] | None,
    typer.Option(
        "--engine",
        metavar=NAME_METAVAR,
        help=f"{ENGINE_HELP}Without it: all:all:all.",
        autocompletion=complete_variant,
    ),
]
Settings = Annotated[
    list[str] | None,
    typer.Option(
        "--set",
        metavar="OPTION=VALUE",
        help="Change an option of the only --engine; may be repeated. The same as --engine NAME:OPTION=VALUE.",
    ),
]
Store = Annotated[
    Path | None,
    typer.Option(help="File that stores every result; a stopped run continues from it. Without it, nothing is stored."),
]
TableFile = Annotated[Path | None, typer.Option(help="Write the table here: Markdown as .md, full precision as .csv.")]
Workers = Annotated[int | None, typer.Option(help="Number of worker processes; without it, one for each processor.")]
Limit = Annotated[
    float, typer.Option(help="Time limit of a batch of points, in seconds; an engine that hangs is then stopped.")
]
Scheduler = Annotated[
    str | None, typer.Option(help="Address of a dask scheduler; its workers compute instead of this machine.")
]
Retry = Annotated[
    bool,
    typer.Option(
        "--retry-blocked",
        help="Run again the stored points at which an engine failed: it crashed, raised an error or passed the time "
        "limit.",
    ),
]


TABLE_ENDINGS = (".md", ".csv")
"""Formats of a `TableFile`."""


def check_out(out: Path | None, endings: tuple[str, ...], inputs: Iterable[Path | None]) -> None:
    """Refuse a file that cannot be written, whose ending names no format, or that is one of `inputs`."""
    if out is None:
        return
    if out.suffix not in endings:
        raise ParameterError(f"--out = {out} has the ending {out.suffix!r}; allowed: {' or '.join(endings)}")
    checked_output_file("--out", out, inputs)


def check_outs(outs: Sequence[Path] | None, endings: tuple[str, ...], inputs: Sequence[Path | None]) -> list[Path]:
    """Give the files of an option that may be repeated; refuse what `check_out` refuses, and a file named twice."""
    checked: list[Path] = []
    for out in outs or ():
        check_out(out, endings, [*inputs, *checked])
        checked.append(out)
    return checked


def check_retry(run: bool, retry_blocked: bool) -> None:
    """Refuse to run points again where nothing is run."""
    if retry_blocked and not run:
        raise ParameterError("--retry-blocked with --no-run, which runs nothing; allowed: one of the two")


def with_settings(chosen: Sequence[str] | None, settings: Sequence[str] | None) -> list[str]:
    """Give the chosen names, of which the only one has the settings too."""
    names = list(chosen or [])
    if not settings:
        return names
    if len(names) != 1:
        problem = f"--set {settings[0]} beside {len(names)} --engine"
        raise ParameterError(f"{problem}; allowed: one, or --engine NAME:OPTION=VALUE for each")
    return [":".join([names[0], *settings])]


def command_text(name: str, chosen: Sequence[str] | None, options: Sequence[str] = ()) -> str:
    """Give the command that made a document: `run` with its name, the chosen engines and other options."""
    return shlex.join(["multibody-xval", "run", name, *(f"--engine={c}" for c in chosen or []), *options])
