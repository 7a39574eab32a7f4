"""The response of the unit cell: resonances without friction, and one mass where it locks."""

import numpy as np

from multibody_xval.scenarios.runs.result import Result
from multibody_xval.scenarios.studies.figure3 import FRICTION_RATIOS
from multibody_xval.scenarios.studies.response import ONE_CELL, response_curves
from multibody_xval.scenarios.sweeps.refinement import free_resonances, resonances
from tests.scenarios.studies.test_friction_map import Here


def test_a_single_cell_resonates_as_two_masses_and_as_one_where_it_locks() -> None:
    curves = response_curves(ONE_CELL, Here())
    assert tuple(curves) == FRICTION_RATIOS
    first, second = free_resonances(ONE_CELL)
    (locked,) = set(np.round(resonances(ONE_CELL), 9)) - set(np.round([first, second], 9))
    eta, free = curves[0.0]
    peaks = eta[1:-1][(free[1:-1] > free[:-2]) & (free[1:-1] > free[2:])]
    np.testing.assert_allclose(peaks, [first, second], atol=0.01)
    eta, stuck = curves[5.0]
    np.testing.assert_allclose(eta[np.argmax(stuck)], locked, atol=0.03)
    assert np.isfinite([level for _, level in curves.values()]).all()


def test_what_has_no_steady_state_is_a_gap() -> None:
    class Nobody(Here):
        def evaluate(self, tasks):
            return [Result.missing() for _ in tasks]

    assert all(np.isnan(level).all() for _, level in response_curves(ONE_CELL, Nobody()).values())
