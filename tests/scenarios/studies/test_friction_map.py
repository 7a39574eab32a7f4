"""The map over friction and frequency: the paper's three claims, and edges as Figure 3 has them."""

import numpy as np

from multibody_xval.scenarios.runs.evaluator import Evaluator
from multibody_xval.scenarios.runs.executor import run_batch
from multibody_xval.scenarios.runs.result import Result
from multibody_xval.scenarios.runs.task import SteadyStateTask
from multibody_xval.scenarios.studies.figure3 import figure3
from multibody_xval.scenarios.studies.friction_map import friction_map, map_sweep


class Here(Evaluator):
    """Answers in this process, without a store."""

    def __init__(self) -> None:
        self._results = {}

    def evaluate(self, tasks: list[SteadyStateTask]) -> list[Result]:
        new = self.new_tasks(tasks)
        self._results.update(zip(new, run_batch(new) if new else [], strict=True))
        return [self._results[task] for task in tasks]

    def close(self) -> None:
        return


def test_the_lower_edge_moves_with_friction_as_in_the_paper() -> None:
    """Edges of the converged scheme (docs: 0.84, 0.637, 0.999); a grid of 0.1 alone would miss the second by 0.06."""
    eta = np.round(np.arange(0.3, 1.601, 0.1), 2).tolist()
    mapped = friction_map(map_sweep(figure3(), (0.0, 0.3, 1.0), eta), Here())
    assert mapped.known == mapped.transmittance_db.size
    np.testing.assert_allclose(mapped.lower, [0.852, 0.637, 0.999], atol=0.02)
    assert mapped.lower[1] < mapped.lower[0] < mapped.lower[2]
    assert np.isfinite(mapped.upper[0])


def test_a_map_without_answers_has_no_edges() -> None:
    class Nobody(Here):
        def evaluate(self, tasks: list[SteadyStateTask]) -> list[Result]:
            return [Result.missing() for _ in tasks]

    mapped = friction_map(map_sweep(figure3(), (0.3,), (0.6, 0.9)), Nobody())
    assert mapped.known == 0
    assert np.isnan(mapped.lower).all()
