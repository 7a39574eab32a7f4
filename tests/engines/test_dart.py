"""DART: what only its friction, its springs and its readings do."""

import numpy as np
import pytest

from engines.dart import Dart
from engines.dart_joint import SOFTNESS
from engines.interface import Formulation, Option, Preset
from reference_lcp.chain import Chain
from reference_lcp.drive import HarmonicBase
from reference_lcp.simulation import Lane
from reference_lcp.trajectory import State, Trajectory
from tests.engines.scheme_oracle import AMPLITUDE, STEPS, lane_of, random_state, scheme

pytestmark = pytest.mark.skipif(Dart().why_not_installed() is not None, reason="dartpy is not installed")


def run(lane: Lane, state: State, steps: int, preset: Preset) -> Trajectory:
    return Dart()._build((lane,), Formulation.JOINT, preset).run(state, 0, steps)[0]


def tuned_but(**options: object) -> Preset:
    tuned = Dart().preset("joint", "tuned")
    return Preset("", {**tuned.options, **{name: Option(value, None, "") for name, value in options.items()}})


def test_a_stuck_contact_keeps_the_softness_of_what_friction_takes_from_it() -> None:
    lane = lane_of(5.0, 0.3)
    found = run(lane, State.at_rest(1, 7), STEPS, tuned_but())
    taken = found.friction * lane.time_step * (1 / lane.chain.outer_mass + 1 / lane.chain.inner_mass)
    left = -found.relative_velocity / np.max(np.abs(taken), axis=0)
    expected = SOFTNESS * taken / np.max(np.abs(taken), axis=0)
    np.testing.assert_allclose(left, expected, rtol=0, atol=1e-5 * SOFTNESS)


def test_friction_is_read_the_same_however_long_a_run_is() -> None:
    """Skeleton.getConstraintForces divides what it reads by the time step once more at every call."""
    lane, state = lane_of(), random_state()
    found = run(lane, state, 3 * STEPS, tuned_but())
    np.testing.assert_allclose(found.friction, scheme(lane, state, 3 * STEPS)[2], atol=1e-7 * AMPLITUDE * 1000)


def test_own_springs_are_implicit_and_take_energy() -> None:
    """At a tenth of the step they take a tenth as much: their error is of the first order."""
    losses = []
    for steps in (STEPS, 10 * STEPS):
        chain = Chain.from_ratios(damping_ratio=0.0, friction_ratio=0.0)
        lane = Lane.periodic(chain, HarmonicBase.from_ratio(chain, 0.6, 1e-12), steps)
        state = State(random_state().positions, np.zeros((1, 14)))
        found = Dart().build([lane], preset="default").run(state, 0, steps)[0]
        stretched, moving = found.positions[-1], found.velocities[-1]
        energy = stretched @ chain.stiffness_matrix @ stretched + moving @ chain.mass_matrix @ moving
        losses.append(1 - energy / (state.positions[0] @ chain.stiffness_matrix @ state.positions[0]))
    assert 0.05 < losses[0] < 0.9
    assert losses[0] / losses[1] == pytest.approx(10, rel=0.5)


def test_slow_chains_do_not_fall_asleep() -> None:
    """All bodies stay below DART's threshold of 0.01 m/s for more than its half second."""
    chain = Chain.from_ratios(friction_ratio=0.3, base_amplitude=1e-5)
    lane = Lane.periodic(chain, HarmonicBase.from_ratio(chain, 0.9, 1e-5), STEPS)
    found = run(lane, State.at_rest(1, 7), 8 * STEPS, tuned_but(units="SI"))
    assert np.max(np.abs(found.velocities)) < 0.01
    assert found.time[-1] > 1
    np.testing.assert_allclose(found.positions, scheme(lane, State.at_rest(1, 7), 8 * STEPS)[0], atol=1e-8 * 1e-5)


@pytest.mark.parametrize("preset", ["tuned", "default"])
def test_the_rounding_of_a_state_is_not_passed_on(preset: str) -> None:
    """Joint coordinates are differences: a state that goes out and in again is rounded once, and stays so."""
    simulation = Dart().build([lane_of()], preset=preset)
    whole = simulation.run(random_state(), 0, STEPS)[0]
    state = random_state()
    for step in range(0, STEPS, 10):
        state = simulation.advance(state, step, 10)
    np.testing.assert_allclose(state.positions[0], whole.positions[-1], rtol=0, atol=1e-13 * AMPLITUDE)
