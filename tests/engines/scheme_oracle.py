"""The scheme written out in matrices, and chains to hold engines against it."""

import dataclasses

import numpy as np

from multibody_xval.engines.interface.engine import Engine
from multibody_xval.engines.interface.presets import Formulation, Option, Preset
from multibody_xval.engines.interface.tolerances import SINGLE
from reference_lcp.chain.drives import HarmonicBase
from reference_lcp.chain.mass_in_mass import Chain
from reference_lcp.chain.simulation import Lane, Simulation
from reference_lcp.chain.trajectory import State, Trajectory

AMPLITUDE = 0.01
STEPS = 400
ROUND_OFF = 1e-12
"""Largest difference from the scheme over U0: both do the same arithmetic, in another order."""

ROUNDINGS = 10 * np.sqrt(STEPS) * SINGLE
"""Of engines in single precision, over the largest displacement: three standard deviations of the roundings of a
period, for motions of some six displacement scales."""


def lane_of(friction_ratio: object = 0.3, frequency_ratio: float = 0.6, steps: int = STEPS, **ratios: object) -> Lane:
    chain = Chain.from_ratios(friction_ratio=friction_ratio, base_amplitude=AMPLITUDE, **ratios)
    return Lane.periodic(chain, HarmonicBase.from_ratio(chain, frequency_ratio, AMPLITUDE), steps)


def unstable_lane() -> Lane:
    """The canonical chain with steps so long that its motion diverges."""
    return lane_of(0.1, 0.1, 20)


def built_with(
    engine: Engine, lane: Lane, formulation: str = "joint", preset: str = "tuned", **values: object
) -> Simulation:
    """Build one lane with some options of a preset replaced."""
    options = {name: Option(value, None, "") for name, value in values.items()}
    changed = Preset("", {**engine.preset(formulation, preset).options, **options})
    return engine._build((lane,), Formulation(formulation), changed)


def uneven_lane() -> Lane:
    """Every cell differs, one has no friction, and the inner dashpots are strong."""
    rng = np.random.default_rng(7)
    return lane_of(
        np.array([0.3, 0.1, 0.0, 0.5, 0.2, 1.0, 0.05]),
        mass_ratio=rng.uniform(0.3, 2.0, 7),
        stiffness_ratio=rng.uniform(0.3, 2.0, 7),
        damping_ratio=rng.uniform(0.0, 0.1, 7),
        inner_damping_ratio=rng.uniform(0.0, 0.3, 7),
        outer_mass_ratio=rng.uniform(0.5, 2.0, 7),
        chain_stiffness_ratio=rng.uniform(0.5, 2.0, 7),
    )


def random_state(lanes: int = 1, size: float = 1.0) -> State:
    rng = np.random.default_rng(3)
    return State(size * AMPLITUDE * rng.normal(size=(lanes, 14)), 10 * size * AMPLITUDE * rng.normal(size=(lanes, 14)))


def scheme(lane: Lane, state: State, steps: int) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Equation (5) in matrices, with the closed solution of each contact; gives positions, velocities, friction."""
    chain, dt = lane.chain, lane.time_step
    masses, directions = np.diag(chain.mass_matrix), chain.contact_directions
    delassus = 1 / chain.outer_mass + 1 / chain.inner_mass
    position, velocity = state.positions[0], state.velocities[0]
    rows = []
    for load in lane.loads(0, steps):
        force = -chain.stiffness_matrix @ position - chain.damping_matrix @ velocity
        force[0] += load
        free = velocity + dt * force / masses
        bound = chain.friction_bound * dt
        impulse = np.clip(-(directions.T @ free) / delassus, -bound, bound)
        velocity = free + directions @ impulse / masses
        position = position + dt * velocity
        rows.append((position, velocity, impulse / dt))
    positions, velocities, friction = (np.array(column) for column in zip(*rows, strict=True))
    return positions, velocities, friction


def assert_equals_scheme(
    lane: Lane, state: State, trajectory: Trajectory, scale: float = AMPLITUDE, round_off: float = ROUND_OFF
) -> None:
    positions, velocities, friction = scheme(lane, state, trajectory.steps)
    speed = scale * lane.chain.resonator_frequency
    force = scale * np.max(lane.chain.stiffness_matrix)
    np.testing.assert_allclose(trajectory.positions, positions, rtol=0, atol=round_off * scale)
    np.testing.assert_allclose(trajectory.velocities, velocities, rtol=0, atol=round_off * speed)
    # A force is a difference of velocities over dt, which costs it the digits of dt times the frequency.
    np.testing.assert_allclose(trajectory.friction, friction, rtol=0, atol=100 * round_off * force)


def with_coefficients(coefficient: object) -> Lane:
    """The canonical chain with these coefficients of friction, and the same bounds."""
    lane = lane_of()
    coefficients = np.broadcast_to(coefficient, 7).astype(float)
    bound = lane.chain.friction_bound
    chain = dataclasses.replace(lane.chain, friction_coefficient=coefficients, normal_force=bound / coefficients)
    return dataclasses.replace(lane, chain=chain)


def distance(lane: Lane, state: State, motion: Trajectory) -> float:
    """Largest distance from the scheme over the largest displacement."""
    expected = scheme(lane, state, motion.steps)[0]
    return float(np.max(np.abs(motion.positions - expected)) / np.max(np.abs(expected)))


def lanes_of_all_kinds() -> list[Lane]:
    """Lanes that differ in time step, frequency, friction, units and coefficient; the first has no dashpots."""
    heavy = Chain.from_ratios(friction_ratio=0.3, outer_mass=20.0, chain_stiffness=3e3, base_amplitude=0.1)
    return [
        lane_of(0.3, 0.6, damping_ratio=0.0),
        lane_of(0.1, 0.9, 2 * STEPS),
        lane_of(0.0, 1.3),
        Lane.periodic(heavy, HarmonicBase.from_ratio(heavy, 0.9, 0.1), 3 * STEPS),
        uneven_lane(),
        with_coefficients([0.5, 0.05, 0.3, 1.0, 0.02, 2.0, 0.7]),
    ]


def assert_same_bits(first: Trajectory, second: Trajectory) -> None:
    for name in ("positions", "velocities", "friction", "normal_force"):
        assert np.array_equal(getattr(first, name), getattr(second, name)), f"{name} differ"
