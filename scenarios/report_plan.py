"""The runs of a report: every preset at five points, tuned and default joints over the paper's chain."""

from collections.abc import Iterable, Sequence
from functools import cache

import numpy as np

from multibody_xval.engines.interface.presets import Formulation
from multibody_xval.engines.interface.registry import default_engine_names, installed_engine_names
from multibody_xval.engines.interface.variant import ALL, GENERAL, variants_named, variants_of
from multibody_xval.scenarios.model import REFERENCE, Case, Config, Run
from multibody_xval.scenarios.plan import runs_at
from multibody_xval.scenarios.sweeps import frequency_grid

HEADLINE = tuple(
    Case(friction_ratio=friction, frequency_ratio=eta)
    for friction, eta in ((0.1, 1.4), (0.1, 1.5), (0.1, 1.6), (0.3, 1.5), (1.0, 1.4))
)
"""Deep within the band, where engines are farthest from the exact motion: with little friction, and with much."""

HEADLINE_STEPS = 800
"""Per period: the error that is left is an engine's, hardly its step's."""

PRESETS = ("default", *(name for name in GENERAL if name != "default"), "tuned")
"""Presets that a report compares, in the order in which it shows them."""

ON_GRID = ("default", "tuned")
"""Presets of joints that are measured on the whole grid, with those that have none of the names of `PRESETS`."""

FRICTION_RATIOS = (0.0, 0.1, 0.3, 0.6, 1.0, 5.0)
QUICK_FRICTION_RATIOS = (0.0, 0.3, 1.0)

SLOW = ("exudyn-regularised", "exudyn-bristle")
"""Engines that take a hundred times as long as others: they are measured where claims and edges need it."""

SLOW_FRICTION_RATIOS: dict[str, tuple[float, ...]] = {"tuned": FRICTION_RATIOS, "default": QUICK_FRICTION_RATIOS}
QUICK_SLOW_FRICTION_RATIOS: dict[str, tuple[float, ...]] = {"tuned": (0.3,), "default": ()}
"""Friction ratios of engines in `SLOW`, by preset."""

SLOWEST = (Formulation.CONTACT, "default")
"""Of theirs, what is measured at one of the headline's points alone: it takes a third of a quick report."""

FREQUENCY_RATIOS = tuple(round(float(eta), 4) for eta in np.r_[0.1:0.5:0.1, 0.5:1.6:0.05, 1.6:3.05:0.1])
QUICK_FREQUENCY_RATIOS = (
    0.3, 0.62, 0.7, 0.8, 0.8505, 0.8686, 0.9, 0.95, 1.0, 1.1, 1.2, 1.3, 1.4, 1.422, 1.5, 1.6,
)  # fmt: skip
"""With the resonances next to which a band edge may hide."""

REPORT = "multibody-xval report"


def report_configs(names: Iterable[str] = ()) -> list[Config]:
    """Give the configurations of a report: of engines, every preset that is compared; of a full name, that one.

    Raises
    ------
    ParameterError
        If a name is unknown, or its engine is not installed.
    """
    asked = list(names)
    bare = [name for name in asked if ":" not in name and name != ALL]
    variants_named(bare)
    engines = [*bare, *(installed_engine_names() if ALL in asked else ()), *(() if asked else default_engine_names())]
    compared = [own for name in engines if name != REFERENCE.engine for own in _compared(name)]
    return list(dict.fromkeys([*compared, *variants_named([name for name in asked if ":" in name])]))


def _compared(name: str) -> list[Config]:
    """Give the presets of an engine that a report compares: all of one that has none of these names."""
    every = variants_of(name, optional=True)
    return [own for own in every if own.preset_name in PRESETS] or every


def report_runs(configs: Iterable[Config], *, quick: bool) -> list[Run]:
    """Give all runs of a report that are known before the first: those of the ruler too."""
    configs = list(dict.fromkeys(configs))
    runs = runs_at([REFERENCE], grid(quick))
    for own in configs:
        runs += runs_at([own], headline_cases(own), HEADLINE_STEPS)
        runs += runs_at([own], grid_cases(own, quick=quick))
    return list(dict.fromkeys(runs))


def headline_cases(config: Config) -> Sequence[Case]:
    """Give the headline's points at which a configuration is measured."""
    return HEADLINE[:1] if is_slowest(config) or not config.preset.settles else HEADLINE


def is_default(config: Config) -> bool:
    """Whether a configuration has an engine's default options, or changes some of those."""
    return config.unchanged.preset_name == "default"


def is_slowest(config: Config) -> bool:
    """Whether a configuration is one of the slowest of all."""
    return config.engine in SLOW and (config.formulation, config.unchanged.preset_name) == SLOWEST


def grid_cases(config: Config, *, quick: bool) -> list[Case]:
    """Give the cases of the grid: with default options, and of slow engines, what claims and edges need."""
    own = [case for case in grid(quick) if case.friction_ratio in frictions(config, quick=quick)]
    if quick or not (config.engine in SLOW or is_default(config)):
        return own
    return [case for case in own if case.frequency_ratio in claim_frequency_ratios()]


def frictions(config: Config, *, quick: bool) -> Sequence[float]:
    """Give the friction ratios at which a configuration is measured over the frequency ratio."""
    preset = config.unchanged.preset_name
    measured = preset in ON_GRID or preset not in PRESETS
    if config.formulation != Formulation.JOINT or not measured or not config.preset.settles:
        return ()
    ratios = QUICK_FRICTION_RATIOS if quick else FRICTION_RATIOS
    if config.engine in SLOW:
        return (QUICK_SLOW_FRICTION_RATIOS if quick else SLOW_FRICTION_RATIOS).get(preset, ratios)
    return ratios


@cache
def grid(quick: bool) -> tuple[Case, ...]:
    """Give the cases of the grid; curves of the default report hold every resonance."""
    ratios = QUICK_FRICTION_RATIOS if quick else FRICTION_RATIOS
    etas = QUICK_FREQUENCY_RATIOS if quick else sorted({*FREQUENCY_RATIOS, *resonances()})
    return tuple(Case(friction_ratio=own, frequency_ratio=eta) for own in ratios for eta in etas)


@cache
def claim_frequency_ratios() -> tuple[float, ...]:
    """Give the fewest frequencies on which the edges of all friction ratios are found, with all resonances."""
    even = (0.3, 0.65, 0.8, 0.9, 1.0, 1.1, 1.2, 1.6, 2.1, 2.5, 3.0)
    return tuple(sorted({*even, *(eta for eta in resonances() if eta > even[0])}))


@cache
def resonances() -> tuple[float, ...]:
    """Give the natural frequencies over ω_r of the paper's chain with contacts that slide freely, or never slide."""
    found = set(np.round(frequency_grid.resonances(Case(friction_ratio=0.0, frequency_ratio=1.0)), 4).tolist())
    return tuple(sorted(eta for eta in found if min(FREQUENCY_RATIOS) < eta < max(FREQUENCY_RATIOS)))


def left_out(configs: Iterable[Config], *, quick: bool) -> str:
    """Say in a line what a report does not measure, with the command that does; empty where it measures all."""
    configs = list(configs)
    slow = list(dict.fromkeys(own.engine for own in configs if own.engine in SLOW))
    skipped = _listed(set(FRICTION_RATIOS) - set(QUICK_FRICTION_RATIOS))
    sentences = []
    if quick:
        parts = [f"friction ratios {skipped}"]
        if slow:
            kept = _listed(QUICK_SLOW_FRICTION_RATIOS["tuned"])
            parts.append(f"{_words(slow)}: friction ratios other than {kept}, and most points with default options")
        sentences.append(f"Left out of the quick report: {'; '.join(parts)}; more of it: {REPORT}.")
    elif coarse := [*slow, *(["default options"] if any(map(is_default, configs)) else [])]:
        count, every = len(claim_frequency_ratios()), len({*FREQUENCY_RATIOS, *resonances()})
        parts = [f"{_words(coarse)} at {count} of {every} frequency ratios, which claims and band edges need"]
        if slow:
            parts.append(f"{_words(slow)} with default options not at friction ratios {skipped}")
        sentences.append(f"Measured in part: {'; '.join(parts)}; all of it: multibody-xval sweep.")
    if once := [str(own) for own in configs if is_slowest(own)]:
        sentences.append(f"At one point alone, since they are slow: {', '.join(once)}.")
    if never := [str(own) for own in configs if not own.preset.settles]:
        sentences.append(f"At one point alone, since they hardly ever settle: {', '.join(never)}.")
    return " ".join(sentences)


def _words(names: Sequence[str]) -> str:
    return " and ".join([", ".join(names[:-1]), *names[-1:]] if len(names) > 1 else names)


def _listed(values: Iterable[float]) -> str:
    return ", ".join(f"{value:g}" for value in sorted(values))
