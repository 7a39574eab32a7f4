"""SAPIEN: what only its two solvers, its articulations and single precision do."""

import gc

import numpy as np
import pytest

from multibody_xval.engines.interface.presets import Option, Preset
from multibody_xval.engines.interface.tolerances import FRICTION_TOLERANCE, ROUND_OFF
from multibody_xval.engines.interface.variant import Variant
from multibody_xval.engines.sapien import Sapien
from multibody_xval.engines.sapien.contact import SapienContactLane
from multibody_xval.engines.sapien.law import DRAWN_BACK_PERIOD, SINGLE_PRECISION_PERIOD, temporal_gauss_seidel
from multibody_xval.engines.shared.coordinates import CarriedCoordinates
from reference_lcp.chain.simulation import Lane
from reference_lcp.chain.trajectory import State
from reference_lcp.validation import FloatArray
from tests.engines.scheme_oracle import (
    AMPLITUDE,
    ROUNDINGS,
    STEPS,
    chain_of,
    distance,
    lane_of,
    off_the_law,
    random_state,
    run,
    scheme,
)

pytestmark = pytest.mark.needs("sapien")


@pytest.mark.parametrize(("position", "velocity"), [(1, 0), (1, 1), (10, 1), (10, 4)])
def test_iterations_of_the_temporal_solver_are_substeps_that_relax_friction(position: int, velocity: int) -> None:
    """With one substep, a contact that comes to rest keeps a fifth of its slip; that makes 1e-3 U0 a period."""
    lane, state = lane_of(), random_state()
    options = {"solver_position_iterations": position, "solver_velocity_iterations": velocity}
    preset = Preset("", {name: Option(value, None, "") for name, value in options.items()})
    motion = run("sapien:contact", lane, state, enable_tgs=True, **options)
    predicted = temporal_gauss_seidel(preset).positions(lane, state, STEPS)
    law = np.max(np.abs(motion.positions - predicted)) / AMPLITUDE
    assert law < SINGLE_PRECISION_PERIOD
    assert distance(lane, state, motion) * 3.3 > 5 * law


def test_contacts_that_are_solved_in_fours_pass_their_bound_by_an_absolute_impulse() -> None:
    """By 1e-5 units of impulse: in SI units, small chains then have more friction than they should."""
    lane = chain_of(1e-3, 1.0, AMPLITUDE)
    assert np.max(lane.chain.friction_bound) * lane.time_step < 1e-5
    light, si = (
        off_the_law("sapien:contact:default", lane, "sapien:contact", enable_tgs=True, units=units)
        for units in ("light", "SI")
    )
    assert light < DRAWN_BACK_PERIOD
    assert si > 0.1


def normal_impulses(lane: Lane, steps: int, preset: str) -> FloatArray:
    """Give what PhysX itself reports after every step, over the pressing force's, shape (steps, n)."""
    model = SapienContactLane(lane, Variant("sapien", "contact", preset).preset)
    motion, step = model._started(random_state(), 0, steps)
    rows = []
    for load in model._loads(0, steps, motion):
        force = model._forces @ motion
        force[0] += load
        step(force)
        rows.append([sum(point.impulse[2] for point in own.points) for own in model._system.get_contacts()])
    return np.array(rows) / (model._chain.normal_force * model._time_step)


def test_a_pressed_sphere_neither_sinks_nor_is_pushed_out_and_one_that_is_pressed_alone_sinks_in(monkeypatch) -> None:
    def press_inner_alone(self: SapienContactLane, normal_load: FloatArray) -> None:
        self._pushing[normal_load.size :, 2] = -normal_load

    for preset in ("tuned", "default"):
        impulses = normal_impulses(lane_of(), STEPS, preset)
        assert impulses == pytest.approx(np.ones((STEPS, 7)), rel=ROUND_OFF["single"])
    monkeypatch.setattr(SapienContactLane, "_set_normal_load", press_inner_alone)
    assert np.min(normal_impulses(lane_of(), 50, "tuned")) < 0.9


@pytest.mark.parametrize("mass_ratio", [1e-6, 1e-3, 1e3])
def test_neither_mass_of_a_cell_is_lost_beside_the_other(mass_ratio: float, monkeypatch: pytest.MonkeyPatch) -> None:
    """An articulation in which the lighter one carries loses it, and tells another friction."""
    lane = lane_of(0.3, 0.9, mass_ratio=mass_ratio * np.random.default_rng(1).uniform(0.7, 1.4, 7))
    state, expected = State.at_rest(1, 7), scheme(lane, State.at_rest(1, 7), STEPS)[2]

    def off() -> tuple[float, float]:
        motion = run("sapien", lane, state)
        return distance(lane, state, motion), np.max(np.abs(motion.friction - expected) / lane.chain.friction_bound)

    moved, rubbed = off()
    assert moved < ROUNDINGS
    assert rubbed < FRICTION_TOLERANCE["single"]
    if mass_ratio == 1e3:
        carried = CarriedCoordinates(np.zeros(7, dtype=bool))
        monkeypatch.setattr(CarriedCoordinates, "of_chain", lambda _chain: carried)
        assert off() > (ROUNDINGS, 10 * rubbed)


@pytest.mark.parametrize("friction_ratio", [0.3, 5.0])
def test_drag_of_links_is_not_read_as_friction(friction_ratio: float) -> None:
    """Stuck and sliding contacts of the default: friction and drag are what changes the momentum of inner masses."""
    lane, state, inner = lane_of(friction_ratio, 0.6), random_state(), slice(7, 14)
    motion, chain = run("sapien:joint:default", lane, state), lane.chain
    position, velocity = (
        np.vstack([state.positions, motion.positions]),
        np.vstack([state.velocities, motion.velocities]),
    )
    force = -(position @ chain.stiffness_matrix + velocity @ chain.damping_matrix)[:-1, inner]
    drag = 0.05 * chain.inner_mass * velocity[:-1, inner]
    friction = chain.inner_mass * np.diff(velocity[:, inner], axis=0) / lane.time_step - force + drag
    assert np.max(np.abs(motion.friction - friction)) < FRICTION_TOLERANCE["single"] / 10 * np.max(np.abs(friction))


@pytest.mark.parametrize("formulation", ["joint", "contact"])
def test_lanes_outlive_what_python_collects(formulation: str) -> None:
    """Bodies do not keep their scene: without it the process ends."""
    model = Sapien().lane_models[formulation](lane_of(), Sapien().preset(formulation, "tuned"))
    motion = model._motion(random_state())
    step = model._begin(motion)
    gc.collect()
    step(np.zeros(14))
    assert np.all(np.isfinite(motion))
