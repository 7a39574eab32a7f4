"""A sweep from a TOML file: what may stand in it, and errors that name the place."""

import tomllib
from collections.abc import Callable, Collection
from pathlib import Path
from typing import Any

from pydantic import ValidationError

from multibody_xval.engines.interface.texts import checked_path
from multibody_xval.engines.interface.variant import variants_named
from multibody_xval.scenarios.model import EXACT, REFERENCE, Config
from multibody_xval.scenarios.sweeps.frequency_grid import AdaptiveGrid
from multibody_xval.scenarios.sweeps.plan import AXES, CHAIN, FREQUENCY, Drive, Range, Sweep, Tolerances
from reference_lcp.errors import ParameterError, choices, shown

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
# What is not varied; these are the defaults: the paper's chain, with the values assumed here.
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

KEYS: dict[str, Collection[str]] = {
    "": Sweep.model_fields, "grid": AXES, "chain": CHAIN,
    "drive": Drive.model_fields, "tolerances": Tolerances.model_fields,
    "range": Range.model_fields, "adaptive": AdaptiveGrid.model_fields,
}  # fmt: skip
"""Keys of the file, of its tables and of the values of an axis."""

FORMS = ("values", "range", "adaptive", "float", "list[float]")
"""What pydantic puts into the place of a value that may have several forms."""

ALLOWED = {
    "greater_than": "> {gt:g}", "greater_than_equal": ">= {ge:g}", "less_than_equal": "<= {le:g}",
    "finite_number": "a finite number", "float_type": "a number", "int_type": "a whole number",
    "int_from_float": "a whole number", "string_type": "a name in quotes", "list_type": "a list",
    "too_short": "at least one", "literal_error": "{expected}", "missing": "as `multibody-xval example` shows",
}  # fmt: skip
"""What a value may be, by what is wrong with it; of all else, a table."""


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
        sweep = Sweep.model_validate(content)
    except ValidationError as problem:
        errors: list[Any] = problem.errors()
        worst = max(errors, key=lambda own: (own["type"] == "extra_forbidden", len(own["loc"])))
        raise ParameterError(_text(worst)) from None
    configs = list(dict.fromkeys(named(sweep.engines)))
    if EXACT in configs:
        where = "its transmittance is `exact_db` of every point, its edges are `exact` of band_edges"
        raise ParameterError(f"engines = {EXACT} cannot be swept: {where}; allowed: any other, such as {REFERENCE}")
    return sweep.model_copy(update={"engines": list(map(str, configs))})


def _text(error: dict[str, Any]) -> str:
    """Tell of a mistake in one line: its key, its value, and what is allowed."""
    place, kind = [str(part) for part in error["loc"]], error["type"]
    table = place[-2] if len(place) > 1 else ""
    key = ".".join(part for part in place if part not in FORMS)
    if kind == "value_error":
        return ".".join(filter(None, [key, str(error["ctx"]["error"])]))
    if kind == "extra_forbidden":
        names = [*KEYS[table], *["accuracy_db"] * (table == "range" and FREQUENCY in place)]
        return f"{key} is unknown; {choices(place[-1], names)}"
    keys = ", ".join(KEYS.get(place[-1] if place else "", ()))
    allowed = ALLOWED.get(kind, f"a table with {keys}").format(**error.get("ctx", {}))
    wrong = "is missing" if kind == "missing" else f"= {shown(error['input'])}"
    return f"{key or 'a sweep'} {wrong}; allowed: {allowed}"


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
