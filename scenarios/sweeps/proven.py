"""Proven levels of the canonical chain at the points of the standard grids, as data that comes with the suite.

`scenarios.studies.proofs` makes the table, and proves it again. Ratios are the decimals that they are printed as.
"""

import csv
from collections.abc import Mapping
from decimal import Decimal
from functools import cache
from importlib import resources
from typing import NamedTuple

from scenarios.runs.parameters import ChainRatios, OperatingPoint
from scenarios.runs.task import DEFAULT_EXCITATION, SteadyStateTask

TABLE = "proven.csv"

DIGITS = 20
"""Decimals of a level in dB and of a phase."""

RADIUS = Decimal(1).scaleb(-DIGITS)
"""Largest distance of a number of the table from the true one: half a digit is rounded, half is that of the proof."""

ROUNDED_DB = 2.0**-45
"""Rounding of a level to a double [dB]: half a unit in the last place of levels below 512 dB."""


class ProvenLevel(NamedTuple):
    """What is proven of one steady state."""

    transmittance_db: Decimal
    phase: Decimal
    """To `RADIUS`: transmittance [dB], and the phase of its fundamental [rad]."""
    events: int
    """Transitions of all contacts in a period."""


@cache
def proven_levels() -> Mapping[OperatingPoint, ProvenLevel]:
    """Read the table."""
    text = resources.files(__package__).joinpath(TABLE).read_text(encoding="utf-8")
    return {
        OperatingPoint(float(row["friction_ratio"]), float(row["frequency_ratio"])): ProvenLevel(
            Decimal(row["transmittance_db"]), Decimal(row["phase"]), int(row["events"])
        )
        for row in csv.DictReader(text.splitlines())
    }


def proven_level(task: SteadyStateTask) -> ProvenLevel | None:
    """Give what is proven of the steady state of a task; ``None`` where it is none of the table."""
    canonical = task.ratios == ChainRatios() and task.modulation is None and task.inclination == 0
    if not canonical or isinstance(task.friction_ratio, tuple) or task.excitation.kind != DEFAULT_EXCITATION.kind:
        return None
    return proven_levels().get(OperatingPoint(task.friction_ratio, task.frequency_ratio))
