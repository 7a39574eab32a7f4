"""Sweeps: every combination of values of any parameters, by every variant."""

import itertools
import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property

from multibody_xval.engines.interface.registry import engine
from multibody_xval.engines.interface.variant import Variant
from multibody_xval.scenarios.runs.parameters import ChainRatios, Excitation
from multibody_xval.scenarios.runs.task import SteadyStateTask
from multibody_xval.scenarios.sweeps import UNCONFIRMED_POINTS
from multibody_xval.scenarios.sweeps.adaptive_grid import MOST_VALUES, AdaptiveAxis
from multibody_xval.scenarios.sweeps.attenuation_band import BandDefinition
from multibody_xval.scenarios.verdicts.steady_case import CONVERGED, REFERENCE
from reference_lcp.defaults import FEWEST_STEPS_PER_PERIOD, MINIMUM_STEPS_PER_PERIOD
from reference_lcp.errors import ParameterError, choices, shown
from reference_lcp.validation import LARGEST_PARAMETER, MOST_CELLS, MOST_STEPS, checked_array, checked_count

CHAIN_AXES = ("cells", "mass_ratio", "stiffness_ratio", "damping_ratio", "inner_damping_ratio")
AXES = ("friction_ratio", "frequency_ratio", *CHAIN_AXES, "steps_per_period")
"""Everything that may be varied."""

BASELINES = (CONVERGED, REFERENCE)
"""What variants are compared with: the first of these that takes part."""

FASTEST_SECONDS = 1e-3
"""Time that one point takes one worker at least [s]: the reference, the fastest engine, on the canonical chain."""

_COUNTS = {"cells": (1, MOST_CELLS), "steps_per_period": (FEWEST_STEPS_PER_PERIOD, MOST_STEPS)}
_POSITIVE = ("frequency_ratio", "mass_ratio", "stiffness_ratio")


@dataclass(frozen=True, kw_only=True)
class GivenTolerance:
    """A tolerance that is given, instead of one that is derived at every point."""

    transmittance_db: float
    """Largest difference of transmittance that counts as agreement [dB] > 0."""
    baseline: Variant
    """What variants are compared with: the reference or its converged preset."""

    def judges(self, variant: Variant) -> bool:
        """Whether it is for this variant: for all but what others are compared with."""
        return variant not in (self.baseline, CONVERGED)


def baseline(variant: Variant, given: GivenTolerance | None = None) -> Variant:
    """Give what a variant is compared with."""
    if given is not None and given.judges(variant):
        return given.baseline
    return REFERENCE if variant.engine != REFERENCE.engine and variant.preset.shares_scheme else CONVERGED


def refinements(variant: Variant, given: GivenTolerance | None = None) -> tuple[float, ...]:
    """Give with how many times the steps a variant is simulated too, for the sake of its own error.

    With none where it shares the reference's error, is the baseline itself, or is judged by a tolerance that is given.
    """
    if given is not None and given.judges(variant):
        return ()
    if variant == REFERENCE:
        return (2.0, 4.0)
    return (0.5,) if baseline(variant) == CONVERGED != variant else ()


@dataclass(frozen=True)
class Case:
    """One combination of the values of all axes but the frequency ratio: a curve is one variant in one case."""

    # Pairs of axis and value, in the order of the axes; the friction ratio is among them.
    values: tuple[tuple[str, float], ...]

    @classmethod
    def of(cls, **values: float) -> "Case":
        """Take the values by name."""
        return cls(tuple(values.items()))

    @cached_property
    def by_axis(self) -> dict[str, float]:
        """Values by the name of their axis."""
        return dict(self.values)

    @property
    def friction_ratio(self) -> float:
        """μ λ_N / (k_c U0)."""
        return self.by_axis["friction_ratio"]

    @property
    def numbers(self) -> str:
        """The values alone, such as ``0.3, 2``."""
        return ", ".join(f"{value:.6g}" for _, value in self.values)

    @property
    def title(self) -> str:
        """Every value with its name, such as ``friction ratio 0.3, mass ratio 2``."""
        return ", ".join(f"{name.replace('_', ' ')} {value:.6g}" for name, value in self.values)

    def __str__(self) -> str:
        """Give the title, shorter: ``friction 0.3, mass ratio 2``."""
        return self.title.replace("friction ratio", "friction")


GridPoint = tuple[Variant, Case, float]
"""Variant, case and frequency ratio."""


@dataclass(frozen=True)
class Sweep:
    """Every combination of values of some parameters, by some variants."""

    variants: tuple[Variant, ...]
    axes: Mapping[str, tuple[float, ...]]
    """Values by parameter, one of `AXES` each, in the order of the dimensions; friction and frequency ratio must be
    among them."""
    ratios: ChainRatios = field(default_factory=ChainRatios)
    steps_per_period: int = MINIMUM_STEPS_PER_PERIOD
    """Fewest steps a period where they are not varied."""
    excitation: Excitation = field(default_factory=Excitation)
    frequencies: AdaptiveAxis | None = None
    """The adaptive axis; the frequency ratios among `axes` are then only those with which every curve begins."""
    tolerance: GivenTolerance | None = None
    """By which variants are judged, where it is given; without it, it is derived at every point."""
    band: BandDefinition = field(default_factory=BandDefinition)

    def __post_init__(self) -> None:
        if not self.variants:
            raise ParameterError("engines = [] names none; allowed: at least one")
        for variant in self.variants:
            engine(variant.engine).preset(variant.formulation, variant.preset_name)
        for name, values in self.axes.items():
            check_axis(name, values)
        for name in ("friction_ratio", "frequency_ratio"):
            if name not in self.axes:
                raise ParameterError(f"grid.{name} is missing; allowed: at least one value")
        checked_count("steps_per_period", self.steps_per_period, *_COUNTS["steps_per_period"])

    @property
    def case_axes(self) -> tuple[str, ...]:
        """Names of all axes but the frequency ratio."""
        return tuple(name for name in self.axes if name != "frequency_ratio")

    @cached_property
    def cases(self) -> tuple[Case, ...]:
        """Every combination of the values of `case_axes`, the last one fastest."""
        names = self.case_axes
        return tuple(
            Case(tuple(zip(names, values, strict=True)))
            for values in itertools.product(*(self.axes[name] for name in names))
        )

    @property
    def frequency_ratios(self) -> tuple[float, ...]:
        """Frequency ratios of the grid; of an adaptive sweep those with which every curve begins."""
        return self.axes["frequency_ratio"]

    @property
    def fewest_steps(self) -> int:
        """Fewest steps a period of any case."""
        return int(min(self.axes.get("steps_per_period", (self.steps_per_period,))))

    @property
    def points(self) -> int:
        """Number of tasks."""
        return len(self.variants) * math.prod(len(values) for values in self.axes.values())

    def grid_points(self) -> Iterator[GridPoint]:
        """Give variant, case and frequency ratio of every combination, the last axis fastest, variants slowest."""
        names = list(self.axes)
        eta = names.index("frequency_ratio")
        for variant in self.variants:
            for values in itertools.product(*self.axes.values()):
                pairs = tuple(zip(names, values, strict=True))
                yield variant, Case(pairs[:eta] + pairs[eta + 1 :]), values[eta]

    def tasks(self) -> Iterator[SteadyStateTask]:
        """Give the task of every combination, in the order of `grid_points`."""
        for point in self.grid_points():
            yield self.task(*point)

    def ratios_of(self, case: Case) -> ChainRatios:
        """Give the chain of a case but for its friction."""
        chain = {name: _number(name, value) for name, value in case.values if name in CHAIN_AXES}
        return replace(self.ratios, **chain) if chain else self.ratios  # type: ignore[arg-type]

    def task(self, variant: Variant, case: Case, frequency_ratio: float, refinement: float = 1.0) -> SteadyStateTask:
        """Give the task of one point, with `refinement` times the steps a period."""
        steps = case.by_axis.get("steps_per_period", self.steps_per_period)
        return SteadyStateTask(
            variant=variant,
            friction_ratio=case.friction_ratio,
            frequency_ratio=frequency_ratio,
            ratios=self.ratios_of(case),
            steps_per_period=max(int(steps * refinement), 3),
            excitation=self.excitation,
        )

    def with_reference(self) -> "Sweep":
        """Give the sweep with the converged reference and the reference in front, its values ascending."""
        return replace(self.ascending(), variants=tuple(dict.fromkeys((CONVERGED, REFERENCE, *self.variants))))

    def for_verdicts(self) -> "Sweep":
        """Give the sweep with all that its verdicts need: the reference that takes part brings its converged preset."""
        return self.with_reference() if self.tolerance is None and REFERENCE in self.variants else self

    def ascending(self) -> "Sweep":
        """Give the sweep with the values of every axis ascending."""
        return replace(self, axes={name: tuple(sorted(values)) for name, values in self.axes.items()})


def baseline_of(variants: Sequence[Variant]) -> Variant | None:
    """Give what variants are compared with; ``None`` if the reference is not among them."""
    return next((baseline for baseline in BASELINES if baseline in variants), None)


def check_axis(name: str, values: Sequence[float]) -> None:
    """Raise a `ParameterError` unless these may be the values of an axis."""
    if name not in AXES:
        raise ParameterError(f"grid.{name} is unknown; {choices(name, AXES)}")
    if not values or len(set(values)) < len(values):
        raise ParameterError(f"grid.{name} = {shown(list(values))}; allowed: at least one value, none of them twice")
    if len(values) > MOST_VALUES:
        raise ParameterError(f"grid.{name} has {len(values)} values; allowed: <= {MOST_VALUES}")
    checked_array(f"grid.{name}", values, "> 0" if name in _POSITIVE else ">= 0", largest=LARGEST_PARAMETER)
    for value in values if name in _COUNTS else ():
        checked_count(f"grid.{name}", _number(name, value), *_COUNTS[name])  # type: ignore[arg-type]


def _number(name: str, value: float) -> float:
    """Give the value of an axis of whole numbers as a whole number."""
    return int(value) if name in _COUNTS and float(value).is_integer() else value


def check_size(sweep: Sweep, *, yes: bool = False, how: str = "") -> None:
    """Raise a `ParameterError` if a sweep has more than `UNCONFIRMED_POINTS`, without a `yes`, said as `how` tells."""
    if sweep.points > UNCONFIRMED_POINTS and not yes:
        more = f", or more with {how}" if how else ""
        raise ParameterError(f"{size_text(sweep)}; allowed: <= {UNCONFIRMED_POINTS:,} points{more}")


def size_text(sweep: Sweep) -> str:
    """Say how many points a sweep has, and for how long they keep a worker busy at least."""
    least = "" if sweep.frequencies is None else "at least "
    seconds = sweep.points * FASTEST_SECONDS
    duration = f"{seconds:.2g} s" if seconds < 60 else f"{seconds / 3600:,.3g} h"
    return f"the sweep has {least}{sweep.points:,} points, {duration} of one worker's time or more"
