"""Proven steady states, as data that comes with the suite: the exact value of every case that is in the table.

``multibody-xval run proofs`` proves it again, see `multibody_xval.scenarios.catalogue.proofs`. Ratios are the decimals
that they are printed as.
"""

import cmath
import csv
import json
from collections.abc import Mapping
from dataclasses import replace
from decimal import Decimal
from functools import cache
from importlib import resources
from typing import NamedTuple

from multibody_xval.scenarios.model import Case, case_of
from reference_lcp.defaults import BASE_AMPLITUDE, FRICTION_COEFFICIENT

TABLE = "proven.csv"
"""Ratios, what a chain has beside the paper's (as JSON), level, phase and transitions."""

RATIOS = ("friction_ratio", "frequency_ratio")
"""Columns of the table that every case has."""

DIGITS = 20
"""Decimals of a level and of a phase."""


class ProvenLevel(NamedTuple):
    """What is proven of one steady state, to `DIGITS` decimals: half of the last is rounded, half is the proof's."""

    transmittance_db: Decimal
    """[dB]."""
    phase: Decimal
    """Of the fundamental [rad]."""
    events: int
    """Transitions of all contacts in a period."""

    @property
    def transmittance(self) -> complex:
        """Give T, to the digits of a double."""
        return cmath.rect(10 ** (float(self.transmittance_db) / 20), float(self.phase))


@cache
def proven_levels() -> Mapping[Case, ProvenLevel]:
    """Read the table, by what `in_table` gives."""
    text = resources.files("multibody_xval.scenarios.ruler").joinpath(TABLE).read_text(encoding="utf-8")
    return dict(map(_read, csv.DictReader(text.splitlines())))


def _read(row: dict[str, str]) -> tuple[Case, ProvenLevel]:
    case = case_of({name: json.loads(row[name]) for name in RATIOS} | json.loads(row["chain"] or "{}"))
    return case, ProvenLevel(Decimal(row["transmittance_db"]), Decimal(row["phase"]), int(row["events"]))


def in_table(case: Case) -> Case:
    """Give the case as the table has it: over U0, the motion depends on μ λ_N alone, and not on U0."""
    if (case.friction_coefficient, case.displacement) == (FRICTION_COEFFICIENT, BASE_AMPLITUDE):
        return case
    return replace(case, friction_coefficient=FRICTION_COEFFICIENT, displacement=BASE_AMPLITUDE)


@cache
def proven() -> Mapping[Case, complex]:
    """Give what is proven of transmittances, by what `in_table` gives."""
    return {case: level.transmittance for case, level in proven_levels().items()}
