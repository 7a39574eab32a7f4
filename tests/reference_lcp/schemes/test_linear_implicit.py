"""Steps that are linear but for friction: closed scalar laws, and the scheme of equation (5) as one of them."""

import numpy as np

from reference_lcp.chain.drives import HarmonicBase
from reference_lcp.chain.mass_in_mass import Chain
from reference_lcp.chain.simulation import Lane
from reference_lcp.chain.trajectory import State, Trajectory
from reference_lcp.defaults import BASE_AMPLITUDE
from reference_lcp.schemes.euler import CompiledSimulation
from reference_lcp.schemes.linear_implicit import LinearImplicitLane, LinearStep, ScalarFriction

STEPS = 400

FRICTION = np.linspace(0.1, 0.7, 7)


def test_explicit_step_with_coulomb_friction_is_equation_5() -> None:
    lane, state = _lane(), _state()
    model = LinearImplicitLane(lane, LinearStep.explicit(lane.chain, lane.time_step), ScalarFriction.coulomb(7))
    expected = CompiledSimulation([lane]).run(state, 0, STEPS)[0]
    np.testing.assert_allclose(
        model.run(state, 0, STEPS).positions, expected.positions, rtol=0, atol=1e-12 * BASE_AMPLITUDE
    )


def test_theta_weighs_springs_and_dashpots_at_both_ends_of_the_step() -> None:
    """The difference of two motions under one load is a free one: M Δv / h + C v_θ + K x_θ = 0 in every step."""
    lane, theta, state = _lane(friction_ratio=0.0), 0.7, _state()
    model = LinearImplicitLane(lane, LinearStep.theta(lane.chain, lane.time_step, theta), ScalarFriction.coulomb(7))
    moved, resting = model.run(state, 0, STEPS), model.run(State.at_rest(1, 7), 0, STEPS)
    x = np.vstack([state.positions, moved.positions - resting.positions])
    v = np.vstack([state.velocities, moved.velocities - resting.velocities])
    weighed_x, weighed_v = (theta * each[1:] + (1 - theta) * each[:-1] for each in (x, v))
    inertia = np.diff(v, axis=0) / lane.time_step @ lane.chain.mass_matrix
    springs, dashpots = weighed_x @ lane.chain.stiffness_matrix, weighed_v @ lane.chain.damping_matrix
    assert np.isfinite(springs).all()
    np.testing.assert_allclose(inertia + dashpots, -springs, rtol=0, atol=1e-11 * np.max(np.abs(springs)))
    np.testing.assert_allclose(np.diff(x, axis=0), lane.time_step * weighed_v, rtol=0, atol=1e-13 * np.max(np.abs(x)))


def test_smooth_friction_is_that_of_the_slip_at_the_end_of_the_step() -> None:
    lane, speed = _lane(), 0.05
    run = _run(lane, ScalarFriction.smooth(7, speed))
    slip = run.relative_velocity
    expected = -lane.chain.friction_bound * slip / np.sqrt(slip**2 + speed**2)
    np.testing.assert_allclose(run.friction, expected, rtol=0, atol=1e-11 * np.max(lane.chain.friction_bound))


def test_friction_grows_on_beyond_a_bound_with_a_slope() -> None:
    """Half of the bound is reached with the compliance, and what is beyond it with the slope."""
    lane, compliance, slope = _lane(), np.full(7, 50.0), np.full(7, 2e-3)
    run = _run(lane, ScalarFriction.coulomb(7, compliance, slope, bound_share=0.5))
    speed, impulse = np.abs(run.relative_velocity), np.abs(run.friction) * lane.time_step
    knee = 0.5 * lane.time_step * lane.chain.friction_bound
    expected = np.where(speed < compliance * knee, speed / compliance, knee + slope * (speed - compliance * knee))
    np.testing.assert_allclose(impulse, expected, rtol=0, atol=1e-11 * np.max(knee))
    assert 0.1 < np.mean(speed < compliance * knee) < 0.9, "both parts of the law are tried"


def _run(lane: Lane, law: ScalarFriction) -> Trajectory:
    """Run an implicit Euler step, in which friction sees the slip velocity that it leads to."""
    return LinearImplicitLane(lane, LinearStep.implicit(lane.chain, lane.time_step), law).run(_state(), 0, STEPS)


def _lane(friction_ratio: float | np.ndarray = FRICTION) -> Lane:
    chain = Chain.from_ratios(friction_ratio=friction_ratio, inner_damping_ratio=0.02)
    return Lane.periodic(chain, HarmonicBase.from_ratio(chain, 0.9, BASE_AMPLITUDE), STEPS)


def _state() -> State:
    rng = np.random.default_rng(3)
    return State(rng.normal(0, BASE_AMPLITUDE, (1, 14)), rng.normal(0, 20 * BASE_AMPLITUDE, (1, 14)))
