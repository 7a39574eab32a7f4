"""Reference results of the Modelica Standard Library: CoupledClutches and Brake."""

import numpy as np
import pytest

from reference_lcp import EventDrivenSystem, simulate_system
from tests.reference_lcp.published.anchors import ANCHORS, brake, coupled_clutches, rows, stopped

CLUTCH_UNCERTAINTY = 1e-4
"""Of angles [rad] and velocities [rad/s] of about ten, from an integration with a relative tolerance of 1e-6."""


def clutch_error(system) -> float:
    """Largest distance from the published rows: angle and velocity of J1, relative velocities of the clutches."""
    time, *published = rows("coupled_clutches")
    motion = EventDrivenSystem(system).motion(position=np.zeros(4), velocity=[10, 0, 0, 0], times=time)
    own = [motion.positions[:, 0], motion.velocities[:, 0], *motion.relative_velocity.T]
    return float(np.max(np.abs(np.array(own) - published)))


def test_coupled_clutches_close_one_after_the_other() -> None:
    assert clutch_error(coupled_clutches()) < CLUTCH_UNCERTAINTY


@pytest.mark.parametrize("order", [(0, 2, 1), (1, 0, 2), (2, 1, 0)])
def test_clutches_in_another_order_are_found(order) -> None:
    assert clutch_error(coupled_clutches(order=order)) > 1e4 * CLUTCH_UNCERTAINTY


def test_clutches_that_are_a_thousandth_too_strong_are_found() -> None:
    system = coupled_clutches()
    for contact in system.friction:
        object.__setattr__(contact, "coefficient", 0.5005)
    assert clutch_error(system) > 10 * CLUTCH_UNCERTAINTY


def test_clutches_whose_static_friction_is_their_kinetic_one_are_found() -> None:
    assert clutch_error(coupled_clutches(peak=1.0)) > 10 * CLUTCH_UNCERTAINTY


def test_scheme_tends_to_the_exact_clutches_to_first_order() -> None:
    exact = EventDrivenSystem(coupled_clutches()).motion(position=np.zeros(4), velocity=[10, 0, 0, 0], times=1.5)
    errors = []
    for steps in (600, 1200, 2400):
        motion = simulate_system(
            coupled_clutches(), position=np.zeros(4), velocity=[10, 0, 0, 0], time_step=1.5 / steps, steps=steps
        )
        errors.append(np.max(np.abs(motion.positions[-1] - exact.positions[0])))
    assert errors[-1] < 5e-3
    assert -np.polyfit([0, 1, 2], np.log2(errors), 1)[0] == pytest.approx(1, abs=0.15)


def test_brake_that_presses_a_thousandth_harder_stops_elsewhere() -> None:
    value, uncertainty = ANCHORS["brake"]
    assert abs(stopped(brake(1.001)) - value) > 10 * uncertainty
