"""``multibody-xval engines``: which engines there are, what they can do, their laws, and environments of their own."""

from __future__ import annotations

import json
import sys
from typing import TYPE_CHECKING, Annotated, Any

import typer

from engines.completion import complete_engine, complete_variant
from engines.isolated import environment as isolated
from reference_lcp.errors import ExitCode, ParameterError
from reference_lcp.terminal import print_table, visible
from reports.cli.options import NAME_METAVAR

if TYPE_CHECKING:
    from engines.interface.law import Law
    from engines.interface.variant import Variant
    from engines.isolated.versioned_engine import Requirement

app = typer.Typer(name="multibody-xval engines", add_completion=False, pretty_exceptions_enable=False)


@app.callback(invoke_without_command=True)
def engines(
    context: typer.Context, as_json: Annotated[bool, typer.Option("--json", help="Print JSON.")] = False
) -> None:
    """List every registered engine: version, friction law and presets, and why it is missing if it is.

    Exit code 0: listed, installed or not; 2: wrong input; 130: interrupted.

    Example: multibody-xval engines --json
    """
    if context.invoked_subcommand is not None:
        return
    from engines.interface.registry import registered_names

    rows = [described(name) for name in registered_names()]
    if as_json:
        print(json.dumps(rows, indent=2))
        return
    lines = []
    for row in rows:
        arithmetic = row.get("precision", "") + ("" if row.get("deterministic", True) else ", varies")
        law = f"{row.get('friction_law', '')}\n{arithmetic}"
        presets = "\n".join(f"{formulation}: {', '.join(names)}" for formulation, names in row["presets"].items())
        lines.append((row["engine"], row["version"] or "missing", row["python"] or "", law, presets))
    print_table(("engine", "version", "Python", "friction law, precision", "formulation: presets"), lines)
    for row in rows:
        if row["missing"] is not None:
            print(visible(f"{row['engine']}: {row['missing']}"))


@app.command()
def law(
    name: Annotated[str, typer.Argument(metavar=NAME_METAVAR, help="The variant.", autocompletion=complete_variant)],
) -> None:
    """Print the law of a preset: its formula, its constants and their origin, and the distance between engine and law.

    Exit code 0: printed; 2: wrong input; 130: interrupted.

    Example: multibody-xval engines law mujoco:joint:default
    """
    from engines.interface.law import NotModelled
    from engines.interface.variant import Variant

    variant = Variant.parse(name)
    stated = variant.preset.stated_law()
    if stated is None:
        step = "the step of the reference, equation (5)" if variant.preset.shares_scheme else "none"
        print(f"{variant}: {step}")
    elif isinstance(stated, NotModelled):
        print(visible(f"{variant} is not modelled: {stated.reason}"))
    else:
        print(f"{variant}: {stated.formula}")
        rows = [(symbol, f"{each.value:g}", each.unit, each.source) for symbol, each in stated.constants.items()]
        print_table(("constant", "value", "unit", "from"), rows)
        print(_measured(variant, stated))


def _measured(variant: Variant, law: Law) -> str:
    """Compare a period of engine and law at the points where the law claims to hold."""
    from engines.shared.law_distance import difference_in_words, figure3_lanes

    bound = f"allowed {law.period_bound:g} U0: {law.bound_reason}"
    missing = variant.unavailable_reason
    if missing is not None:
        return f"not measured here, {missing}; {bound}"
    asked = [(lane, law.unclaimed_reason(lane)) for lane in figure3_lanes()]
    lanes = [lane for lane, reason in asked if reason is None]
    if not lanes:
        reasons = "; ".join(dict.fromkeys(reason for _, reason in asked if reason is not None))
        return f"not measured: it does not claim to hold at any of {len(asked)} points: {reasons}"
    return f"{difference_in_words(variant, law, lanes)}; {bound}"


@app.command(name="install")
def install_engine(
    name: Annotated[
        str,
        typer.Argument(
            metavar="NAME[@VERSION]", help="The engine, or a version of it.", autocompletion=complete_engine
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

    Example: multibody-xval engines install mujoco@3.3.7
    """
    from engines.isolated.installation import Plan, install

    requirement = _requirement(name)
    environment = requirement.environment
    record = environment.record()
    if record is None or environment.fault() is not None or isolated.edited_fault(environment) is not None:
        plan = Plan.of(requirement, python)
        print(visible(str(plan)), flush=True)
        if requirement.adapter.capabilities.terms and not agreed:
            _agree_to_terms(requirement)
        record = install(plan)
        print(f"made in {record.seconds:g} s")
    print(f"{environment.name} is installed: Python {record.python}, {record.megabytes:g} MB in {environment.folder}")


def _agree_to_terms(requirement: Requirement) -> None:
    """Let the user agree to the terms of an engine, which hold from its download on."""
    known = requirement.adapter.capabilities
    own = f"{requirement.name} is not free software ({known.licence}); who downloads it agrees to {known.terms}"
    if not sys.stdin.isatty():
        raise ParameterError(f"{own}; allowed: with --yes, which agrees to that")
    print(own)
    if not typer.confirm("Do you agree?"):
        raise ParameterError(f"{requirement.name} is not installed: its terms were not agreed to")


environments = typer.Typer()
app.add_typer(environments, name="environments")


@environments.callback(invoke_without_command=True)
def list_environments(context: typer.Context) -> None:
    """List all environments with their sizes and problems.

    Exit code 0: listed; 2: wrong input; 130: interrupted.

    Example: multibody-xval engines environments
    """
    if context.invoked_subcommand is not None:
        return
    rows, faults = [], []
    for environment in isolated.environments():
        record, fault = environment.record(), environment.fault()
        held = [""] * 4
        if record is not None:
            held = [record.python, str(len(record.packages)), f"{record.megabytes:g}", str(record.seconds)]
        rows.append([environment.name, *held])
        if fault is not None:
            faults.append(f"{environment.name} {fault}; {environment.remedy}")
    print_table(("environment", "Python", "packages", "MB", "made in s"), rows)
    for line in [*faults, f"in {isolated.environments_folder()}"]:
        print(visible(line))


@environments.command(name="check")
def check_environments(
    names: Annotated[
        list[str] | None, typer.Argument(metavar="[NAME]...", help="Environments; without names, all of them.")
    ] = None,
) -> None:
    """Compare environments with what was installed into them, and import their engines.

    Exit code 0: all are whole; 1: one is not; 2: wrong input; 130: interrupted.

    Example: multibody-xval engines environments check mujoco@3.3.7
    """
    whole = True
    for environment in _named(names):
        fault = environment.fault() or environment.added_fault() or isolated.edited_fault(environment)
        fault = fault or _import_fault(environment)
        print(visible(f"{environment.name} {fault}; {environment.remedy}" if fault else f"{environment.name} is whole"))
        whole = whole and fault is None
    if not whole:
        raise typer.Exit(ExitCode.FAILED)


@environments.command(name="remove")
def remove_environments(
    names: Annotated[list[str] | None, typer.Argument(metavar="[NAME]...", help="Environments.")] = None,
    every: Annotated[bool, typer.Option("--all", help="Remove all of them.")] = False,
) -> None:
    """Remove environments.

    Exit code 0: removed; 2: wrong input; 130: interrupted.

    Example: multibody-xval engines environments remove mujoco@3.3.7
    """
    from engines.isolated.installation import remove

    if bool(names) == every:
        raise ParameterError("nothing or both is named to be removed; allowed: NAME ..., or --all")
    for environment in _named(names):
        remove(environment)
        print(visible(f"{environment.name} is removed"))


def _import_fault(environment: isolated.Environment) -> str | None:
    from engines.isolated.process import EngineProcessError
    from engines.isolated.versioned_engine import tried_versions

    try:
        tried_versions(_requirement(environment.name).adapter, environment)
    except (EngineProcessError, ParameterError) as problem:
        return f"cannot be used: {problem}"
    return None


def _requirement(name: str) -> Requirement:
    from engines.interface.registry import registered_engine
    from engines.isolated.versioned_engine import Requirement

    engine, at, version = name.partition("@")
    return Requirement.of(registered_engine(engine), version if at else None)


def _named(names: list[str] | None) -> list[isolated.Environment]:
    """Give the environments of these names, or all; they are there."""
    known = {environment.name: environment for environment in isolated.environments()}
    for name in names or ():
        if name not in known:
            allowed = ", ".join(known) or "none is installed"
            raise ParameterError(f"environment = {name!r} is not installed; allowed: {allowed}")
    return [known[name] for name in dict.fromkeys(names or known)]


def described(name: str) -> dict[str, Any]:
    """Describe one engine as plain data, ready for JSON; of a broken one, without its capabilities."""
    from engines.interface.registry import broken_reason, engine

    broken = broken_reason(name)
    if broken is not None:
        return {"engine": name, "version": None, "python": None, "presets": {}, "missing": broken}
    own = engine(name)
    abilities, missing = own.capabilities, own.unavailable_reason()
    return {
        "engine": name,
        "title": abilities.title,
        "package": abilities.package,
        "licence": abilities.licence,
        "terms": abilities.terms,
        "version": own.version() if missing is None else None,
        "python": own.python() if missing is None else None,
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
