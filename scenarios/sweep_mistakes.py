"""What may stand in a sweep file, in words: a mistake is told by its key, its value and what is allowed."""

from collections.abc import Mapping
from typing import Any

from pydantic import ValidationError

from multibody_xval.scenarios.frequency_grid import MOST_VALUES, START_POINTS
from multibody_xval.scenarios.sweep_plan import AXES, CHAIN
from reference_lcp.defaults import FEWEST_STEPS_PER_PERIOD
from reference_lcp.errors import ParameterError, choices, meant, shown
from reference_lcp.validation import LARGEST_DECIBEL, LARGEST_PARAMETER, LARGEST_UNIT, MOST_STEPS

RANGE = ("first", "last", "points")
ADAPTIVE = ("first", "last", "accuracy_db", "least_spacing", "most_points")

KEYS: dict[tuple[int | str, ...], tuple[str, ...]] = {
    (): ("engines", "steps_per_period", "grid", "chain", "drive", "tolerances"),
    ("grid",): AXES,
    ("chain",): CHAIN,
    ("drive",): ("kind", "amplitude"),
    ("tolerances",): ("transmittance_db",),
}
"""Keys of the file and of its tables."""

_UNEVEN = f"a number > 0, up to {LARGEST_PARAMETER:g}"
_DECIBEL = f"a number > 0, up to {LARGEST_DECIBEL:g}"

ALLOWED = {
    "engines": 'at least one name in quotes, such as ["reference", "mujoco"]',
    "engines.*": 'a name in quotes, such as "mujoco"',
    "steps_per_period": f"a whole number from {FEWEST_STEPS_PER_PERIOD} to {MOST_STEPS}",
    "grid": "a table with friction_ratio and frequency_ratio",
    "grid.*": "a list of numbers, such as [0.1, 0.3], or { first = 0.3, last = 1.6, points = 14 }",
    "grid.*.*": "a number",
    "grid.*.first": f"a number from {-LARGEST_PARAMETER:g} to {LARGEST_PARAMETER:g}",
    "grid.*.last": f"a number from {-LARGEST_PARAMETER:g} to {LARGEST_PARAMETER:g}",
    "grid.*.points": f"a whole number from 2 to {MOST_VALUES}",
    "grid.*.accuracy_db": _DECIBEL,
    "grid.*.least_spacing": _UNEVEN,
    "grid.*.most_points": f"a whole number from {START_POINTS} to {MOST_VALUES}",
    "chain": "a table of parameters of the chain, such as cells = 7",
    "chain.*": "a number, or a list with a number for every cell",
    "chain.*.*": "a number",
    "drive": "a table with kind and amplitude",
    "drive.kind": '"base" or "force"',
    "drive.amplitude": f"a number > 0, up to {LARGEST_UNIT:g}",
    "tolerances": "a table with transmittance_db",
    "tolerances.transmittance_db": _DECIBEL,
}
"""What may be the value of a key; a star stands for any name, or for the number of a value in a list."""


def mistake(problem: ValidationError) -> ParameterError:
    """Give the mistake to mend first, in one line: a key that is unknown, else the first one."""
    found: list[Any] = problem.errors()
    first = next((own for own in found if own["type"] == "extra_forbidden"), found[0])
    same = [own for own in found if own["loc"][:2] == first["loc"][:2] and own["type"] != "missing"]
    deepest = first if first["type"] in ("extra_forbidden", "missing") else max(same, key=lambda own: len(own["loc"]))
    return ParameterError(_text(deepest))


def _text(error: Mapping[str, Any]) -> str:
    parts, kind = _parts(error["loc"]), error["type"]
    if not parts:
        return f"a sweep = {shown(error['input'])}; allowed: a table with engines and grid"
    key = ".".join(parts)
    table = KEYS.get(tuple(parts[:1]), ())
    if len(parts) > 1 and parts[0] in ("grid", "chain") and parts[1] not in table:
        return f"{parts[0]}.{parts[1]} is unknown; {choices(parts[1], table)}"
    if kind == "extra_forbidden":
        return _unknown(key, parts)
    if kind == "missing":
        return f"{key} is missing; allowed: {_allowed(parts, error)}"
    if kind == "value_error":
        return f"{key}.{error['ctx']['error']}"
    return f"{key} = {shown(error['input'])}; allowed: {_allowed(parts, error)}"


def _parts(place: tuple[int | str, ...]) -> list[str]:
    """Give the key of a place, without the form in which a value of [grid] or [chain] is written."""
    return [str(part) for depth, part in enumerate(place) if depth != 2 or place[0] not in ("grid", "chain")]


def _unknown(key: str, parts: list[str]) -> str:
    """Tell of a key that is not allowed, of the file, of a table, or of the values of an axis."""
    table = tuple(parts[:-1])
    if len(table) < 2:
        return f"{key} is unknown; {choices(parts[-1], KEYS[table])}"
    forms = f"allowed: {', '.join(RANGE)}, or {', '.join(ADAPTIVE)}"
    known = sorted({*RANGE, *ADAPTIVE})
    if parts[-1] in known:
        return f"{key} does not go with the other keys; {forms}"
    return f"{key} is unknown; {forms}{meant(parts[-1], known)}"


def _allowed(parts: list[str], error: Mapping[str, Any]) -> str:
    """Say what the value of a key may be."""
    if "adaptive" in error["loc"][2:3] and parts[-1] in ("first", "last"):
        return _UNEVEN
    head, *rest = parts
    names = (".".join([head, *rest]), f"{head}.*.{parts[-1]}", ".".join([head, *["*"] * len(rest)]))
    return next((ALLOWED[name] for name in names if name in ALLOWED), "what `multibody-xval example` shows")
