"""The friction ratio at which the band begins lowest: of edges that are known, and of the reference's."""

import numpy as np
import pytest

from reference_lcp.defaults import MINIMUM_STEPS_PER_PERIOD
from scenarios.runs.store import opened_store
from scenarios.studies import widest_band as study
from scenarios.studies.widest_band import FINE_STEP, widest_band
from tests.scenarios.in_process import evaluator

ERROR = 2e-4
"""Of a made edge with the fewest steps a period; it is of first order."""


def made(monkeypatch: pytest.MonkeyPatch, edge) -> None:
    """Let the lower edge be a function of friction, with a first-order error of the time step."""

    def edges(friction, damping_ratio, steps, evaluator):
        return edge(friction) + ERROR * MINIMUM_STEPS_PER_PERIOD / steps

    monkeypatch.setattr(study, "_lower_edges", edges)


def test_of_a_parabola_the_vertex_and_its_width_are_found(monkeypatch) -> None:
    made(monkeypatch, lambda friction: 0.6 + (friction - 0.234) ** 2)
    found = widest_band(0.01, None)
    width = np.sqrt(ERROR / 2)  # what halving the step changes is half its error
    assert found.friction_ratio == pytest.approx(0.234, abs=FINE_STEP / 2)
    assert (found.lowest, found.highest) == pytest.approx((0.234 - width, 0.234 + width), abs=2 * FINE_STEP)
    assert found.flat_to - found.flat_from == pytest.approx(2 * np.sqrt(study.MARGIN), abs=2 * FINE_STEP)
    assert (found.edge, found.edge_error) == pytest.approx((0.6, ERROR / 2))


def test_a_jump_is_found_to_a_step_of_the_grid(monkeypatch) -> None:
    made(monkeypatch, lambda friction: np.where(friction < 0.2455, 0.7, 0.5) + 0.5 * friction)
    found = widest_band(0.01, None)
    assert found.friction_ratio == pytest.approx(0.246)
    assert found.lowest < 0.2455 < found.friction_ratio


def test_a_wrong_minimum_is_not_found(monkeypatch) -> None:
    made(monkeypatch, lambda friction: 0.6 + np.minimum((friction - 0.2) ** 2, 1e-3 + (friction - 0.4) ** 2))
    assert widest_band(0.01, None).friction_ratio == pytest.approx(0.2, abs=FINE_STEP / 2)


@pytest.mark.slow
@pytest.mark.parametrize(("damping", "friction", "edge"), [(0.01, 0.296, 0.6372), (0.03, 0.245, 0.6051)])
def test_more_damping_moves_the_widest_band_to_less_friction(damping: float, friction: float, edge: float) -> None:
    with opened_store(None) as store, evaluator(store) as running:
        found = widest_band(damping, running)
    assert found.lowest <= friction <= found.highest
    assert found.edge == pytest.approx(edge, abs=1e-4)


def test_friction_is_searched_in_hundredths_over_the_range_of_the_paper():
    assert study.COARSE_FRICTION_RATIOS.tolist() == [place / 100 for place in range(10, 61)]
