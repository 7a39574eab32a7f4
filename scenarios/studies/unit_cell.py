"""The response of the paper's unit cell, one mass-in-mass cell of two degrees of freedom, by the reference."""

from collections.abc import Mapping

import numpy as np

from reference_lcp.validation import FloatArray
from scenarios.runs.parameters import ChainRatios, Excitation
from scenarios.studies.figure3 import FRICTION_RATIOS, figure3
from scenarios.sweeps.point import GivesResults
from scenarios.sweeps.refinement import decided_db, resonances
from scenarios.verdicts.steady_case import REFERENCE

ONE_CELL = ChainRatios(cells=1)

FREQUENCY_RATIOS = np.round(np.arange(0.3, 2.001, 0.02), 2)
"""Even points of the curves, between which the resonances lie."""


def unit_cell_curves(evaluator: GivesResults, excitation: Excitation) -> Mapping[float, tuple[FloatArray, FloatArray]]:
    """Give η_r and transmittance [dB] by friction ratio; NaN where there is no steady state."""
    etas = np.unique(np.concatenate([FREQUENCY_RATIOS, np.round(resonances(ONE_CELL), 4)]))
    sweep = figure3((), FRICTION_RATIOS, etas.tolist(), ratios=ONE_CELL, excitation=excitation)
    tasks = [sweep.task(REFERENCE, case, eta) for case in sweep.cases for eta in sweep.frequency_ratios]
    levels = np.reshape([decided_db(result) for result in evaluator.evaluate(tasks)], (len(sweep.cases), -1))
    return {case.friction_ratio: (etas, curve) for case, curve in zip(sweep.cases, levels, strict=True)}
