"""A sweep from a TOML file: what may stand in it, and errors that name the place."""

import tomllib
from collections.abc import Callable
from pathlib import Path
from typing import Annotated, Any, Literal

import numpy as np
from pydantic import BaseModel, ConfigDict, Discriminator, Field, Tag, ValidationError

from multibody_xval.engines.interface.variant import variants_named
from multibody_xval.scenarios.frequency_grid import MOST_VALUES, AdaptiveGrid, Decibel
from multibody_xval.scenarios.model import Config
from multibody_xval.scenarios.sweep_mistakes import mistake
from multibody_xval.scenarios.sweep_plan import COUNTS, FREQUENCY, Sweep
from reference_lcp.defaults import BASE_AMPLITUDE, CHAIN_STIFFNESS, FEWEST_STEPS_PER_PERIOD, MINIMUM_STEPS_PER_PERIOD
from reference_lcp.errors import ParameterError, checked_path
from reference_lcp.validation import LARGEST_PARAMETER, LARGEST_UNIT, MOST_STEPS

EXAMPLE = """\
# A sweep: every combination of the values under [grid], by every engine.
#
#   multibody-xval example > sweep.toml
#   multibody-xval sweep sweep.toml --store sweep.sqlite --out sweep.nc

# Engines: ENGINE[:FORMULATION[:PRESET]], joint and tuned where they are left out; all in place of a part is every one.
# Options that are changed follow, such as "mujoco:noslip_iterations=3".
engines = ["reference", "mujoco", "mujoco:contact"]

# Fewest steps per period; more are taken where the stability of the step needs them. At least 16.
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
# A normal force that swings, N0 (1 + a sin(Ω t + φ)); contacts open where a > 1:
# modulation = 0.5             # a, >= 0
# modulation_multiple = 2      # Ω / ω, a whole number >= 1
# modulation_phase = 0.0       # φ [rad]

[drive]
kind = "base"                # the base moves; "force": a force acts on the outer mass of cell 1
amplitude = 0.01             # > 0: of the base U0 [m], of the force P0 [N]; friction ratios are over k_c U0 or P0

# [tolerances]
# Every point is judged by the motion without an error of a time step; instead of what the time step explains, allow:
# transmittance_db = 0.1     # > 0
"""

LARGEST_FILE = 10_000_000
"""Bytes of a sweep file: half a million values one by one; a device may never end."""

AMPLITUDES = {"base": BASE_AMPLITUDE, "force": CHAIN_STIFFNESS * BASE_AMPLITUDE}
"""U0 [m] or P0 [N] by kind of drive where none is given: both displace alike."""


class _Table(BaseModel):
    model_config = ConfigDict(extra="forbid", strict=True, frozen=True)


_Bounded = Annotated[float, Field(ge=-LARGEST_PARAMETER, le=LARGEST_PARAMETER, allow_inf_nan=False)]


class _Range(_Table):
    first: _Bounded
    last: _Bounded
    points: Annotated[int, Field(ge=2, le=MOST_VALUES)]


class _Drive(_Table):
    kind: Literal["base", "force"] = "base"
    amplitude: Annotated[float, Field(gt=0, le=LARGEST_UNIT, allow_inf_nan=False)] = Field(
        default_factory=lambda read: AMPLITUDES[read["kind"]]
    )


class _Tolerances(_Table):
    transmittance_db: Decibel


def _form(values: object) -> str:
    """Give the form in which the values of an axis are written."""
    if isinstance(values, dict):
        return "adaptive" if "accuracy_db" in values else "range"
    return "values"


_Axis = Annotated[
    Annotated[list[float], Tag("values")] | Annotated[_Range, Tag("range")] | Annotated[AdaptiveGrid, Tag("adaptive")],
    Discriminator(_form),
]


class _File(_Table):
    """The content of a sweep file, as `EXAMPLE` shows it."""

    engines: Annotated[list[str], Field(min_length=1)]
    grid: dict[str, _Axis]
    chain: dict[str, float | list[float]] = {}
    drive: _Drive = _Drive()
    tolerances: _Tolerances | None = None
    steps_per_period: Annotated[int, Field(ge=FEWEST_STEPS_PER_PERIOD, le=MOST_STEPS)] = MINIMUM_STEPS_PER_PERIOD


def sweep_of(content: dict[str, Any], named: Callable[[list[str]], list[Config]] = variants_named) -> Sweep:
    """Check plain data as a sweep file holds them.

    Parameters
    ----------
    content
        What a sweep file holds.
    named
        Gives the configurations of names; engines have to be installed without it.

    Raises
    ------
    ParameterError
        If a key is unknown or missing, or a value outside its range.
    """
    try:
        file = _File.model_validate(content)
    except ValidationError as problem:
        raise mistake(problem) from None
    adaptive = {name: own for name, own in file.grid.items() if isinstance(own, AdaptiveGrid)}
    for name in adaptive.keys() - {FREQUENCY}:
        raise ParameterError(f"grid.{name} has an accuracy; allowed: of {FREQUENCY} only")
    unit = 1.0 if file.drive.kind == "base" else CHAIN_STIFFNESS
    return Sweep(
        configs=tuple(dict.fromkeys(named(file.engines))),
        axes={name: _values(name, own) for name, own in file.grid.items()},
        chain={name: tuple(own) if isinstance(own, list) else _whole(name, own) for name, own in file.chain.items()},
        drive=file.drive.kind,
        displacement=file.drive.amplitude / unit,
        steps_per_period=file.steps_per_period,
        grid=adaptive.get(FREQUENCY),
        tolerance_db=None if file.tolerances is None else file.tolerances.transmittance_db,
    )


def content_of(sweep: Sweep) -> dict[str, Any]:
    """Give plain data that `sweep_of` reads."""
    unit = 1.0 if sweep.drive == "base" else CHAIN_STIFFNESS
    grid: dict[str, Any] = {name: list(values) for name, values in sweep.axes.items()}
    if sweep.grid is not None:
        grid[FREQUENCY] = sweep.grid.model_dump()
    return {
        "engines": [str(config) for config in sweep.configs],
        "steps_per_period": sweep.steps_per_period,
        "grid": grid,
        "chain": {name: list(own) if isinstance(own, tuple) else own for name, own in sweep.chain.items()},
        "drive": {"kind": sweep.drive, "amplitude": sweep.displacement * unit},
        **({} if sweep.tolerance_db is None else {"tolerances": {"transmittance_db": sweep.tolerance_db}}),
    }


def read_sweep(file: Path) -> Sweep:
    """Read a sweep, TOML as `EXAMPLE` shows it.

    Raises
    ------
    ParameterError
        If the file cannot be read, is no TOML, or holds something that is not allowed: it names file, key and value.
    """
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
        return sweep_of(content)
    except ParameterError as problem:
        raise ParameterError(f"{file}: {problem}") from None


def _values(name: str, written: list[float] | _Range | AdaptiveGrid) -> tuple[float, ...]:
    """Give the values of an axis; none where they are adaptive."""
    if isinstance(written, AdaptiveGrid):
        return ()
    values = (
        np.linspace(written.first, written.last, written.points).tolist() if isinstance(written, _Range) else written
    )
    return tuple(_whole(name, value) for value in values)


def _whole(name: str, value: float) -> float:
    """Give the value of a parameter that is counted as a whole number."""
    return int(value) if name in COUNTS and float(value).is_integer() else value
