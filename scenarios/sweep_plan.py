"""A sweep as data: every combination of values of any parameters, by every configuration; its cases and its runs."""

import itertools
import math
from collections import defaultdict
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, field, replace
from typing import Any, NamedTuple

import pandas as pd

from multibody_xval.scenarios.chain_ratios import PER_CELL
from multibody_xval.scenarios.evaluate import Propose
from multibody_xval.scenarios.frequency_grid import LONGEST_CHAIN, MOST_VALUES, AdaptiveGrid, missing, resonances
from multibody_xval.scenarios.model import CASE, DEFAULTS, SINGLE, Case, Config, Run
from multibody_xval.scenarios.plan import runs_at
from multibody_xval.scenarios.result_tables import rows_of
from reference_lcp.defaults import BASE_AMPLITUDE, FEWEST_STEPS_PER_PERIOD, MINIMUM_STEPS_PER_PERIOD
from reference_lcp.errors import ParameterError, choices, shown
from reference_lcp.validation import LARGEST_PARAMETER, MOST_CELLS, MOST_STEPS, checked_array, checked_count

FREQUENCY, STEPS = "frequency_ratio", "steps_per_period"

DRIVE = ("drive", "displacement")
"""What of a case is said under [drive]."""

COUNTS = {
    "cells": (1, MOST_CELLS),
    "modulation_multiple": (1, MOST_STEPS),
    STEPS: (FEWEST_STEPS_PER_PERIOD, MOST_STEPS),
}
"""Parameters that are whole numbers, with their range."""

AXES = tuple(name for name in (*CASE, STEPS) if name not in DRIVE)
"""Everything that may be varied."""

CHAIN = tuple(name for name in AXES if name in DEFAULTS)
"""Everything that may stand under [chain]."""

MOST_POINTS, UNCONFIRMED_POINTS = 1_000_000, 100_000
"""Most points of a sweep, which are in memory together, and of one that runs without a yes."""

SECONDS_A_POINT = 0.1
"""Of a processor that a steady state takes, at least."""


class Place(NamedTuple):
    """One combination of the values of all axes but the frequency ratio."""

    case: Case
    """With a frequency ratio of 1, as the column `curve` of tables of points."""
    minimum: int
    """Fewest steps per period."""


@dataclass(frozen=True, kw_only=True)
class Sweep:
    """Every combination of values of some parameters, by some configurations.

    Raises
    ------
    ParameterError
        If a value is outside its range, a name is unknown, or a list has not one value a cell.
    """

    configs: tuple[Config, ...]
    axes: Mapping[str, tuple[float, ...]]
    """Values by parameter, of `AXES`, in the order of the dimensions; friction and frequency ratio must be among them,
    the latter without values where there is an adaptive grid."""
    chain: Mapping[str, Any] = field(default_factory=dict)
    """Parameters of the cases that are not varied, of `CHAIN`."""
    drive: str = "base"
    displacement: float = BASE_AMPLITUDE
    """U0, or P0 / k_c of a force [m]."""
    steps_per_period: int = MINIMUM_STEPS_PER_PERIOD
    """Fewest steps per period where they are not varied."""
    grid: AdaptiveGrid | None = None
    """Gives the frequency ratios of each curve, instead of values."""
    tolerance_db: float | None = None
    """Largest error of a transmittance that counts as agreement [dB]; without it, the ruler says."""

    def __post_init__(self) -> None:
        if not self.configs:
            raise ParameterError("engines = [] names none; allowed: at least one")
        for name in self.axes:
            if name not in AXES:
                raise ParameterError(f"grid.{name} is unknown; {choices(name, AXES)}")
        for name in ("friction_ratio", FREQUENCY):
            if name not in self.axes:
                raise ParameterError(f"grid.{name} is missing; allowed: at least one value")
        for name, values in self.axes.items():
            if self.grid is None or name != FREQUENCY:
                _check_axis(name, values)
        for name, value in self.chain.items():
            _check_chain(name, value)
        checked_count(STEPS, self.steps_per_period, *COUNTS[STEPS])
        if self.points > MOST_POINTS:
            raise ParameterError(f"{size_text(self)}; allowed: <= {MOST_POINTS:,} points")
        for cells in self.axes.get("cells", (self.chain.get("cells", DEFAULTS["cells"]),)):
            self._check_lists(int(cells))
            if self.grid is not None and cells > LONGEST_CHAIN:
                problem = f"cells = {int(cells)} with an accuracy of {FREQUENCY}, which needs natural frequencies"
                raise ParameterError(f"{problem}; allowed: <= {LONGEST_CHAIN}, or values of {FREQUENCY}")

    def _check_lists(self, cells: int) -> None:
        """Refuse lists that have not a number for every cell."""
        for name, value in self.chain.items():
            if isinstance(value, tuple) and len(value) != cells and name not in self.axes:
                problem = f"chain.{name} has {len(value)} values and the chain {cells} cells"
                raise ParameterError(f"{problem}; allowed: one number, or as many as there are cells")

    @property
    def points(self) -> int:
        """Number of points; of an adaptive sweep, of its curves."""
        return len(self.configs) * math.prod(len(values) or 1 for values in self.axes.values())

    @property
    def places(self) -> list[Place]:
        """Every combination of the values of all axes but the frequency ratio, the last axis fastest."""
        axes = {name: values for name, values in self.axes.items() if name != FREQUENCY}
        combinations = [dict(zip(axes, values, strict=True)) for values in itertools.product(*axes.values())]
        return [
            Place(self.case_at({**own, FREQUENCY: 1.0}), int(own.get(STEPS, self.steps_per_period)))
            for own in combinations
        ]

    def case_at(self, values: Mapping[str, float]) -> Case:
        """Give the case at values of all axes."""
        own: dict[str, Any] = {**self.chain, "drive": self.drive, "displacement": self.displacement, **values}
        own.pop(STEPS, None)
        counts = {name: int(own[name]) for name in COUNTS if name in own}
        return Case(**(own | counts))

    def runs(self) -> list[Run]:
        """Give all runs of a sweep with its ruler's; of an adaptive sweep, those that it begins with."""
        if self.grid is not None:
            return self._runs(self._needed({}))
        places = itertools.product(self.places, self.axes[FREQUENCY])
        return self._runs((config, place, eta) for place, eta in places for config in self.configs)

    @property
    def proposals(self) -> list[tuple[str, Propose]]:
        """Give what the first runs lead to, by its name: the points of adaptive curves."""
        return [] if self.grid is None else [("adaptive curves", self.propose)]

    def propose(self, table: pd.DataFrame) -> list[Run]:
        """Give the runs that adaptive curves need next, by the points so far; none where they are resolved."""
        if self.grid is None:
            return []
        levels: dict[tuple[Config, Place], dict[float, float]] = defaultdict(dict)
        for config, place, eta, level in self._levels(table):
            levels[config, place][eta] = level
        return self._runs(self._needed(levels))

    def _levels(self, table: pd.DataFrame) -> Iterator[tuple[Config, Place, float, float]]:
        """Give the level of every point of the sweep [dB]; NaN where there is no steady state."""
        own = self.own_points(table)
        for config, curve, steps, eta, status, level in rows_of(
            own, "config", "curve", STEPS, FREQUENCY, "status", "transmittance_db"
        ):
            yield config, Place(curve, steps), eta, level if status == "periodic" else math.nan

    def _needed(
        self, levels: Mapping[tuple[Config, Place], Mapping[float, float]]
    ) -> Iterator[tuple[Config, Place, float]]:
        """Give what every curve needs next."""
        for place in self.places:
            peaks = resonances(place.case)
            for config in self.configs:
                assert self.grid is not None
                for eta in missing(self.grid, peaks, levels.get((config, place), {})):
                    yield config, place, eta

    def _runs(self, wanted: Iterable[tuple[Config, Place, float]]) -> list[Run]:
        """Give the runs of configurations at places and frequencies, with the ruler's."""
        runs: dict[Run, None] = {}
        for config, place, eta in wanted:
            runs |= dict.fromkeys(runs_at([config], [replace(place.case, frequency_ratio=eta)], place.minimum))
        return list(runs)

    def with_config(self, config: Config) -> "Sweep":
        """Give the sweep with one more configuration in front, unless it has it."""
        return replace(self, configs=tuple(dict.fromkeys((config, *self.configs))))

    def own_points(self, table: pd.DataFrame) -> pd.DataFrame:
        """Give the rows of a table that are points of this sweep, with a column ``steps_per_period``.

        Rows of the ruler and those that edges have added are left out; a row that is in two combinations comes twice.
        """
        places = pd.DataFrame(self.places, columns=["curve", STEPS])
        rows = table[table.config.isin(self.configs)].merge(places, on="curve", how="inner")
        taken = pd.Series([case.steps(own) for case, own in rows_of(rows, "case", STEPS)], rows.index, dtype=int)
        rows = rows[rows.steps == taken]
        if self.grid is None:
            rows = rows[rows[FREQUENCY].isin(self.axes[FREQUENCY])]
        return rows.reset_index(drop=True)


def _check_axis(name: str, values: tuple[float, ...]) -> None:
    """Raise a `ParameterError` unless these may be the values of an axis."""
    if not values or len(set(values)) < len(values):
        raise ParameterError(f"grid.{name} = {shown(list(values))}; allowed: at least one value, none of them twice")
    if len(values) > MOST_VALUES:
        raise ParameterError(f"grid.{name} has {len(values)} values; allowed: <= {MOST_VALUES}")
    for value in values:
        _check_value(f"grid.{name}", name, value)


def _check_chain(name: str, value: Any) -> None:
    """Raise a `ParameterError` unless this may stand under [chain]."""
    if name not in CHAIN:
        raise ParameterError(f"chain.{name} is unknown; {choices(name, CHAIN)}")
    if isinstance(value, tuple) and name not in PER_CELL:
        raise ParameterError(f"chain.{name} = {shown(list(value))} is a list; allowed: one number")
    _check_value(f"chain.{name}", name, value)


def _check_value(key: str, name: str, value: Any) -> None:
    if name in COUNTS:
        whole = int(value) if isinstance(value, float) and value.is_integer() else value
        checked_count(key, whole, *COUNTS[name])
    else:
        requirement, largest = SINGLE.get(name, (PER_CELL.get(name), LARGEST_PARAMETER))
        checked_array(key, value, requirement or "finite", largest=largest)


def check_size(sweep: Sweep, *, yes: bool, how: str) -> None:
    """Raise a `ParameterError` if a sweep is large, and no `yes` was said, as `how` tells."""
    if sweep.points > UNCONFIRMED_POINTS and not yes:
        raise ParameterError(f"{size_text(sweep)}; allowed: <= {UNCONFIRMED_POINTS:,} points, or more with {how}")


def size_text(sweep: Sweep) -> str:
    """Say how many points a sweep has, and for how long they keep a processor busy at least."""
    seconds = sweep.points * SECONDS_A_POINT
    duration = f"{seconds:.2g} s" if seconds < 60 else f"{seconds / 3600:,.3g} h"
    if sweep.grid is not None:
        return f"the sweep has {sweep.points:,} curves, {duration} of one processor's time or more"
    return f"the sweep has {sweep.points:,} points, {duration} of one processor's time or more"
