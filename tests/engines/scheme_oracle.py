"""The scheme written out in matrices, and chains to hold engines against it."""

import dataclasses

import numpy as np

from multibody_xval.engines.interface.laws import law_of
from multibody_xval.engines.interface.presets import Formulation, Option, Preset
from multibody_xval.engines.interface.registry import engine
from multibody_xval.engines.interface.tolerances import SINGLE
from multibody_xval.engines.interface.variant import Variant
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


def chain_of(mass: float, stiffness: float, length: float, friction_ratio: float = 0.3) -> Lane:
    """The canonical chain in other units: outer mass [kg], stiffness [N/m], amplitude [m]."""
    ratios = {"outer_mass": mass, "chain_stiffness": stiffness, "base_amplitude": length}
    chain = Chain.from_ratios(friction_ratio=friction_ratio, **ratios)
    return Lane.periodic(chain, HarmonicBase.from_ratio(chain, 0.9, length), STEPS)


def unstable_lane() -> Lane:
    """The canonical chain with steps so long that its motion diverges."""
    return lane_of(0.1, 0.1, 20)


def built(name: str, lane: Lane, **values: object) -> Simulation:
    """Build one lane by a configuration such as ``mujoco:joint:default``, with the values of some options replaced."""
    own = Variant.parse(name)
    if not values:
        return own.build([lane])
    options = own.preset.options | {option: Option(value, None, "") for option, value in values.items()}
    return engine(own.engine)._build((lane,), Formulation(own.formulation), Preset("", options))


def run(name: str, lane: Lane, state: State, steps: int = STEPS, start: int = 0, **values: object) -> Trajectory:
    """Run one lane of a configuration, with the values of some options replaced."""
    simulation = built(name, lane, **values)
    try:
        return simulation.run(state, start, steps)[0]
    finally:
        simulation.close()


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


def assert_same_bits(first: Trajectory, second: Trajectory) -> None:
    for name in ("positions", "velocities", "friction", "normal_force"):
        assert np.array_equal(getattr(first, name), getattr(second, name)), f"{name} differ"


def off_the_law(law: str, lane: Lane, name: str = "", **values: object) -> float:
    """Largest distance over two periods from rest, over U0, of a configuration from the law of one, or of itself."""
    rest, model = State.at_rest(1, lane.chain.cells), law_of(Variant.parse(law))
    assert model is not None
    apart = run(name or law, lane, rest, 2 * STEPS, **values).positions - model.positions(lane, rest, 2 * STEPS)
    return float(np.max(np.abs(apart))) / lane.drive.displacement_scale(lane.chain)
