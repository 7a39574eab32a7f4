"""``python -m engines``: which engines there are, what they can do, and which are installed."""

if __name__ == "__main__":
    from reference_lcp.interrupt import heed_interrupts
    from reference_lcp.shadow import refuse_shadows

    heed_interrupts()
    refuse_shadows()

# isort: split
import json
import sys
from typing import Annotated, Any

import typer

from engines.completion import complete_engine, complete_variant
from reference_lcp.console import run_command
from reference_lcp.exit_code import ExitCode
from reference_lcp.visible import visible

app = typer.Typer(name="python -m engines", add_completion=False, pretty_exceptions_enable=False)


@app.callback(invoke_without_command=True)
def engines(
    context: typer.Context, as_json: Annotated[bool, typer.Option("--json", help="Print JSON.")] = False
) -> None:
    """List every registered engine: version, friction law and presets, and why it is missing if it is.

    Exit code 0: listed, installed or not; 2: wrong input; 130: interrupted.

    Example: python -m engines --json
    """
    if context.invoked_subcommand is not None:
        return
    from engines.interface.registry import registered_names

    rows = [described(name) for name in registered_names()]
    if as_json:
        print(json.dumps(rows, indent=2))
    else:
        _print(rows)


@app.command()
def law(
    name: Annotated[
        str,
        typer.Argument(metavar="NAME[:FORMULATION[:PRESET]]", help="The variant.", autocompletion=complete_variant),
    ],
) -> None:
    """Print the law of a preset: its formula, its constants and their origin, and the distance between engine and law.

    Exit code 0: printed; 2: wrong input; 130: interrupted.

    Example: python -m engines law mujoco:joint:default
    """
    from engines.interface.variant import Variant
    from engines.law_command import print_law

    print_law(Variant.parse(name))


@app.command(name="install")
def install_engine(
    name: Annotated[
        str,
        typer.Argument(
            metavar="NAME[@VERSION]",
            help="The engine, or a version of it.",
            autocompletion=complete_engine,
        ),
    ],
    python: Annotated[
        str | None,
        typer.Option(help="Version or path of a Python of this machine; without it, the one that runs the suite."),
    ] = None,
    agreed: Annotated[
        bool,
        typer.Option(
            "--yes", help="Agree to the terms of an engine that is not free software; without it, the command asks."
        ),
    ] = False,
) -> None:
    """Install an engine, or a version of it, into an environment of its own.

    The size is printed first. If the engine is not free software, the command prints its licence and asks, before
    anything is downloaded.

    A version is a prefix: mujoco@3 is the newest MuJoCo 3. Environments are in the user's cache, or in the folder
    MULTIBODY_XVAL_ENVIRONMENTS.

    Exit code 0: installed; 2: wrong input, or it cannot be installed here; 130: interrupted.

    Example: python -m engines install mujoco@3.3.7
    """
    from engines.environments_command import install_engine as install

    install(name, python, agreed=agreed)


environments = typer.Typer()
app.add_typer(environments, name="environments")


@environments.callback(invoke_without_command=True)
def list_environments(context: typer.Context) -> None:
    """List all environments with their sizes and problems.

    Exit code 0: listed; 2: wrong input; 130: interrupted.

    Example: python -m engines environments
    """
    if context.invoked_subcommand is not None:
        return
    from engines.environments_command import list_environments as list_all

    list_all()


@environments.command(name="check")
def check_environments(
    names: Annotated[
        list[str] | None, typer.Argument(metavar="[NAME]...", help="Environments; without names, all of them.")
    ] = None,
) -> None:
    """Compare environments with what was installed into them, and import their engines.

    Exit code 0: all are whole; 1: one is not; 2: wrong input; 130: interrupted.

    Example: python -m engines environments check mujoco@3.3.7
    """
    from engines.environments_command import check_environments as check

    if not check(names or []):
        raise typer.Exit(ExitCode.FAILED)


@environments.command(name="remove")
def remove_environments(
    names: Annotated[list[str] | None, typer.Argument(metavar="[NAME]...", help="Environments.")] = None,
    every: Annotated[bool, typer.Option("--all", help="Remove all of them.")] = False,
) -> None:
    """Remove environments.

    Exit code 0: removed; 2: wrong input; 130: interrupted.

    Example: python -m engines environments remove mujoco@3.3.7
    """
    from engines.environments_command import remove_environments as remove

    remove(names or [], every)


def described(name: str) -> dict[str, Any]:
    """Describe one engine as plain data, ready for JSON.

    Parameters
    ----------
    name
        Name under which the engine is registered.

    Returns
    -------
    dict
        Capabilities as data; ``version`` is ``None`` and ``missing`` says why where it is not installed. Of a broken
        engine, such as one whose module is missing, the capabilities are left out.

    Raises
    ------
    ParameterError
        If no engine of this name is registered.
    """
    from engines.interface.registry import broken_reason, engine

    broken = broken_reason(name)
    if broken is not None:
        return {"engine": name, "version": None, "python": None, "presets": {}, "missing": broken}
    described_engine = engine(name)
    abilities = described_engine.capabilities
    missing = described_engine.unavailable_reason()
    return {
        "engine": name,
        "title": abilities.title,
        "package": abilities.package,
        "licence": abilities.licence,
        "terms": abilities.terms,
        "version": described_engine.version() if missing is None else None,
        "python": described_engine.python() if missing is None else None,
        "friction_law": str(abilities.friction_law),
        "presets": {str(formulation): list(presets) for formulation, presets in abilities.presets.items()},
        "normal_force": {
            str(formulation): {name: str(preset.normal_force) for name, preset in presets.items()}
            for formulation, presets in abilities.presets.items()
        },
        "precision": abilities.precision,
        "deterministic": abilities.deterministic,
        "missing": missing,
        "notes": abilities.notes,
    }


def _print(rows: list[dict[str, Any]]) -> None:
    """Print the engines as a table, then the reasons of those that are missing."""
    from rich.console import Console

    from reference_lcp.terminal_table import print_table

    lines = []
    for row in rows:
        presets = [f"{formulation}: {', '.join(names)}" for formulation, names in row["presets"].items()]
        arithmetic = row.get("precision", "") + ("" if row.get("deterministic", True) else ", varies")
        law = row.get("friction_law", "")
        lines.append(
            (
                row["engine"],
                row["version"] or "missing",
                row["python"] or "",
                f"{law}\n{arithmetic}",
                "\n".join(presets),
            )
        )
    print_table(("engine", "version", "Python", "friction law, precision", "formulation: presets"), lines)
    console = Console()
    for row in rows:
        if row["missing"] is not None:
            console.print(visible(f"{row['engine']}: {row['missing']}"), markup=False, soft_wrap=True)


if __name__ == "__main__":
    sys.exit(run_command(app))
