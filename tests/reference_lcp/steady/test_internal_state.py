"""Periodic orbits of laws with internal state: no orbit counts as found before that repeats too."""

import dataclasses

import numpy as np
import pytest

from reference_lcp import CompiledSimulation, Lane, PeriodicOrbit, State, periodic_orbits
from reference_lcp.chain.simulation import OrbitStatus
from reference_lcp.observables.transmittance import decibel, transmittance
from reference_lcp.steady.anderson import StateScales
from tests.reference_lcp.steady.memory import STEPS, RememberingChain, chain_of, lanes_of

UNIT = 1e-7
"""Size of the internal state: far below the displacement scale of 0.01 m, so that nothing but its own size shows it."""

RATE = 0.02
"""Part of the way to where it stays that wear goes in a period."""


def wearing(*frequency_ratios: float) -> RememberingChain:
    """A chain whose μN falls to a fifth as its contacts wear, over some hundred periods: by 1 − 0.8 w / UNIT."""

    def worn(lane: Lane, wear: float) -> Lane:
        return dataclasses.replace(lane, chain=chain_of(0.3 * (1 - 0.8 * wear / UNIT), 0.1))

    return RememberingChain(lanes_of(*frequency_ratios), worn, lambda wear: wear + RATE * (UNIT - wear))


def ever_wearing() -> RememberingChain:
    """Wear that never ends, and does nothing: positions and velocities repeat, and wear does not."""
    return RememberingChain(lanes_of(0.9), lambda lane, _: lane, lambda wear: wear + UNIT)


def decibels_after(simulation: RememberingChain, orbit: PeriodicOrbit, periods: int) -> float:
    """Transmittance so many plain periods after an orbit."""
    state = orbit.trajectory.end
    for _ in range(periods):
        state = simulation.advance(state, 0, STEPS)
    return decibel(transmittance(dataclasses.replace(orbit, trajectory=simulation.run(state, 0, STEPS)[0])))


def test_orbit_of_a_slow_law_is_the_one_that_plain_periods_end_at() -> None:
    """Wear of a fiftieth a period moves the chain by less and less; 500 periods leave e^-10 of it."""
    simulation = wearing(0.9)
    orbit = periodic_orbits(simulation, STEPS)[0]
    unworn = periodic_orbits(CompiledSimulation(simulation.lanes), STEPS)[0]
    assert orbit.converged
    assert orbit.periods < 100, "wear is mixed as positions are, not waited for"
    assert decibel(transmittance(orbit)) == pytest.approx(decibels_after(simulation, orbit, 500), abs=1e-6)
    assert decibel(transmittance(orbit)) == pytest.approx(decibels_after(simulation, unworn, 500), abs=1e-3)
    assert abs(decibel(transmittance(orbit)) - decibel(transmittance(unworn))) > 0.5, "the law changes something"


def test_lanes_of_a_slow_law_leave_the_batch_one_by_one() -> None:
    simulation = wearing(0.6, 0.9, 1.4)
    together = periodic_orbits(simulation, STEPS)
    for lane, orbit in enumerate(together):
        alone = periodic_orbits(simulation.subset([lane]), STEPS)[0]
        assert orbit.converged
        assert alone.converged
        assert decibel(transmittance(orbit)) == pytest.approx(decibel(transmittance(alone)), abs=1e-5)


def test_no_orbit_is_certified_while_internal_state_still_moves() -> None:
    """A unit a period is a part 1/p of how far p periods have taken it, however far mixing extrapolates it."""
    orbit = periodic_orbits(ever_wearing(), STEPS, max_periods=30, longest_multiple=1)[0]
    assert orbit.status is OrbitStatus.PERIOD_LIMIT
    assert orbit.residual > 1 / 50


def test_first_period_of_a_fresh_start_certifies_nothing() -> None:
    """Its start has no internal state that its end could be compared with, even where all masses are back."""
    simulation = wearing(0.9)
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
