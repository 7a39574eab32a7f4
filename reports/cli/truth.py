"""``multibody-xval truth``: benchmark problems with their exact motion, and what is judged by them."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Annotated, Any

import typer

from multibody_xval.reports.cli.console_script import HelpAlone
from multibody_xval.reports.cli.exit_code import ExitCode
from multibody_xval.scenarios.terminal_table import print_table

app = typer.Typer(name="multibody-xval", add_completion=False, rich_markup_mode=None, pretty_exceptions_enable=False)
truth_app = typer.Typer(cls=HelpAlone, rich_markup_mode=None)

Name = Annotated[str, typer.Argument(metavar="NAME", help="The problem; `truth list` has the names.")]


@truth_app.callback()
def truth_group() -> None:
    """List benchmark problems with their exact motion, and judge a motion that any program wrote.

    Example: multibody-xval truth list
    """


@truth_app.command("list")
def list_problems() -> None:
    """List the problems.

    Exit code 0: listed.

    Example: multibody-xval truth list
    """
    from multibody_xval.scenarios.truth import problems

    rows = [(each.name, str(len(each.masses)), f"{each.time_step:.4g}", each.title) for each in problems().values()]
    print_table(("problem", "bodies", "step [s]", "what"), rows)


@truth_app.command()
def show(name: Name) -> None:
    """Print the file of a problem: what to build, its exact motion, what a step may be off.

    Exit code 0: printed.

    Example: multibody-xval truth show block-stops
    """
    from multibody_xval.scenarios.truth.problem import problem_named, text_of

    print(text_of(problem_named(name)), end="")


@truth_app.command()
def check(
    name: Name,
    motion: Annotated[
        Path,
        typer.Argument(help="CSV file: `time` in s, `x0`, `x1` … in m of every body, and perhaps `v0`, `v1` … in m/s."),
    ],
    *,
    time_step: Annotated[
        float | None, typer.Option(help="Step in s of the program that wrote it; without it, that of the problem.")
    ] = None,
) -> None:
    """Compare a motion that any program wrote with the exact one: a row a body, held, slid or stuck in the end.

    It has a row at each of the problem's times, and may have others. What it may be off is in proportion to the step.
    Exit code 0: within what a step of first order may be off; 1: beyond.

    Example: multibody-xval truth check block-stops motion.csv --time-step 0.001
    """
    from multibody_xval.scenarios.table_text import records
    from multibody_xval.scenarios.truth import judged, problem_named, read_motion

    problem = problem_named(name)
    found = judged(problem, read_motion(motion, problem), time_step)
    print_table(
        ("body", "result", "exact", "motion", "off by", "allowed", "at [s]"), [_row(own) for own in records(found)]
    )
    off = int((found.verdict == "deviates").sum())
    beyond = f"{off} of {len(found)} bodies deviate from the exact motion"
    print(beyond if off else "The motion agrees with the exact one.")
    if off:
        raise typer.Exit(ExitCode.FAILED)


def _row(own: dict[str, Any]) -> list[str]:
    """Give the texts of a body: its position, and below that its velocity, if the motion has one."""
    parts = [
        [f"{own[f'{name}_off']:.4g} {unit}", f"{own[f'{name}_allowed']:.4g} {unit}", f"{own[f'{name}_time']:.4g}"]
        for name, unit in (("position", "m"), ("velocity", "m/s"))
        if not math.isnan(own[f"{name}_off"])
    ]
    labels = [str(own[name]) for name in ("body", "verdict", "exact", "motion")]
    return [*labels, *("\n".join(texts) for texts in zip(*parts, strict=True))]


app.add_typer(truth_app, name="truth")
