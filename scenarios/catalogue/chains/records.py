"""A base that follows a record: the example that ships with the suite, or the user's own."""

import math
from dataclasses import replace
from pathlib import Path

import numpy as np

from multibody_xval.scenarios.catalogue.chains.broadband import (
    BANDS,
    PERIOD,
    RESONATOR_FREQUENCY,
    RICKER_PULSE,
    ROWS_PER_PERIOD,
    STEPS_A_ROW,
    followed,
)
from multibody_xval.scenarios.catalogue.chains.record_file import read_record
from multibody_xval.scenarios.catalogue.scenario import Scenario, steps_a_row
from reference_lcp.defaults import BASE_AMPLITUDE
from reference_lcp.errors import ParameterError

EXAMPLE = Path(__file__).with_name("example_record.csv")
"""Synthetic and earthquake-like, 600 samples in 12 s: noise with the spectrum of Kanai and Tajimi (H. Tajimi, Proc. 2nd
World Conf. Earthquake Eng., 1960) between 2 and 12 Hz, under an envelope; `tests.scenarios.catalogue.test_records`
makes it."""

REST = 200
"""Periods 2π / ω_r after the record in which the chain dies out."""

FRICTION_RATIOS = (0.03, 0.3)

COARSEST = 4
"""Times fewer steps than are compared, of which none may leave out samples."""


def following(file: Path) -> Scenario:
    """Give the scenario of a record, a table of time [s] and displacement [m] whose largest one is scaled to U0.

    Raises
    ------
    ParameterError
        If the file cannot be read, or its samples are too far apart for the bands.
    """
    base = read_record(file, BASE_AMPLITUDE)
    spacings = np.diff(base.times)
    longest = math.pi / (RESONATOR_FREQUENCY * max(highest for _, highest in BANDS.values()))
    if np.max(spacings) > longest * (1 + 1e-9):
        raise ParameterError(
            f"the record is too coarse: samples are up to {np.max(spacings):g} s apart; allowed: <= {longest:.4g} s, "
            "half a period of the highest frequency that is compared"
        )
    to_sample = math.ceil(PERIOD / np.min(spacings) / ROWS_PER_PERIOD - 1e-9)  # steps to a row
    return replace(
        RICKER_PULSE,
        name="record",
        question="How much of a recorded motion of the base (CSV) arrives at the end of the chain?",
        cases=followed(base, math.ceil(base.duration / PERIOD) + REST, FRICTION_RATIOS),
        steps=steps_a_row(max(STEPS_A_ROW, COARSEST * to_sample)),
        details=(f"Record: {file.name}, {len(base.times)} samples in {base.duration:g} s, scaled to U0.",),
    )


RECORD = replace(following(EXAMPLE), of_record=following)
"""The largest displacement of the record counts as U0: its friction ratios are those of the others.

Without friction the band 0.65–0.82 of the example lets −1.1 dB pass; at 0.03 it is −3.5 dB, at 0.3 +1.8 dB.
"""

SCENARIOS = (RECORD,)
