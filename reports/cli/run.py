"""``multibody-xval run``: scenarios of the catalogue, one or all of them, and measurements."""

from __future__ import annotations

from typing import Any

import typer
from typer.core import TyperGroup

from multibody_xval.reports.cli import scenario
from multibody_xval.reports.cli.laws import laws
from multibody_xval.reports.cli.proofs import proofs
from multibody_xval.reports.cli.recipe import recipes
from multibody_xval.reports.cli.studies import accuracy, figure3, work_precision
from reference_lcp.terminal import print_table

STUDIES = {
    "figure3": figure3, "accuracy": accuracy, "work-precision": work_precision, "laws": laws, "proofs": proofs,
    "recipes": recipes,
}  # fmt: skip
"""Measurements of several points and engines; the first one answers the paper's claims too."""

EXPERIMENTS = {
    "accuracy": "How large are the errors of each engine, formulation and preset, compared with the exact motion?",
    "laws": "How well does the law of each preset predict its engine over a period?",
    "proofs": "What is the exact transmittance at every point of the standard grids, proven?",
    "work-precision": "How large is each engine's error to the proven value, over the time of a simulated second?",
    "recipes": "Which options make friction hold in a user's own model, in each engine, and what do they cost?",
}


class ByName(TyperGroup):
    """A group with a command for every scenario, which is made when it is used."""

    def list_commands(self, ctx: Any) -> list[str]:
        """Give the names of scenarios, then those of measurements."""
        return list(dict.fromkeys([*scenario.names(), *self.commands]))

    def get_command(self, ctx: Any, cmd_name: str) -> Any:
        """Give the command of a measurement or a scenario."""
        if cmd_name not in self.commands and cmd_name in scenario.names():
            self.commands[cmd_name] = scenario.command(cmd_name)
        return self.commands.get(cmd_name)

    def resolve_command(self, ctx: Any, args: list[str]) -> Any:
        """Give the command that is named; of a name that is none, the message has those most like it."""
        if self.get_command(ctx, args[0]) is None:
            for name in scenario.names():
                self.get_command(ctx, name)
        return super().resolve_command(ctx, args)


app = typer.Typer(name="multibody-xval run", cls=ByName, add_completion=False, pretty_exceptions_enable=False)


@app.callback(invoke_without_command=True)
def catalogue(context: typer.Context) -> None:
    """Run a scenario of the catalogue, all of them, or a measurement; without a name, list them.

    Exit code 0: listed; 2: wrong input; 130: interrupted.

    Example: multibody-xval run unit-cell --engine mujoco --engine pybullet:joint
    """
    if context.invoked_subcommand is None:
        print_catalogue()


def print_catalogue() -> None:
    """Print scenarios and measurements."""
    from multibody_xval.scenarios.catalogue.all_scenarios import SCENARIOS

    print_table(("scenario", "question"), [(name, own.question) for name, own in SCENARIOS.items()])
    print_table(("measurement", "question"), list(EXPERIMENTS.items()))
    print("multibody-xval run NAME runs one, multibody-xval run all every scenario.")


for _name, _study in STUDIES.items():
    app.command(_name)(_study)
