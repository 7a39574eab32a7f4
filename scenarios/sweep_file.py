"""A sweep from a TOML file: what may stand in it, and errors that name the place."""

import tomllib
from pathlib import Path
from typing import Annotated, Any

import numpy as np
from pydantic import BaseModel, ConfigDict, Field, ValidationError

from engines.variant import variants_named
from reference_lcp.simulation import MINIMUM_STEPS_PER_PERIOD
from reference_lcp.validation import ParameterError
from scenarios.questions import ChainRatios
from scenarios.sweep import Sweep

EXAMPLE = """\
# A sweep: every combination of the values under [grid], by every engine.
#
#   python -m scenarios example > sweep.toml
#   python -m scenarios sweep sweep.toml --store sweep.sqlite --out sweep.nc

# Who is asked: ENGINE (all its formulations and presets), ENGINE:FORMULATION (tuned) or ENGINE:FORMULATION:PRESET.
engines = ["reference:joint", "mujoco:joint", "mujoco:contact"]

# Fewest steps a period; more are taken where the stability of the step asks for them. At least 3.
steps_per_period = 400

[grid]
# Values one by one, or evenly spaced from the first to the last. Ratios are those of the paper:
friction_ratio = [0.1, 0.3, 1.0]                               # friction bound over k_c U0, >= 0
frequency_ratio = { first = 0.3, last = 1.6, points = 14 }     # ω / ω_r, > 0
# Any parameter of the chain may be varied as well, and steps_per_period:
# mass_ratio = [0.5, 1.0, 2.0]

[chain]
# What is not varied; these are the defaults, the chain of the paper's figure 3.
cells = 7                    # >= 1
mass_ratio = 1.0             # inner over outer mass, > 0
stiffness_ratio = 1.0        # inner over chain stiffness, > 0
damping_ratio = 0.01         # c_c / (2 sqrt(k_c m_o)), >= 0
inner_damping_ratio = 0.0    # c_i / (2 sqrt(k_i m_i)), >= 0
"""

Positive = Annotated[float, Field(gt=0, allow_inf_nan=False)]
NotNegative = Annotated[float, Field(ge=0, allow_inf_nan=False)]


class _Table(BaseModel):
    model_config = ConfigDict(extra="forbid", strict=True)


class _Range(_Table):
    first: float
    last: float
    points: Annotated[int, Field(ge=2)]


class _Chain(_Table):
    cells: Annotated[int, Field(ge=1)] = 7
    mass_ratio: Positive = 1.0
    stiffness_ratio: Positive = 1.0
    damping_ratio: NotNegative = 0.01
    inner_damping_ratio: NotNegative = 0.0


class _File(_Table):
    engines: Annotated[list[str], Field(min_length=1)]
    grid: dict[str, list[float] | _Range]
    chain: _Chain = _Chain()
    steps_per_period: Annotated[int, Field(ge=3)] = MINIMUM_STEPS_PER_PERIOD


def read_sweep(file: Path) -> Sweep:
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
        return _sweep(_File.model_validate(content))
    except ValidationError as problem:
        raise ParameterError(f"{file}: {_first(problem)}") from None
    except ParameterError as problem:
        raise ParameterError(f"{file}: {problem}") from None


def _sweep(read: _File) -> Sweep:
    axes = {name: tuple(_values(values)) for name, values in read.grid.items()}
    varied = {name: tuple(int(v) if v == int(v) else v for v in axes[name]) for name in _WHOLE if name in axes}
    return Sweep(
        variants=tuple(dict.fromkeys(variant for name in read.engines for variant in variants_named(name))),
        axes=axes | varied,
        ratios=ChainRatios(**read.chain.model_dump()),
        steps_per_period=read.steps_per_period,
    )


_WHOLE = ("cells", "steps_per_period")


def _values(values: list[float] | _Range) -> list[float]:
    if isinstance(values, _Range):
        return [float(value) for value in np.linspace(values.first, values.last, values.points)]
    return [float(value) for value in values]


def _first(problem: ValidationError) -> str:
    """Say what is wrong first, in one line."""
    error: Any = problem.errors()[0]
    place = ".".join(str(part) for part in error["loc"] if not str(part).startswith(("list[", "_Range")))
    if error["type"] == "extra_forbidden":
        return f"{place} is unknown; allowed: what `python -m scenarios example` shows"
    if error["type"] == "missing":
        return f"{place} is missing"
    return f"{place} = {error['input']!r}; {error['msg'][0].lower()}{error['msg'][1:]}"
