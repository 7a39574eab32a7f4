"""The plugin that runs the contract, on the engines of ``--xval-engine``: a conftest is read too late for an option.

Every session of pytest imports it where the suite is installed: the option has the suite's own prefix, since other
projects have options too, and nothing of the suite is imported before it is used.
"""

import re
from functools import cache
from typing import TYPE_CHECKING, Any

import pytest

if TYPE_CHECKING:
    from multibody_xval.engines.interface.variant import Variant

OPTION = "--xval-engine"
"""Names an engine that is held to the contract."""

CASE = re.compile(r"engines/contract/.*\[(.+?)(?:-joint|-contact|\])")
"""The engine in a test's name: everything that a clause is run for begins with it."""


def pytest_addoption(parser: pytest.Parser) -> None:
    """Add ``--xval-engine``."""
    parser.getgroup("multibody-xval").addoption(
        OPTION,
        action="append",
        default=[],
        metavar="NAME",
        help="with --pyargs multibody_xval.engines.contract: hold this engine to the contract, in all its formulations "
        "and presets; without it, all that are installed",
    )


def pytest_configure(config: pytest.Config) -> None:
    """Refuse engines that are unknown or not installed, before any test is collected."""
    config.addinivalue_line("markers", "slow: takes seconds, or is of presets that nobody has named")
    names: list[str] = config.getoption(OPTION)
    for name in names:
        from multibody_xval.engines.interface.registry import engine
        from reference_lcp.errors import ParameterError

        try:
            missing = engine(name).unavailable_reason()
        except ParameterError as problem:
            raise pytest.UsageError(f"{OPTION}: {problem}") from problem
        if missing is not None:
            raise pytest.UsageError(f"{OPTION} {name}: {missing}")


@pytest.hookimpl(optionalhook=True)
def pytest_xdist_make_scheduler(config: pytest.Config, log: Any) -> Any:
    """Run all clauses for an engine in one worker: what it compiles, and the processes that it starts, serve all."""
    if config.getoption("dist") != "loadscope":
        return None
    from xdist.scheduler import LoadScopeScheduling

    scheduling = LoadScopeScheduling(config, log)
    by_module = scheduling._split_scope
    scheduling._split_scope = lambda name: case[1] if (case := CASE.search(name)) else by_module(name)
    return scheduling


def pytest_generate_tests(metafunc: pytest.Metafunc) -> None:
    """Run a test of the contract once for everything that its argument stands for.

    ``tested`` is every variant, ``tuned`` the best known options, ``default`` what a newcomer gets,
    ``sharing`` those that share the reference's scheme, ``modelled`` those whose law is a model, ``following`` those
    whose normal force may change in time, ``lifting`` the tuned ones whose contacts may open, ``turning`` those whose
    row may have any direction, ``holding`` the tuned ones with static friction of its own,
    ``installed`` the name of an engine.
    """
    if metafunc.module.__package__ != "multibody_xval.engines.contract":
        return
    for argument, chosen in _cases(tuple(metafunc.config.getoption(OPTION))).items():
        if argument in metafunc.fixturenames:
            metafunc.parametrize(argument, chosen, ids=None if argument == "installed" else _label)


@cache
def _cases(named: tuple[str, ...]) -> dict[str, list[Any]]:
    """Give what each argument stands for, of these engines or, without any, of all that are installed."""
    from multibody_xval.engines.interface.law import law_of
    from multibody_xval.engines.interface.presets import NormalForce
    from multibody_xval.engines.interface.registry import engine, engine_names
    from multibody_xval.engines.interface.variant import variants_of

    names = named or [name for name in engine_names() if engine(name).unavailable_reason() is None]
    every = [variant for name in names for variant in variants_of(name, optional=True)]
    variants = [variant for variant in every if variant.unavailable_reason is None]
    tuned = [variant for variant in variants if variant.preset_name == "tuned"]
    cases = {
        "tested": variants,
        "tuned": tuned,
        "default": [variant for variant in variants if variant.preset_name == "default"],
        "following": [variant for variant in variants if variant.preset.represents(NormalForce.MODULATED)],
        "lifting": [variant for variant in tuned if variant.preset.represents(NormalForce.LIFTING)],
        "modelled": [
            each for each in variants if law_of(engine(each.engine), each.formulation, each.preset_name) is not None
        ],
        "turning": [variant for variant in variants if variant.preset.turns],
        "holding": [variant for variant in tuned if variant.preset.static_friction],
        "sharing": [variant for variant in variants if variant.preset.shares_scheme and variant.engine != "reference"],
    }
    later = {argument: [_later_if_optional(variant, named) for variant in chosen] for argument, chosen in cases.items()}
    return {**later, "installed": list(names)}


def _later_if_optional(variant: "Variant", named: tuple[str, ...]) -> Any:
    """Let presets that take part where they are named be slow, unless their engine is named."""
    return pytest.param(variant, marks=pytest.mark.slow) if variant.preset.optional and not named else variant


def _label(variant: "Variant") -> str:
    return f"{variant.engine}-{variant.formulation}-{variant.preset_name}"
