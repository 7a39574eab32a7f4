"""Periodic orbits of laws with internal state: no orbit counts as found before that repeats too."""

import dataclasses

import numpy as np
import pytest

from reference_lcp import (
    Chain,
    CompiledSimulation,
    HarmonicBase,
    Lane,
    PeriodicOrbit,
    State,
    Trajectory,
    periodic_orbits,
)
from reference_lcp.chain.simulation import OrbitStatus
from reference_lcp.observables.transmittance import decibel, transmittance
from reference_lcp.steady.anderson import StateScales

STEPS = 400

UNIT = 1e-7
"""Size of the internal state: far below the displacement scale of 0.01 m, so that nothing but its own size shows it."""


class WearingChain:
    """A chain whose friction bound falls as its contacts wear, over some hundred periods.

    The wear w of a lane, shape (lanes, 1), goes by a part `RATE` a period to where it stays, `UNIT`; μN is then
    (1 − 0.8 w / UNIT) of what it was.
    """

    RATE = 0.02

    def __init__(self, lanes: tuple[Lane, ...]):
        self.lanes = lanes

    def advance(self, state: State, start: int, steps: int) -> State:
        return State.stack([trajectory.end for trajectory in self.run(state, start, steps)])

    def run(self, state: State, start: int, steps: int) -> list[Trajectory]:
        assert (start, steps) == (0, STEPS)
        wear = np.zeros((len(self.lanes), 1)) if state.internal_state is None else state.internal_state
        worn = [
            dataclasses.replace(lane, chain=chain_of(lane.chain.cells, 0.3 * (1 - 0.8 * float(part[0]) / UNIT)))
            for lane, part in zip(self.lanes, wear, strict=True)
        ]
        trajectories = CompiledSimulation(worn).run(State(state.positions, state.velocities), start, steps)
        return [
            dataclasses.replace(one, internal_state=part + self.RATE * (UNIT - part))
            for one, part in zip(trajectories, wear, strict=True)
        ]

    def subset(self, lanes):
        return type(self)(tuple(self.lanes[lane] for lane in lanes))

    def close(self) -> None: ...


def chain_of(cells: int, friction_ratio: float) -> Chain:
    return Chain.from_ratios(cells=cells, friction_ratio=friction_ratio, damping_ratio=0.1, inner_damping_ratio=0.1)


def lanes_of(*frequency_ratios: float) -> tuple[Lane, ...]:
    chain = chain_of(2, 0.3)
    return tuple(Lane.periodic(chain, HarmonicBase.from_ratio(chain, eta), STEPS) for eta in frequency_ratios)


def decibels_after(simulation: WearingChain, orbit: PeriodicOrbit, periods: int) -> float:
    """Transmittance so many plain periods after an orbit."""
    state = orbit.trajectory.end
    for _ in range(periods):
        state = simulation.advance(state, 0, STEPS)
    return decibel(transmittance(dataclasses.replace(orbit, trajectory=simulation.run(state, 0, STEPS)[0])))


def test_orbit_of_a_slow_law_is_the_one_that_plain_periods_end_at() -> None:
    """Wear of a fiftieth a period moves the chain by less and less; 500 periods leave e^-10 of it."""
    simulation = WearingChain(lanes_of(0.9))
    orbit = periodic_orbits(simulation, STEPS)[0]
    unworn = periodic_orbits(CompiledSimulation(simulation.lanes), STEPS)[0]
    assert orbit.converged
    assert orbit.periods < 100, "wear is mixed as positions are, not waited for"
    assert decibel(transmittance(orbit)) == pytest.approx(decibels_after(simulation, orbit, 500), abs=1e-6)
    assert decibel(transmittance(orbit)) == pytest.approx(decibels_after(simulation, unworn, 500), abs=1e-3)
    assert abs(decibel(transmittance(orbit)) - decibel(transmittance(unworn))) > 0.5, "the law changes something"


def test_lanes_of_a_slow_law_leave_the_batch_one_by_one() -> None:
    simulation = WearingChain(lanes_of(0.6, 0.9, 1.4))
    together = periodic_orbits(simulation, STEPS)
    for lane, orbit in enumerate(together):
        alone = periodic_orbits(simulation.subset([lane]), STEPS)[0]
        assert orbit.converged
        assert alone.converged
        assert decibel(transmittance(orbit)) == pytest.approx(decibel(transmittance(alone)), abs=1e-5)


class EverWearingChain(WearingChain):
    """Wear that never ends, and acts only once it is there: positions and velocities repeat, and wear does not."""

    def run(self, state: State, start: int, steps: int) -> list[Trajectory]:
        wear = np.zeros((len(self.lanes), 1)) if state.internal_state is None else state.internal_state
        trajectories = CompiledSimulation(self.lanes).run(State(state.positions, state.velocities), start, steps)
        return [
            dataclasses.replace(one, internal_state=part + UNIT) for one, part in zip(trajectories, wear, strict=True)
        ]


def test_no_orbit_is_certified_while_internal_state_still_moves() -> None:
    """A unit a period is a part 1/p of how far p periods have taken it, however far mixing extrapolates it."""
    orbit = periodic_orbits(EverWearingChain(lanes_of(0.9)), STEPS, max_periods=30, longest_multiple=1)[0]
    assert orbit.status is OrbitStatus.PERIOD_LIMIT
    assert orbit.residual > 1 / 50


def test_first_period_of_a_fresh_start_certifies_nothing() -> None:
    """Its start has no internal state that its end could be compared with, even where all masses are back."""
    simulation = WearingChain(lanes_of(0.9))
    unworn = periodic_orbits(CompiledSimulation(simulation.lanes), STEPS)[0].trajectory.end
    orbit = periodic_orbits(simulation, STEPS, start=unworn, max_periods=1, longest_multiple=1)[0]
    assert orbit.status is OrbitStatus.PERIOD_LIMIT
    assert orbit.residual == pytest.approx(1.0)


def state_with(*internal_state: float) -> State:
    return State(np.zeros((1, 4)), np.zeros((1, 4)), np.array([internal_state]))


def test_internal_state_is_measured_by_how_far_values_of_its_kind_have_come() -> None:
    """Two contacts, two kinds: forces of some newtons, deflections of some micrometres."""
    scales = StateScales(lanes_of(0.9), STEPS)
    first, second = state_with(-4.0, 0.0, 1e-6, 2e-6), state_with(-2.0, 0.0, 0.0, -4e-6)
    scales.learn(None, first, [0])
    factor = scales.learn(first, second, [0])
    assert factor[0, 8:] == pytest.approx([4 / 6, 4 / 6, 2 / 8, 2 / 8])
    assert scales.vectors(state_with(3.0, 1.5, 4e-6, 0.0), [0])[0, 8:] == pytest.approx([0.5, 0.25, 0.5, 0.0])


def test_internal_state_that_is_zero_or_not_finite_has_no_size() -> None:
    scales = StateScales(lanes_of(0.9), STEPS)
    scales.learn(None, state_with(0.0, 0.0, np.nan, np.inf), [0])
    assert np.array_equal(scales.vectors(state_with(0.0, 0.0, 0.0, 0.0), [0]), np.zeros((1, 12)))
    back = scales.state(scales.vectors(state_with(1.0, 2.0, 3.0, 4.0), [0]), [0])
    assert back.internal_state is not None
    assert back.internal_state[0] == pytest.approx([1, 2, 3, 4])
