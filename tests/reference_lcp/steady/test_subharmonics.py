"""Motions that repeat after several periods of the drive, or never."""

import dataclasses
import math

import numpy as np
import pytest

from reference_lcp import CompiledSimulation, Lane, periodic_orbits
from reference_lcp.chain.simulation import OrbitStatus
from tests.reference_lcp.steady.memory import STEPS, RememberingChain, lanes_of


def orbit_of(turn: float, damping: float = 0.3, **options):
    """A chain whose base moves farther in some periods than in others, by a phase that advances by `turn` a period.

    The map of positions, velocities and phase has no fixed point unless `turn` is whole, and a cycle of m points for
    `turn` = k/m.
    """

    def moved(lane: Lane, phase: float) -> Lane:
        amplitude = lane.drive.amplitude * (1 + 0.3 * math.cos(2 * math.pi * phase))
        return dataclasses.replace(lane, drive=dataclasses.replace(lane.drive, amplitude=amplitude))

    motor = RememberingChain(lanes_of(0.9, damping_ratio=damping), moved, lambda phase: (phase + turn) % 1.0)
    return periodic_orbits(motor, STEPS, max_periods=40, **options)[0]


@pytest.mark.parametrize("order", [2, 5, 8])
def test_subharmonic_response_is_named_by_its_order(order: int) -> None:
    orbit = orbit_of(1 / order)
    assert (orbit.status, orbit.multiple) == (OrbitStatus.PERIOD_LIMIT, order)


def test_lightly_damped_subharmonic_is_found_long_before_the_plain_motion_has_settled() -> None:
    """Of ζ = 0.01, 72 plain periods leave more than the tolerance: the m-fold map's own search finds the cycle."""
    assert orbit_of(1 / 3, damping=0.01).multiple == 3


@pytest.mark.parametrize("turn", [(math.sqrt(5) - 1) / 2, 1 / 9])
def test_motion_without_a_short_period_is_named_so(turn: float) -> None:
    """The golden section makes it quasi-periodic; a ninth of a turn repeats after nine periods only."""
    assert orbit_of(turn).multiple == 0
    assert orbit_of(turn, longest_multiple=1).multiple == 1


def test_a_longer_period_is_found_where_one_asks_for_it() -> None:
    assert orbit_of(1 / 9, longest_multiple=9).multiple == 9


def test_plain_motion_that_settles_where_the_mixing_was_stopped_is_a_steady_state() -> None:
    lanes = lanes_of(0.9, damping_ratio=0.3)
    simulation = CompiledSimulation(lanes)
    stopped = periodic_orbits(simulation, STEPS, max_periods=4, longest_multiple=1)[0]
    settled = periodic_orbits(simulation, STEPS, max_periods=4)[0]
    assert (stopped.status, settled.status) == (OrbitStatus.PERIOD_LIMIT, OrbitStatus.CONVERGED)
    again = simulation.run(settled.trajectory.end, 0, STEPS)[0]
    change = np.abs(again.positions[-1] - settled.trajectory.positions[-1]) / lanes[0].drive.amplitude
    assert np.max(change) <= 1e-8
