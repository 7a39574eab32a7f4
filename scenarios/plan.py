"""What is to be run, before anything is: all runs of a question, those of the ruler too."""

from collections.abc import Iterable, Sequence
from itertools import product

import numpy as np

from multibody_xval.engines.interface.registry import engine
from multibody_xval.engines.interface.variant import GENERAL, check_installed, name_parts, variants_named, variants_of
from multibody_xval.scenarios.model import Case, Config, Run
from multibody_xval.scenarios.ruler.exact_values import ruler
from reference_lcp.defaults import MINIMUM_STEPS_PER_PERIOD

COMPARED = ("tuned", *GENERAL)
"""Presets that a bare name of an engine stands for where engines are compared."""

GUARD_FRICTION_RATIOS = (0.1, 0.3, 1.0)
GUARD_FREQUENCY_RATIOS = tuple(np.round(np.linspace(0.3, 1.6, 8), 6).tolist())
"""By which engines are compared: from well below the band to well above, with little friction and with much."""


def guard_cases() -> list[Case]:
    """Give the 24 cases by which engines are compared."""
    places = product(GUARD_FRICTION_RATIOS, GUARD_FREQUENCY_RATIOS)
    return [Case(friction_ratio=friction, frequency_ratio=frequency) for friction, frequency in places]


def compared_configs(name: str) -> list[Config]:
    """Give the configurations that a name stands for: of a bare engine, its presets for users and that for the chain.

    Raises
    ------
    ParameterError
        If there is no such engine, formulation, preset or option, or it is not installed.
    """
    names, settings = name_parts(name)
    if len(names) > 1 or settings:
        return variants_named([name])
    own = [config for config in variants_of(name, optional=True) if config.preset_name in COMPARED]
    check_installed(name, engine(name).unavailable_reason())
    return own or variants_named([name])


def runs_at(configs: Iterable[Config], cases: Sequence[Case], minimum: int = MINIMUM_STEPS_PER_PERIOD) -> list[Run]:
    """Give the runs of configurations at cases, and those of the ruler there."""
    steps = {case: case.steps(minimum) for case in cases}
    own = [Run(config, case, steps[case]) for config, case in product(dict.fromkeys(configs), cases)]
    return list(dict.fromkeys([*own, *ruler(steps.items())]))
