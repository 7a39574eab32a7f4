"""A sweep from a TOML file: what may stand in it, and errors that name the place."""

import tomllib
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Any, Literal

import numpy as np
from pydantic import BaseModel, ConfigDict, Discriminator, Field, Tag, ValidationError

from engines.interface.variant import Variant, variants_named, variants_of
from reference_lcp.chain.simulation import FEWEST_STEPS_PER_PERIOD, MINIMUM_STEPS_PER_PERIOD
from reference_lcp.validation import ParameterError, checked_choice
from scenarios.studies.adaptive_grid import LEAST_SPACING, MOST_POINTS, START_POINTS, AdaptiveAxis
from scenarios.sweeps.sweep import Sweep
from scenarios.sweeps.verdicts import baseline_of
from scenarios.tasks.parameters import DEFAULT_AMPLITUDE, ChainRatios, Excitation

EXAMPLE = """\
# A sweep: every combination of the values under [grid], by every engine.
#
#   python -m scenarios example > sweep.toml
#   python -m scenarios sweep sweep.toml --store sweep.sqlite --out sweep.nc

# Who is asked: ENGINE (all its formulations and presets), ENGINE:FORMULATION (tuned) or ENGINE:FORMULATION:PRESET.
engines = ["reference:joint", "mujoco:joint", "mujoco:contact"]

# Presets of the engines above whose presets are not named, instead of all, or of the tuned one:
# presets = ["default", "tuned"]

# Fewest steps a period; more are taken where the stability of the step asks for them. At least 3.
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
# friction_profile = 1.0                                    # friction bound over what friction_ratio says, >= 0

[drive]
kind = "base"                # the base moves; "force": a force acts on the outer mass of cell 1
amplitude = 0.01             # > 0: of the base U0 [m], of the force P0 [N]; friction ratios are over k_c U0 or P0

# [tolerances]
# Compare every point with the reference's, which has to be among the engines, and count verdicts:
# transmittance_db = 0.1     # > 0
"""

Positive = Annotated[float, Field(gt=0, allow_inf_nan=False)]
NotNegative = Annotated[float, Field(ge=0, allow_inf_nan=False)]


class _Table(BaseModel):
    model_config = ConfigDict(extra="forbid", strict=True)


class _Range(_Table):
    first: float
    last: float
    points: Annotated[int, Field(ge=2)]


class _Adaptive(_Table):
    first: Positive
    last: Positive
    accuracy_db: Positive
    least_spacing: Positive = LEAST_SPACING
    most_points: Annotated[int, Field(ge=START_POINTS)] = MOST_POINTS


def _kind_of_ratio(value: object) -> str:
    """Tell whether cells are alike."""
    return "one a cell" if isinstance(value, list) else "one for all"


_PositiveRatio = Annotated[
    Annotated[Positive, Tag("one for all")] | Annotated[list[Positive], Tag("one a cell")],
    Discriminator(_kind_of_ratio),
]
_Ratio = Annotated[
    Annotated[NotNegative, Tag("one for all")] | Annotated[list[NotNegative], Tag("one a cell")],
    Discriminator(_kind_of_ratio),
]


class _Chain(_Table):
    cells: Annotated[int, Field(ge=1)] = 7
    mass_ratio: _PositiveRatio = 1.0
    stiffness_ratio: _PositiveRatio = 1.0
    damping_ratio: _Ratio = 0.01
    inner_damping_ratio: _Ratio = 0.0
    outer_mass_ratio: _PositiveRatio = 1.0
    chain_stiffness_ratio: _PositiveRatio = 1.0
    friction_profile: _Ratio = 1.0

    def ratios(self, varied: Mapping[str, Sequence[float]]) -> ChainRatios:
        """Give the ratios, if lists have a number for every cell of every chain that is asked for."""
        given = self.model_dump()
        lists = {name: tuple(value) for name, value in given.items() if isinstance(value, list)}
        for name, values in lists.items():
            for cells in varied.get("cells", (self.cells,)):
                if name not in varied and len(values) != cells:
                    problem = f"chain.{name} has {len(values)} values and the chain {cells:g} cells"
                    raise ParameterError(f"{problem}; allowed: one number, or as many as there are cells")
        return ChainRatios(**{**given, **lists})


class _Drive(_Table):
    kind: Literal["base", "force"] = "base"
    amplitude: Positive | None = None


class _Tolerances(_Table):
    transmittance_db: Positive


def _kind_of_axis(values: object) -> str:
    """Tell how the values of an axis are written."""
    if isinstance(values, dict):
        return "adaptive" if "accuracy_db" in values else "range"
    return "values"


_Axis = Annotated[
    Annotated[list[float], Tag("values")] | Annotated[_Range, Tag("range")] | Annotated[_Adaptive, Tag("adaptive")],
    Discriminator(_kind_of_axis),
]


class _File(_Table):
    engines: Annotated[list[str], Field(min_length=1)]
    presets: Annotated[list[str], Field(min_length=1)] | None = None
    grid: dict[str, _Axis]
    chain: _Chain = _Chain()
    drive: _Drive = _Drive()
    tolerances: _Tolerances | None = None
    steps_per_period: Annotated[int, Field(ge=FEWEST_STEPS_PER_PERIOD)] = MINIMUM_STEPS_PER_PERIOD


@dataclass(frozen=True)
class SweepFile:
    """What a file asks for.

    Parameters
    ----------
    sweep
        Every combination of the values; of an adaptive axis those with which every curve begins.
    frequencies
        The adaptive axis; ``None`` without one.
    tolerance_db
        Largest difference from the reference that counts as agreement [dB]; ``None`` for no comparison.
    """

    sweep: Sweep
    frequencies: AdaptiveAxis | None = None
    tolerance_db: float | None = None


def read_sweep(file: Path) -> SweepFile:
    """Read a sweep.

    Parameters
    ----------
    file
        TOML, as `EXAMPLE` shows it.

    Raises
    ------
    ParameterError
        If the file cannot be read, is no TOML, or says something that is not allowed; the message names the file,
        the key, the value and what is allowed.
    """
    try:
        content = tomllib.loads(file.read_text(encoding="utf-8"))
    except (OSError, UnicodeDecodeError) as problem:
        raise ParameterError(f"{file} cannot be read: {problem}") from None
    except tomllib.TOMLDecodeError as problem:
        raise ParameterError(f"{file} is no TOML: {problem}") from None
    try:
        return _asked(_File.model_validate(content))
    except ValidationError as problem:
        raise ParameterError(f"{file}: {_first(problem)}") from None
    except ParameterError as problem:
        raise ParameterError(f"{file}: {problem}") from None


def _asked(read: _File) -> SweepFile:
    adaptive = {name: values for name, values in read.grid.items() if isinstance(values, _Adaptive)}
    for name in adaptive:
        if name != "frequency_ratio":
            raise ParameterError(f"grid.{name} has an accuracy; allowed: of frequency_ratio only")
    frequencies = AdaptiveAxis(**adaptive["frequency_ratio"].model_dump()) if adaptive else None
    axes = {name: tuple(_values(values)) for name, values in read.grid.items()}
    varied = {name: tuple(int(v) if v == int(v) else v for v in axes[name]) for name in _WHOLE if name in axes}
    amplitude = read.drive.amplitude if read.drive.amplitude is not None else DEFAULT_AMPLITUDE[read.drive.kind]
    sweep = Sweep(
        variants=_variants(read.engines, read.presets),
        axes=axes | varied,
        ratios=read.chain.ratios(axes),
        steps_per_period=read.steps_per_period,
        excitation=Excitation(kind=read.drive.kind, amplitude=amplitude),
    )
    tolerance = None if read.tolerances is None else read.tolerances.transmittance_db
    if tolerance is not None and baseline_of(sweep) is None:
        problem = f"tolerances.transmittance_db = {tolerance:g} without the reference among the engines"
        raise ParameterError(f"{problem}; allowed: engines with 'reference:joint'")
    return SweepFile(sweep, frequencies, tolerance)


def _variants(engines: Sequence[str], presets: Sequence[str] | None) -> tuple[Variant, ...]:
    """Give everyone who is asked: what is named, in the presets that are asked for."""
    found = [variant for name in engines for variant in _variants_of(name, presets)]
    return tuple(dict.fromkeys(found))


def _variants_of(name: str, presets: Sequence[str] | None) -> list[Variant]:
    """Give the variants that one name means."""
    if presets is None or name.count(":") > 1:
        return variants_named(name)
    engine, _, formulation = name.partition(":")
    if formulation:
        Variant.parse(name)
    every = [variant for variant in variants_of(engine) if formulation in ("", variant.formulation)]
    for preset in presets:
        checked_choice(f"presets: preset of {name}", preset, sorted({variant.preset_name for variant in every}))
    return [variant for variant in every if variant.preset_name in presets]


_WHOLE = ("cells", "steps_per_period")


def _values(values: list[float] | _Range | _Adaptive) -> list[float]:
    if isinstance(values, _Adaptive):
        return list(AdaptiveAxis(**values.model_dump()).start())
    if isinstance(values, _Range):
        return [float(value) for value in np.linspace(values.first, values.last, values.points)]
    return [float(value) for value in values]


_TAGS = ("values", "range", "adaptive", "one for all", "one a cell")
"""Of the ways in which a value may be written; they stand in no file."""


def _first(problem: ValidationError) -> str:
    """Say what is wrong first, in one line."""
    error: Any = problem.errors()[0]
    place = ".".join(str(part) for part in error["loc"] if part not in _TAGS)
    if error["type"] == "extra_forbidden":
        return f"{place} is unknown; allowed: what `python -m scenarios example` shows"
    if error["type"] == "missing":
        return f"{place} is missing"
    return f"{place} = {error['input']!r}; {error['msg'][0].lower()}{error['msg'][1:]}"
