"""The responses of the paper's chain and of its unit cell, of two degrees of freedom, by the reference."""

from collections.abc import Mapping

import numpy as np

from multibody_xval.scenarios.runs.parameters import ChainRatios, Excitation
from multibody_xval.scenarios.runs.task import DEFAULT_EXCITATION
from multibody_xval.scenarios.studies.figure3 import FRICTION_RATIOS, figure3
from multibody_xval.scenarios.sweeps.point import GivesResults
from multibody_xval.scenarios.sweeps.refinement import decided_db, resonances
from multibody_xval.scenarios.verdicts.steady_case import REFERENCE
from reference_lcp.validation import FloatArray

ONE_CELL = ChainRatios(cells=1)

FREQUENCY_RATIOS = np.round(np.arange(0.3, 2.001, 0.01), 2)
"""Even points of the curves, between which the resonances lie."""


Curves = Mapping[float, tuple[FloatArray, FloatArray]]
"""η_r and transmittance [dB] by friction ratio; NaN where there is no steady state."""


def response_curves(
    ratios: ChainRatios, evaluator: GivesResults, excitation: Excitation = DEFAULT_EXCITATION
) -> Curves:
    """Give the curves of a chain at the paper's friction ratios."""
    etas = np.unique(np.concatenate([FREQUENCY_RATIOS, np.round(resonances(ratios), 4)]))
    etas = etas[(etas >= FREQUENCY_RATIOS[0]) & (etas <= FREQUENCY_RATIOS[-1])]
    sweep = figure3((), FRICTION_RATIOS, etas.tolist(), ratios=ratios, excitation=excitation)
    tasks = [sweep.task(REFERENCE, case, eta) for case in sweep.cases for eta in sweep.frequency_ratios]
    levels = np.reshape([decided_db(result) for result in evaluator.evaluate(tasks)], (len(sweep.cases), -1))
    return {case.friction_ratio: (etas, curve) for case, curve in zip(sweep.cases, levels, strict=True)}
