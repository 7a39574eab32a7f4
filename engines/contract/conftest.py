"""Which engines are held to the contract: ``--xval-engine NAME``, as often as wanted, or all that are installed."""

import pytest

from engines.contract.lanes import label
from engines.contract.plugin import OPTION
from engines.interface.presets import NormalForce
from engines.interface.registry import engine, engine_names
from engines.interface.variant import Variant, variants_of


def pytest_generate_tests(metafunc: pytest.Metafunc) -> None:
    """Run a test once for everything that its argument stands for.

    ``tested`` is every variant, ``tuned`` the best known options, ``default`` what a newcomer gets,
    ``sharing`` the tuned ones that share the reference's scheme, ``following`` those whose normal force may change in
    time, ``lifting`` the tuned ones whose contacts may open, ``turning`` those whose row may have any direction,
    ``inclining`` the tuned ones whose contacts may be inclined, ``holding`` the tuned ones with static friction of its
    own, ``installed`` the name of an engine.
    """
    names = _chosen(metafunc.config)
    every = [variant for name in names for variant in variants_of(name, optional=True)]
    variants = [variant for variant in every if variant.unavailable_reason is None]
    tuned = [variant for variant in variants if variant.preset_name == "tuned"]
    cases: dict[str, list[Variant]] = {
        "tested": variants,
        "tuned": tuned,
        "default": [variant for variant in variants if variant.preset_name == "default"],
        "following": [variant for variant in variants if variant.preset.represents(NormalForce.MODULATED)],
        "lifting": [variant for variant in tuned if variant.preset.represents(NormalForce.LIFTING)],
        "turning": [variant for variant in variants if variant.preset.turns],
        "inclining": [variant for variant in tuned if variant.preset.inclines],
        "holding": [variant for variant in tuned if variant.preset.static_friction],
        "sharing": [variant for variant in tuned if variant.preset.shares_scheme and variant.engine != "reference"],
    }
    for argument, chosen in cases.items():
        if argument in metafunc.fixturenames:
            metafunc.parametrize(argument, chosen, ids=label)
    if "installed" in metafunc.fixturenames:
        metafunc.parametrize("installed", names)


def _chosen(config: pytest.Config) -> list[str]:
    named: list[str] = config.getoption(OPTION)
    return named or [name for name in engine_names() if engine(name).unavailable_reason() is None]
