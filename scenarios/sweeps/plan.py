"""A sweep as data: every combination of values of any parameters, by every configuration; its cases and its runs."""

import itertools
import math
from collections import defaultdict
from collections.abc import Mapping, Sequence
from dataclasses import replace
from functools import cached_property
from typing import Annotated, Any, Literal, NamedTuple, Self

import numpy as np
import pandas as pd
from pydantic import BaseModel, ConfigDict, Discriminator, Field, Tag, model_validator

from multibody_xval.scenarios.cases.chain_ratios import PER_CELL
from multibody_xval.scenarios.model import CASE, DEFAULTS, SINGLE, Case, Config, Run
from multibody_xval.scenarios.plan import runs_at
from multibody_xval.scenarios.result_tables import rows_of
from multibody_xval.scenarios.running.evaluate import Propose
from multibody_xval.scenarios.sweeps.frequency_grid import (
    LONGEST_CHAIN,
    MOST_VALUES,
    AdaptiveGrid,
    Decibel,
    missing,
    resonances,
)
from reference_lcp.defaults import BASE_AMPLITUDE, CHAIN_STIFFNESS, FEWEST_STEPS_PER_PERIOD, MINIMUM_STEPS_PER_PERIOD
from reference_lcp.errors import ParameterError, choices, shown
from reference_lcp.validation import (
    LARGEST_PARAMETER,
    LARGEST_UNIT,
    MOST_CELLS,
    MOST_STEPS,
    checked_array,
    checked_count,
)

FREQUENCY, STEPS = "frequency_ratio", "steps_per_period"

COUNTS = {
    "cells": (1, MOST_CELLS),
    "modulation_multiple": (1, MOST_STEPS),
    STEPS: (FEWEST_STEPS_PER_PERIOD, MOST_STEPS),
}
"""Parameters that are whole numbers, with their range."""

AXES = tuple(name for name in (*CASE, STEPS) if name not in ("drive", "displacement"))
"""Everything that may be varied."""

CHAIN = tuple(name for name in AXES if name in DEFAULTS)
"""Everything that may stand under [chain]."""

UNITS = {"base": 1.0, "force": CHAIN_STIFFNESS}
"""Amplitude of a drive over the displacement U0 or P0 / k_c, by its kind."""

MOST_POINTS, UNCONFIRMED_POINTS = 1_000_000, 100_000
"""Most points of a sweep, which are in memory together, and of one that runs without a yes."""

SECONDS_A_POINT = 0.1
"""Of a processor that a steady state takes, at least."""

Bounded = Annotated[float, Field(ge=-LARGEST_PARAMETER, le=LARGEST_PARAMETER, allow_inf_nan=False)]


class Table(BaseModel):
    """A table of a sweep file."""

    model_config = ConfigDict(extra="forbid", strict=True, frozen=True)


class Range(Table):
    """Values that are evenly spaced."""

    first: Bounded
    last: Bounded
    points: Annotated[int, Field(ge=2, le=MOST_VALUES)]


class Drive(Table):
    """What moves the chain: its base, or a force on the outer mass of cell 1."""

    kind: Literal["base", "force"] = "base"
    amplitude: Annotated[float, Field(gt=0, le=LARGEST_UNIT, allow_inf_nan=False)] = Field(
        default_factory=lambda read: BASE_AMPLITUDE * UNITS[read["kind"]]
    )
    """U0 [m] or P0 [N]; without one, both displace alike."""


class Tolerances(Table):
    """What counts as agreement, instead of what the ruler says."""

    transmittance_db: Decibel
    """Largest error [dB]."""


def _form(values: object) -> str:
    """Give the form in which the values of a parameter are written."""
    if isinstance(values, dict | Range | AdaptiveGrid):
        return "adaptive" if "accuracy_db" in dict(values) else "range"
    return "values"


Axis = Annotated[
    Annotated[list[float], Tag("values")] | Annotated[Range, Tag("range")] | Annotated[AdaptiveGrid, Tag("adaptive")],
    Discriminator(_form),
]


class Place(NamedTuple):
    """One combination of the values of all axes but the frequency ratio."""

    case: Case
    """With a frequency ratio of 1, as the column `curve` of tables of points."""
    minimum: int
    """Fewest steps per period."""


class Sweep(Table):
    """Every combination of values of some parameters, by some configurations, as a sweep file holds it.

    Raises
    ------
    ParameterError
        If a name is unknown, or a combination of values is no chain.
    """

    engines: Annotated[list[str], Field(min_length=1)]
    """Configurations by their full names: see `sweep_file.sweep_of`."""
    grid: dict[str, Axis]
    """Values by parameter, of `AXES`, in the order of the dimensions; friction and frequency ratio are among them."""
    chain: dict[str, float | list[float]] = {}
    """Parameters that are not varied, of `CHAIN`."""
    drive: Drive = Drive()
    tolerances: Tolerances | None = None
    steps_per_period: Annotated[int, Field(ge=FEWEST_STEPS_PER_PERIOD, le=MOST_STEPS)] = MINIMUM_STEPS_PER_PERIOD
    """Fewest steps per period where they are not varied."""

    @model_validator(mode="after")
    def _check(self) -> Self:
        for table, names, given in (("grid", AXES, self.axes), ("chain", CHAIN, self.chain)):
            for name, values in given.items():
                _check_values(f"{table}.{name}", name, names, values)
        for name in ("friction_ratio", FREQUENCY):
            if name not in self.grid:
                raise ParameterError(f"grid.{name} is missing; allowed: at least one value")
        for name, own in self.grid.items():
            adaptive = isinstance(own, AdaptiveGrid)
            if adaptive and name != FREQUENCY:
                raise ParameterError(f"grid.{name} has an accuracy; allowed: of {FREQUENCY} only")
            if not adaptive and not 0 < len(self.axes[name]) == len(set(self.axes[name])):
                problem = f"grid.{name} = {shown(list(self.axes[name]))}"
                raise ParameterError(f"{problem}; allowed: at least one value, none of them twice")
        if self.points > MOST_POINTS:
            raise ParameterError(f"{size_text(self)}; allowed: <= {MOST_POINTS:,} points")
        usual: Any = self.chain.get("cells", DEFAULTS["cells"])
        for cells in self.axes.get("cells", (usual,)):
            self._check_cells(int(cells))
        return self

    def _check_cells(self, cells: int) -> None:
        """Refuse lists that have not a number for every cell, and chains that are too long for an adaptive grid."""
        for name, value in self.chain.items():
            if isinstance(value, list) and len(value) != cells and name not in self.grid:
                problem = f"chain.{name} has {len(value)} values and the chain {cells} cells"
                raise ParameterError(f"{problem}; allowed: one number, or as many as there are cells")
        if self.adaptive is not None and cells > LONGEST_CHAIN:
            problem = f"cells = {cells} with an accuracy of {FREQUENCY}, which needs natural frequencies"
            raise ParameterError(f"{problem}; allowed: <= {LONGEST_CHAIN}, or values of {FREQUENCY}")

    @cached_property
    def configs(self) -> tuple[Config, ...]:
        """Give the configurations."""
        return tuple(map(Config.parse, self.engines))

    @cached_property
    def axes(self) -> dict[str, tuple[float, ...]]:
        """Give the values by parameter; none of the frequency ratio where they are adaptive."""
        return {name: tuple(_plain(name, value) for value in _values(own)) for name, own in self.grid.items()}

    @property
    def adaptive(self) -> AdaptiveGrid | None:
        """What gives the frequency ratios of each curve, instead of values."""
        own = self.grid[FREQUENCY]
        return own if isinstance(own, AdaptiveGrid) else None

    @property
    def tolerance_db(self) -> float | None:
        """Largest error of a transmittance that counts as agreement [dB]; without it, the ruler says."""
        return None if self.tolerances is None else self.tolerances.transmittance_db

    @property
    def points(self) -> int:
        """Number of points; of an adaptive sweep, of its curves."""
        return len(self.engines) * math.prod(len(values) or 1 for values in self.axes.values())

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
        displacement = self.drive.amplitude / UNITS[self.drive.kind]
        own: dict[str, Any] = {**self.chain, **values, "drive": self.drive.kind, "displacement": displacement}
        return Case(**{name: _plain(name, value) for name, value in own.items() if name != STEPS})

    @property
    def proposals(self) -> list[tuple[str, Propose]]:
        """Give what the first runs lead to, by its name: the points of adaptive curves."""
        return [] if self.adaptive is None else [("adaptive curves", self.runs)]

    def runs(self, table: pd.DataFrame | None = None) -> list[Run]:
        """Give the runs that every curve needs by the points so far, with those of the ruler there."""
        levels: dict[tuple[Config, Place], dict[float, float]] = defaultdict(dict)
        if table is not None:
            own = self.own_points(table)
            level = own.transmittance_db.where(own.status == "periodic")
            for config, curve, steps, eta, db in rows_of(
                own.assign(level=level), "config", "curve", STEPS, FREQUENCY, "level"
            ):
                levels[config, Place(curve, steps)][eta] = db
        runs: dict[Run, None] = {}
        for place, config in itertools.product(self.places, self.configs):
            for eta in self._missing(place.case, levels[config, place]):
                runs |= dict.fromkeys(runs_at([config], [replace(place.case, frequency_ratio=eta)], place.minimum))
        return list(runs)

    def _missing(self, curve: Case, levels: Mapping[float, float]) -> list[float]:
        """Give the frequency ratios that a curve needs next, by its levels so far."""
        if self.adaptive is None:
            return [eta for eta in self.axes[FREQUENCY] if eta not in levels]
        return missing(self.adaptive, resonances(curve), levels)

    def with_config(self, config: Config) -> "Sweep":
        """Give the sweep with one more configuration in front, unless it has it."""
        engines = list(dict.fromkeys([str(config), *self.engines]))
        return Sweep.model_validate(self.model_dump(exclude_none=True) | {"engines": engines})

    def own_points(self, table: pd.DataFrame) -> pd.DataFrame:
        """Give the rows of a table that are points of this sweep, with a column ``steps_per_period``.

        Rows of the ruler and those that edges have added are left out; a row that is in two combinations comes twice.
        """
        places = pd.DataFrame(self.places, columns=["curve", STEPS])
        rows = table[table.config.isin(self.configs)].merge(places, on="curve", how="inner")
        taken = pd.Series([case.steps(own) for case, own in rows_of(rows, "case", STEPS)], rows.index, dtype=int)
        rows = rows[rows.steps == taken]
        if self.adaptive is None:
            rows = rows[rows[FREQUENCY].isin(self.axes[FREQUENCY])]
        return rows.reset_index(drop=True)


def _values(written: list[float] | Range | AdaptiveGrid) -> list[float]:
    if isinstance(written, Range):
        return np.linspace(written.first, written.last, written.points).tolist()
    return written if isinstance(written, list) else []


def _plain(name: str, value: Any) -> Any:
    """Give the value of a parameter as a case has it: tuples, and whole numbers of what is counted."""
    whole = name in COUNTS and isinstance(value, float) and value.is_integer()
    return tuple(value) if isinstance(value, list) else int(value) if whole else value


def _check_values(key: str, name: str, names: Sequence[str], values: Any) -> None:
    """Raise a `ParameterError` unless a parameter may have these values."""
    if name not in names:
        raise ParameterError(f"{key} is unknown; {choices(name, names)}")
    if name in COUNTS:
        for value in values if isinstance(values, tuple) else [values]:
            checked_count(key, _plain(name, value), *COUNTS[name])
        return
    if isinstance(values, list) and name not in PER_CELL:
        raise ParameterError(f"{key} = {shown(values)} is a list; allowed: one number")
    requirement, largest = SINGLE.get(name, (PER_CELL.get(name), LARGEST_PARAMETER))
    checked_array(key, values, requirement or "finite", largest=largest)


def check_size(sweep: Sweep, *, yes: bool, how: str) -> None:
    """Raise a `ParameterError` if a sweep is large, and no `yes` was said, as `how` tells."""
    if sweep.points > UNCONFIRMED_POINTS and not yes:
        raise ParameterError(f"{size_text(sweep)}; allowed: <= {UNCONFIRMED_POINTS:,} points, or more with {how}")


def size_text(sweep: Sweep) -> str:
    """Say how many points a sweep has, and for how long they keep a processor busy at least."""
    seconds, what = sweep.points * SECONDS_A_POINT, "points" if sweep.adaptive is None else "curves"
    duration = f"{seconds:.2g} s" if seconds < 60 else f"{seconds / 3600:,.3g} h"
    return f"the sweep has {sweep.points:,} {what}, {duration} of one processor's time or more"
