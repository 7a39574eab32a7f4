"""``multibody-xval run``: scenarios of the catalogue, one or all of them, and measurements."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import takewhile
from typing import Any

import typer
from typer.core import TyperGroup

from multibody_xval.reports.cli import scenario
from multibody_xval.reports.cli.laws import laws
from multibody_xval.reports.cli.proofs import proofs
from multibody_xval.reports.cli.recipe import recipes
from multibody_xval.reports.cli.studies import accuracy, figure3, friction_map, work_precision
from multibody_xval.scenarios.terminal_table import print_table
from reference_lcp.errors import ParameterError

STUDIES = {
    "figure3": (figure3, "What does the paper's figure 3 show, and do its claims hold, with engines too?"),
    "accuracy": (
        accuracy, "How large are the errors of each engine, formulation and preset, compared with the exact motion?",
    ),
    "laws": (laws, "How well does the step model of each preset predict its engine over a period?"),
    "proofs": (proofs, "What is the exact transmittance at every point of the standard grids, proven?"),
    "work-precision": (
        work_precision, "How large is each engine's error to the proven value, over the time of a simulated second?",
    ),
    "friction-map": (
        friction_map, "How much friction does a sliding box meet, over its speed and its direction, in each engine?",
    ),
    "recipes": (
        recipes, "Which options make friction hold in a user's own model, in each engine, and what do they cost?",
    ),
}  # fmt: skip
"""Measurements of several points and engines, and their questions; of the first one scenarios have a few points."""


class ByName(TyperGroup):
    """A group with a command for every scenario, which is made when it is used: help on all names measurements alone.

    The catalogue takes longer to import than that help to print.
    """

    def list_commands(self, ctx: Any) -> list[str]:
        """Give the names of measurements, and of scenarios where a shell completes them."""
        asked = ctx is None or ctx.resilient_parsing
        return list(dict.fromkeys([*(scenario.names() if asked else ()), *STUDIES]))

    def get_command(self, ctx: Any, cmd_name: str) -> Any:
        """Give the command of a measurement or a scenario."""
        if cmd_name not in self.commands and cmd_name in scenario.names():
            self.commands[cmd_name] = scenario.command(cmd_name)
        return self.commands.get(cmd_name)

    def resolve_command(self, ctx: Any, args: list[str]) -> Any:
        """Give the command that is named; of a name that is none, the message has those most like it."""
        _check_alone(args)
        if self.get_command(ctx, args[0]) is None:
            for name in scenario.names():
                self.get_command(ctx, name)
        return super().resolve_command(ctx, args)


def _check_alone(args: Sequence[str]) -> None:
    """Refuse a measurement with another name: a scenario's command takes others, and has points of figure 3 too."""
    name, others = args[0], list(takewhile(lambda word: not word.startswith("-"), args[1:]))
    known = {*STUDIES, *scenario.names()} if others else ()
    for own in others:
        if own in known and (name in STUDIES or own not in scenario.names()):
            alone = name if name in STUDIES else own
            raise ParameterError(f"{name} with {own}; allowed: scenarios together, or {alone} alone")


app = typer.Typer(
    name="multibody-xval run", cls=ByName, add_completion=False, rich_markup_mode=None, pretty_exceptions_enable=False
)


@app.callback(invoke_without_command=True)
def catalogue(context: typer.Context) -> None:
    """Run scenarios of the catalogue, or one of these measurements; without a name, list them all.

    `multibody-xval run` lists scenarios with their questions, `multibody-xval run NAME --help` explains one.

    Exit code 0: listed.

    Example: multibody-xval run unit-cell --engine mujoco --engine pybullet:joint
    """
    if context.invoked_subcommand is None:
        print_catalogue()


def print_catalogue() -> None:
    """Print scenarios and measurements."""
    from multibody_xval.scenarios.catalogue.all_scenarios import SCENARIOS

    scenarios = [(name, own.question) for name, own in SCENARIOS.items() if name not in STUDIES]
    print_table(("measurement", "question"), [(name, question) for name, (_, question) in STUDIES.items()])
    print_table(("scenario", "question"), scenarios)
    print("multibody-xval run NAME runs one, multibody-xval run all every scenario.")


for _name, (_study, _question) in STUDIES.items():
    app.command(_name, short_help=_question)(_study)
