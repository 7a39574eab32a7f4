"""A motion of very many steps and runs: what an engine does must not depend on how long it has been used."""

import numpy as np

from multibody_xval.engines.shared.wide_range import LONG_USE, MANY_RUNS
from multibody_xval.scenarios.cases.motions import ChainMotion
from multibody_xval.scenarios.catalogue.scenario import Quantity, Scenario, steps_a_row
from multibody_xval.scenarios.model import Case

CELL = Case(cells=1, friction_ratio=0.3, frequency_ratio=0.9)
"""Where the contact of one cell sticks and slips."""

PERIODS = 160

ROWS_PER_PERIOD, STEPS_A_ROW = 10, 40
"""Which makes 400 steps to a period, and so many in all that they go beyond `LONG_USE`."""

STRETCH = 250
"""Most steps of one run: more than `MANY_RUNS` of them follow each other."""


BASE = CELL.setting[1]

REPEATED = ChainMotion(
    cells=CELL.cells, friction_ratio=CELL.friction_ratio, drive=BASE, time=PERIODS * BASE.period,
    rows=PERIODS * ROWS_PER_PERIOD, stretch=STRETCH,
)  # fmt: skip
"""The cell from rest, under a harmonic base."""

LONG_RUN = Scenario(
    name="long-run",
    question=f"Does a chain move after {LONG_USE:,} steps, and {MANY_RUNS} runs, as it did before?",
    expects="the event-driven motion, exact to round-off; of presets that share the scheme the reference at equal "
    "steps",
    source="What a simulation is: state in, trajectory out, however often it has been used.",
    cases={f"{PERIODS} periods": REPEATED},
    quantities=(
        Quantity(
            name="series", unit="", accuracy="transmittance",
            read=lambda result, _run: np.array(result.series["response"]),
            meaning="Largest difference of the outer mass at any time, over U0.",
        ),
    ),
    steps=steps_a_row(STEPS_A_ROW),
    details=(
        f"One cell, friction {CELL.friction_ratio:g}, η_r {CELL.frequency_ratio:g}, from rest.",
        f"{PERIODS * ROWS_PER_PERIOD * STEPS_A_ROW:,} steps, at most {STRETCH} in a run.",
    ),
)  # fmt: skip
"""Counters overflow, clocks lose digits, and what a run leaves behind adds up."""

SCENARIOS = (LONG_RUN,)
