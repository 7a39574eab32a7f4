"""``multibody-xval``: every command of the suite."""

import importlib
from functools import cache
from typing import Annotated, Any

import typer
from typer.core import TyperCommand, TyperGroup

COMMANDS = {
    "engines": ("engines", "List engines, their versions and presets."),
    "reference": ("reference", "Compute the steady state of one chain with the reference."),
    "run": ("run", "Run figure3, another measurement, or a scenario; alone it lists all."),
    "sweep": ("sweep", "Run all combinations of parameters and engines in a file."),
    "example": ("sweep", "Print a commented file of parameters for `sweep`."),
    "report": ("report", "Compare engines with the exact motion, and write a page."),
    "compare": ("compare", "Compare two results files, and print what has changed."),
    "history": ("history", "Run plain blocks in released versions of an engine."),
    "probe": ("probe", "Measure what creeps in your MuJoCo model, and what helps."),
    "reproduce": ("reproduce", "Print a script that shows a number in an engine's own API."),
    "recipe": ("recipe", "Print what to write in your model so that friction holds."),
    "translate": ("translate", "Find options of another engine with which boxes move the same."),
    "truth": ("truth", "List problems with an exact motion, and check any program."),
}
"""The module of `multibody_xval.reports.cli` that has each command, and what the command does in a sentence."""


class HelpAlone(TyperGroup):
    """A group that shows its help where no command is given."""

    def parse_args(self, ctx: Any, args: list[str]) -> list[str]:
        """Take the words that were typed."""
        return super().parse_args(ctx, args or ["--help"])


class CommandsOnUse(HelpAlone):
    """A group that imports the module of a command when that is used: its help needs none of them."""

    def list_commands(self, ctx: Any) -> list[str]:
        """Give the names, in the order of the work."""
        return list(COMMANDS)

    def get_command(self, ctx: Any, cmd_name: str) -> Any:
        """Give what help and suggestions need of a command: its name and its sentence."""
        if cmd_name not in COMMANDS:
            return None
        return TyperCommand(cmd_name, help=COMMANDS[cmd_name][1])

    def resolve_command(self, ctx: Any, args: list[str]) -> Any:
        """Give the command itself, with the arguments that are left for it."""
        self.commands = {name: self.get_command(ctx, name) for name in COMMANDS}  # of which typer suggests one
        name, _, rest = super().resolve_command(ctx, args)
        return name, loaded(name), rest


@cache  # that of `run` takes longer to make than its help to print
def loaded(name: str | None) -> Any:
    """Import a command of `COMMANDS`: one of its module, or the only one that this has."""
    module = importlib.import_module(f"multibody_xval.reports.cli.{COMMANDS[str(name)][0]}")
    command: Any = typer.main.get_command(module.app)
    return getattr(command, "commands", {}).get(name, command)


app = typer.Typer(
    name="multibody-xval", cls=CommandsOnUse, add_completion=True, rich_markup_mode=None, pretty_exceptions_enable=False
)


def print_version(wanted: bool) -> None:
    """Print the version of the suite, and end."""
    if wanted:
        from importlib.metadata import version

        print(f"multibody-xval {version('multibody-xval')}")
        raise typer.Exit


@app.callback()
def multibody_xval(
    version: Annotated[
        bool, typer.Option("--version", callback=print_version, is_eager=True, help="Print the version, and end.")
    ] = False,
) -> None:
    """Check how well multibody engines simulate dry friction.

    Exit codes: 0 done; 1 a comparison failed; 2 wrong input; 3 output could not be written; 4 a fault of the suite;
    130 interrupted.

    Example: multibody-xval report --quick --engine mujoco
    """
