"""A sweep from a TOML file: what may stand in it, and errors that name the place."""

import tomllib
from collections.abc import Sequence
from functools import cached_property
from pathlib import Path
from typing import Annotated, Literal, Self

import numpy as np
from pydantic import BaseModel, ConfigDict, Discriminator, Field, Tag, ValidationError, model_validator

from multibody_xval.engines.interface.variant import Variant, variants_named
from multibody_xval.scenarios.runs.parameters import (
    DEFAULT_AMPLITUDE,
    ChainRatios,
    Decibel,
    Excitation,
    Positive,
    first_error,
)
from multibody_xval.scenarios.sweeps.adaptive_grid import MOST_VALUES, AdaptiveAxis
from multibody_xval.scenarios.sweeps.sweep import GivenTolerance, Sweep, baseline_of
from reference_lcp.defaults import FEWEST_STEPS_PER_PERIOD, MINIMUM_STEPS_PER_PERIOD
from reference_lcp.errors import ParameterError, checked_path
from reference_lcp.validation import LARGEST_PARAMETER, MOST_STEPS

EXAMPLE = """\
# A sweep: every combination of the values under [grid], by every engine.
#
#   multibody-xval example > sweep.toml
#   multibody-xval sweep sweep.toml --store sweep.sqlite --out sweep.nc

# Engines: ENGINE[:FORMULATION[:PRESET]], joint and tuned where they are left out; all in place of a part is every one.
# Options that are changed follow, such as "mujoco:noslip_iterations=3".
engines = ["reference", "mujoco", "mujoco:contact"]

# Fewest steps a period; more are taken where the stability of the step needs them. At least 16.
steps_per_period = 400

[grid]
# Values one by one, or evenly spaced from the first to the last. Ratios are those of the paper:
friction_ratio = [0.1, 0.3, 1.0]                               # friction bound over k_c U0, >= 0
frequency_ratio = { first = 0.3, last = 1.6, points = 14 }     # ω / ω_r, > 0
# Points where each curve needs them, until interpolation is right to so many dB; the last two are guards:
# frequency_ratio = { first = 0.3, last = 1.6, accuracy_db = 0.5, least_spacing = 5e-5, most_points = 500 }
# Any parameter of the chain may be varied as well, and steps_per_period:
# mass_ratio = [0.5, 1.0, 2.0]

[chain]
# What is not varied; these are the defaults, the chain of the paper's figure 3.
cells = 7                    # >= 1
mass_ratio = 1.0             # inner over outer mass, > 0
stiffness_ratio = 1.0        # inner over chain stiffness, > 0
damping_ratio = 0.01         # c_c / (2 sqrt(k_c m_o)), >= 0
inner_damping_ratio = 0.0    # c_i / (2 sqrt(k_i m_i)), >= 0
# Each of these may be a list with a number for every cell, from the base on. Where cells differ, so may:
# outer_mass_ratio = [1.0, 0.9, 1.1, 1.0, 1.2, 0.8, 1.0]    # outer mass over the unit of mass, > 0
# chain_stiffness_ratio = 1.0                               # chain stiffness over its unit, > 0
# friction_profile = 1.0                                    # friction bound over that of friction_ratio, >= 0
# Which coefficient makes up that bound, with a normal force for it:
# friction_coefficient = 0.5                                # μ, > 0

[drive]
kind = "base"                # the base moves; "force": a force acts on the outer mass of cell 1
amplitude = 0.01             # > 0: of the base U0 [m], of the force P0 [N]; friction ratios are over k_c U0 or P0

# [tolerances]
# Compare every point with the reference's, which has to be among the engines, and count verdicts:
# transmittance_db = 0.1     # > 0
"""


LARGEST_FILE = 10_000_000
"""Bytes of a sweep file: half a million values one by one; a device may never end."""


class _Table(BaseModel):
    model_config = ConfigDict(extra="forbid", strict=True, frozen=True)


_Bounded = Annotated[float, Field(ge=-LARGEST_PARAMETER, le=LARGEST_PARAMETER, allow_inf_nan=False)]


class _Range(_Table):
    first: _Bounded
    last: _Bounded
    points: Annotated[int, Field(ge=2, le=MOST_VALUES)]


class _Drive(_Table):
    kind: Literal["base", "force"] = "base"
    amplitude: Positive = Field(default_factory=lambda read: DEFAULT_AMPLITUDE[read["kind"]])


class _Tolerances(_Table):
    transmittance_db: Decibel


def _kind_of_axis(values: object) -> str:
    """Give the form in which the values of an axis are written."""
    if isinstance(values, dict):
        return "adaptive" if "accuracy_db" in values else "range"
    return "values"


_Axis = Annotated[
    Annotated[list[float], Tag("values")] | Annotated[_Range, Tag("range")] | Annotated[AdaptiveAxis, Tag("adaptive")],
    Discriminator(_kind_of_axis),
]

_WHOLE = ("cells", "steps_per_period")


class SweepFile(_Table):
    """The content of a sweep file, as `EXAMPLE` shows it."""

    engines: Annotated[list[str], Field(min_length=1)]
    grid: dict[str, _Axis]
    chain: ChainRatios = ChainRatios()
    drive: _Drive = _Drive()
    tolerances: _Tolerances | None = None
    """What counts as agreement; ``None`` for no comparison."""
    steps_per_period: Annotated[int, Field(ge=FEWEST_STEPS_PER_PERIOD, le=MOST_STEPS)] = MINIMUM_STEPS_PER_PERIOD

    @model_validator(mode="after")
    def _check(self) -> Self:
        """Refuse what each value alone does not show."""
        for name, values in self.grid.items():
            if isinstance(values, AdaptiveAxis) and name != "frequency_ratio":
                raise ParameterError(f"grid.{name} has an accuracy; allowed: of frequency_ratio only")
        self._check_lists()
        self.sweep.task(*next(self.sweep.grid_points())).setting()
        if self.tolerances is not None and self.sweep.tolerance is None:
            given = self.tolerances.transmittance_db
            problem = f"tolerances.transmittance_db = {given:g} without the reference among the engines"
            raise ParameterError(f"{problem}; allowed: engines with 'reference'")
        return self

    def _check_lists(self) -> None:
        """Refuse lists that have not a number for every cell of every chain of the sweep."""
        lists = {name: values for name, values in vars(self.chain).items() if isinstance(values, tuple)}
        for name in lists.keys() - self.sweep.axes.keys():
            for cells in self.sweep.axes.get("cells", (self.chain.cells,)):
                if len(lists[name]) != cells:
                    problem = f"chain.{name} has {len(lists[name])} values and the chain {cells:g} cells"
                    raise ParameterError(f"{problem}; allowed: one number, or as many as there are cells")

    @cached_property
    def sweep(self) -> Sweep:
        """Every combination of the values; of an adaptive axis those with which every curve begins."""
        axes = {name: tuple(_values(written)) for name, written in self.grid.items()}
        whole = {name: tuple(int(v) if v.is_integer() else v for v in axes[name]) for name in _WHOLE if name in axes}
        variants = tuple(variants_named(self.engines))
        adaptive = self.grid.get("frequency_ratio")
        return Sweep(
            variants=variants,
            axes=axes | whole,
            ratios=self.chain,
            steps_per_period=self.steps_per_period,
            excitation=Excitation(**dict(self.drive)),
            frequencies=adaptive if isinstance(adaptive, AdaptiveAxis) else None,
            tolerance=self._tolerance(variants),
        )

    def _tolerance(self, variants: Sequence[Variant]) -> GivenTolerance | None:
        """Give the tolerance with what it compares with; ``None`` without either."""
        baseline = baseline_of(variants)
        if self.tolerances is None or baseline is None:
            return None
        return GivenTolerance(transmittance_db=self.tolerances.transmittance_db, baseline=baseline)


def read_sweep(file: Path) -> Sweep:
    """Read a sweep, TOML as `EXAMPLE` shows it; a `ParameterError` names file, key, value, and what is allowed."""
    try:
        with checked_path("sweep", file).open("rb") as opened:
            text = opened.read(LARGEST_FILE + 1)
    except OSError as problem:
        raise ParameterError(f"{file} cannot be read: {problem.strerror}") from None
    if len(text) > LARGEST_FILE:
        raise ParameterError(f"{file} is no sweep: it has more than {LARGEST_FILE} bytes; allowed: up to so many")
    try:
        content = tomllib.loads(text.decode())
    except RecursionError:
        raise ParameterError(f"{file} is no TOML: arrays and tables in one another; allowed: two") from None
    except ValueError as problem:  # of integers of more than 4300 digits too
        raise ParameterError(f"{file} is no TOML: {problem}") from None
    try:
        return SweepFile.model_validate(content).sweep
    except ValidationError as problem:
        raise ParameterError(f"{file}: {first_error(problem, 'what `multibody-xval example` shows')}") from None


def _values(written: list[float] | _Range | AdaptiveAxis) -> Sequence[float]:
    if isinstance(written, AdaptiveAxis):
        return written.start()
    if isinstance(written, _Range):
        values: list[float] = np.linspace(written.first, written.last, written.points).tolist()
        return values
    return written
