"""Units of an engine in a script: what a template writes behind a number in SI units."""

from collections.abc import Mapping
from typing import Any

from engines.shared.units import Units

DIVISORS = {
    "mass": " / MASS", "length": " / LENGTH", "time": " / TIME", "velocity": " / SPEED", "force": " / FORCE",
    "stiffness": " * TIME**2 / MASS", "damping": " * TIME / MASS",
}  # fmt: skip
"""Behind a number in SI units, in a script that has the units of `units.py.jinja`."""

SI = Units(1.0, 1.0, 1.0)


def script_units(units: Units) -> Mapping[str, Any]:
    """Give ``units``, and as ``per`` and ``times`` what is written behind numbers: nothing where they are SI units."""
    own = units != SI
    return {
        "units": units if own else None,
        "per": DIVISORS if own else dict.fromkeys(DIVISORS, ""),
        "times": {"length": " * LENGTH", "velocity": " * SPEED"} if own else {"length": "", "velocity": ""},
    }
