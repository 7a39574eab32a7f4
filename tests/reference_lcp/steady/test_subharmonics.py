"""Motions that repeat after several periods of the drive, or never."""

import dataclasses
import math

import numpy as np
import pytest

from reference_lcp import Chain, CompiledSimulation, HarmonicBase, Lane, State, periodic_orbits
from reference_lcp.chain.simulation import OrbitStatus

STEPS = 400


class UnevenMotor:
    """A chain whose base moves farther in some periods than in others.

    The motor's own phase advances by `turn` a period, and is carried as a bristle's anchor is: the map of positions,
    velocities and phase has no fixed point unless `turn` is whole, and a cycle of m points for `turn` = k/m.
    """

    def __init__(self, lanes: tuple[Lane, ...], turn: float):
        self.lanes, self._turn = lanes, turn

    def advance(self, state: State, start: int, steps: int) -> State:
        for _ in range(steps // STEPS):
            one = [trajectory.end for trajectory in self.run(state, start, STEPS)]
            state = State.stack(one)
        return state

    def run(self, state: State, start: int, steps: int):
        assert (start, steps) == (0, STEPS)
        phases = np.zeros(len(self.lanes)) if state.internal_state is None else state.internal_state[:, 0]
        moved = [
            dataclasses.replace(
                lane,
                drive=HarmonicBase(
                    lane.drive.amplitude * (1 + 0.3 * math.cos(2 * math.pi * phase)), lane.drive.angular_frequency
                ),
            )
            for lane, phase in zip(self.lanes, phases, strict=True)
        ]
        trajectories = CompiledSimulation(moved).run(State(state.positions, state.velocities), start, steps)
        return [
            dataclasses.replace(one, internal_state=np.array([(phase + self._turn) % 1.0]))
            for one, phase in zip(trajectories, phases, strict=True)
        ]

    def subset(self, lanes):
        return UnevenMotor(tuple(self.lanes[lane] for lane in lanes), self._turn)

    def close(self) -> None: ...


def orbit_of(turn: float, damping: float = 0.3, **options):
    chain = Chain.from_ratios(cells=2, friction_ratio=0.3, damping_ratio=damping, inner_damping_ratio=damping)
    lane = Lane.periodic(chain, HarmonicBase.from_ratio(chain, 0.9), STEPS)
    return periodic_orbits(UnevenMotor((lane,), turn), STEPS, max_periods=40, **options)[0]


@pytest.mark.parametrize("order", [2, 3, 5, 8])
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
    chain = Chain.from_ratios(cells=2, friction_ratio=0.3, damping_ratio=0.3, inner_damping_ratio=0.3)
    lane = Lane.periodic(chain, HarmonicBase.from_ratio(chain, 0.9), STEPS)
    stopped = periodic_orbits(CompiledSimulation([lane]), STEPS, max_periods=4, longest_multiple=1)[0]
    settled = periodic_orbits(CompiledSimulation([lane]), STEPS, max_periods=4)[0]
    assert (stopped.status, settled.status) == (OrbitStatus.PERIOD_LIMIT, OrbitStatus.CONVERGED)
    again = CompiledSimulation([lane]).run(settled.trajectory.end, 0, STEPS)[0]
    change = np.abs(again.positions[-1] - settled.trajectory.positions[-1]) / lane.drive.amplitude
    assert np.max(change) <= 1e-8
