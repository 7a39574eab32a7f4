"""A base that follows a record: the example that ships with the suite, or the user's own."""

import math
from functools import cached_property
from pathlib import Path

from multibody_xval.scenarios.catalogue.transient.base import (
    BANDS,
    BROADBAND_STEPS,
    PERIOD,
    RESONATOR_FREQUENCY,
    ROWS_PER_PERIOD,
    Broadband,
    TransientCase,
)
from reference_lcp.chain.transient import RecordedBase
from reference_lcp.defaults import BASE_AMPLITUDE

FILE = Path(__file__).parents[1] / "example_record.csv"
"""Synthetic and earthquake-like, 600 samples in 12 s: noise with the spectrum of Kanai and Tajimi (H. Tajimi, Proc. 2nd
World Conf. Earthquake Eng., 1960) between 2 and 12 Hz, under an envelope; `tests.scenarios.catalogue.example_record`
makes it."""

REST = 200
"""Periods 2π / ω_r after the record in which the chain dies out."""


class Record(Broadband):
    """The largest displacement of the record counts as U0: its friction ratios are those of the others.

    The file is a table of time [s] and displacement [m]; displacements are scaled so that the largest is U0 = 0.01 m,
    times are taken as they are, and ω_r is 31.6 rad/s. Without friction the band 0.65–0.82 of the example lets −1.1 dB
    pass; at 0.03 it is −3.5 dB, at 0.3 +1.8 dB.
    """

    name = "record"
    friction_ratios = (0.03, 0.3)

    def __init__(self, file: Path = FILE):
        self.file = file

    @cached_property
    def base(self) -> RecordedBase:
        """The record, scaled."""
        raw = RecordedBase.from_csv(self.file)
        base = RecordedBase.from_csv(self.file, BASE_AMPLITUDE / raw.amplitude)
        base.check_resolves(RESONATOR_FREQUENCY * max(highest for _, highest in BANDS.values()))
        return base

    def check(self) -> None:
        """Read the record, before anything is run."""
        _ = self.base

    def case(self, friction_ratio: float) -> TransientCase:
        """Follow the record, then wait; no step is so long that it leaves out samples."""
        rows = math.ceil(PERIOD / self.base.shortest_spacing / ROWS_PER_PERIOD - 1e-9)
        steps = max(BROADBAND_STEPS, ROWS_PER_PERIOD * rows)
        return TransientCase(friction_ratio, self.base, math.ceil(self.base.duration / PERIOD) + REST, steps)
