"""``multibody-xval engines install`` and ``environments``: engines in environments of their own."""

import sys
from collections.abc import Sequence

import typer
from rich.console import Console

from engines.environments.content import edited_fault
from engines.environments.environment import Environment, environments, environments_folder
from engines.environments.installation import Plan, install, remove
from engines.environments.process import tried_versions
from engines.environments.requirement import Requirement
from engines.interface.registry import registered_engine
from engines.out_of_process.process import EngineProcessError
from reference_lcp.refusal import ParameterError
from reference_lcp.terminal_table import print_table
from reference_lcp.visible import visible


def install_engine(name: str, python: str | None, *, agreed: bool = False) -> None:
    """Say what an engine needs, and install it; nothing is done where it is installed and whole.

    Parameters
    ----------
    name
        The engine, and after an ``@`` the version.
    python
        Version or path of a Python of this machine; the one that runs the suite without it.
    agreed
        The user agrees to the terms of an engine that is not free software; asked for in a terminal without it.

    Raises
    ------
    ParameterError
        If it cannot be installed, or its terms are not agreed to.
    """
    requirement = _requirement(name)
    environment = requirement.environment
    record = environment.record()
    if record is None or environment.fault() is not None or edited_fault(environment) is not None:
        plan = Plan.of(requirement, python)
        print(visible(str(plan)), flush=True)
        if requirement.adapter.capabilities.terms and not agreed:
            _agree_to_terms(requirement)
        record = install(plan)
        print(f"made in {record.seconds:g} s")
    print(f"{environment.name} is installed: Python {record.python}, {record.megabytes:g} MB in {environment.folder}")


def _agree_to_terms(requirement: Requirement) -> None:
    """Let the user agree to the terms of an engine, which hold from its download on.

    Raises
    ------
    ParameterError
        If that is declined, or there is nobody to ask.
    """
    known = requirement.adapter.capabilities
    own = f"{requirement.name} is not free software ({known.licence}); who downloads it agrees to {known.terms}"
    if not sys.stdin.isatty():
        raise ParameterError(f"{own}; allowed: with --yes, which agrees to that")
    print(own)
    if not typer.confirm("Do you agree?"):
        raise ParameterError(f"{requirement.name} is not installed: its terms were not agreed to")


def list_environments() -> None:
    """Print every environment with what it holds, and what is wrong with it."""
    rows, faults = [], []
    for environment in environments():
        record, fault = environment.record(), environment.fault()
        held = [""] * 4
        if record is not None:
            held = [record.python, str(len(record.packages)), f"{record.megabytes:g}", str(record.seconds)]
        rows.append([environment.name, *held])
        if fault is not None:
            faults.append(f"{environment.name} {fault}; {environment.remedy}")
    print_table(("environment", "Python", "packages", "MB", "made in s"), rows)
    console = Console()
    for line in [*faults, f"in {environments_folder()}"]:
        console.print(visible(line), markup=False, soft_wrap=True)


def check_environments(names: Sequence[str]) -> bool:
    """Compare environments with what was installed, import their engines, and say of each what is wrong with it."""
    whole = True
    for environment in _named(names):
        fault = environment.fault() or edited_fault(environment) or _import_fault(environment)
        print(visible(f"{environment.name} {fault}; {environment.remedy}" if fault else f"{environment.name} is whole"))
        whole = whole and fault is None
    return whole


def remove_environments(names: Sequence[str], every: bool) -> None:
    """Remove environments."""
    if bool(names) == every:
        raise ParameterError("nothing or both is named to be removed; allowed: NAME ..., or --all")
    for environment in _named(names):
        remove(environment)
        print(visible(f"{environment.name} is removed"))


def _import_fault(environment: Environment) -> str | None:
    try:
        tried_versions(_requirement(environment.name).adapter, environment)
    except (EngineProcessError, ParameterError) as problem:
        return f"cannot be used: {problem}"
    return None


def _requirement(name: str) -> Requirement:
    engine, at, version = name.partition("@")
    return Requirement.of(registered_engine(engine), version if at else None)


def _named(names: Sequence[str]) -> list[Environment]:
    """Give the environments of these names, or all; they are there."""
    known = environments()
    by_name = {environment.name: environment for environment in known}
    for name in names:
        if name not in by_name:
            allowed = ", ".join(by_name) or "none is installed"
            raise ParameterError(f"environment = {name!r} is not installed; allowed: {allowed}")
    return [by_name[name] for name in dict.fromkeys(names)] if names else known
