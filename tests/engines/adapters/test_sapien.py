"""SAPIEN: what only its two solvers, its articulations, its hidden damping and friction, and single precision do."""

import gc

import numpy as np
import pytest

from multibody_xval.engines.interface.laws import Law, law_of
from multibody_xval.engines.interface.presets import Option, Preset
from multibody_xval.engines.interface.tolerances import FRICTION_TOLERANCE, ROUND_OFF
from multibody_xval.engines.interface.variant import Variant
from multibody_xval.engines.sapien import Sapien
from multibody_xval.engines.sapien.contact import SapienContactLane
from multibody_xval.engines.sapien.law import DRAWN_BACK_PERIOD, SINGLE_PRECISION_PERIOD, temporal_gauss_seidel
from multibody_xval.engines.shared.coordinates import CarriedCoordinates
from reference_lcp.chain.drives import HarmonicBase
from reference_lcp.chain.mass_in_mass import Chain
from reference_lcp.chain.simulation import Lane
from reference_lcp.chain.trajectory import State, Trajectory
from reference_lcp.validation import FloatArray
from tests.engines.scheme_oracle import (
    AMPLITUDE,
    ROUNDINGS,
    STEPS,
    built_with,
    distance,
    lane_of,
    random_state,
    scheme,
    unstable_lane,
)

pytestmark = pytest.mark.needs("sapien")

FORMULATIONS = ("joint", "contact")

TUNED_SPLIT = 2 * ROUNDINGS
"""Of U0: a state in coordinates of cells is rounded when it is turned into absolute ones and back."""


def law_of_default(formulation: str) -> Law:
    law = law_of(Variant("sapien", formulation, "default"))
    assert law is not None
    return law


def run(lane: Lane, state: State, steps: int = STEPS, formulation: str = "joint", **options: object) -> Trajectory:
    return built_with(Sapien(), lane, formulation, **options).run(state, 0, steps)[0]


def test_links_are_slowed_down_unless_told_not_to_be() -> None:
    lane, state = lane_of(), random_state()
    assert distance(lane, state, run(lane, state, units="SI", **{"linear damping": 0.05})) > 100 * ROUNDINGS


def test_joints_have_a_friction_of_their_own_unless_told_not_to_have_it() -> None:
    lane, state = lane_of(), random_state()
    assert distance(lane, state, run(lane, state, **{"joint friction": 0.05})) > 0.1


def test_friction_given_with_the_other_properties_of_a_joint_is_not_the_friction_that_it_has() -> None:
    """Of SAPIEN itself, where it would mislead an adapter without a message."""
    from multibody_xval.engines.sapien.joint import import_sapien

    sapien = import_sapien()
    scene = sapien.Scene([sapien.physx.PhysxCpuSystem()])
    builder = scene.create_articulation_builder()
    link = builder.create_link_builder(builder.create_link_builder())
    link.set_joint_properties("prismatic", [[-1.0, 1.0]], sapien.Pose(), sapien.Pose(), 0.0, 0.0)
    (joint,) = builder.build(fix_root_link=True).get_active_joints()
    assert joint.get_friction() == np.float32(0.05)


@pytest.mark.parametrize(("limit", "velocity"), [("max joint velocity", 100.0), ("max linear velocity", 10.0)])
def test_motion_far_above_the_displacement_scale_is_not_cut_off(limit: str, velocity: float) -> None:
    lane, state = lane_of(), random_state(size=1e7)
    assert distance(lane, state, run(lane, state, 50)) < ROUNDINGS
    assert distance(lane, state, run(lane, state, 50, **{limit: velocity})) > 0.1


@pytest.mark.parametrize("iterations", [(1, 0), (1, 1), (4, 1), (10, 1), (10, 4)])
def test_iterations_of_the_temporal_solver_are_substeps_that_relax_friction(iterations: tuple[int, int]) -> None:
    """With one substep, a contact that comes to rest keeps a fifth of its slip; that makes 1e-3 U0 a period."""
    lane, state = lane_of(), random_state()
    position, velocity = iterations
    options = {"solver_position_iterations": position, "solver_velocity_iterations": velocity}
    preset = Preset("", {name: Option(value, None, "") for name, value in options.items()})
    motion = run(lane, state, formulation="contact", enable_tgs=True, **options)
    predicted = temporal_gauss_seidel(preset).positions(lane, state, STEPS)
    law = np.max(np.abs(motion.positions - predicted)) / AMPLITUDE
    assert law < SINGLE_PRECISION_PERIOD
    assert distance(lane, state, motion) * 3.3 > 5 * law


def test_contacts_that_are_solved_in_fours_pass_their_bound_by_an_absolute_impulse() -> None:
    """By 1e-5 units of impulse: in SI units, small chains then have more friction than they should."""
    chain = Chain.from_ratios(friction_ratio=0.3, outer_mass=1e-3, chain_stiffness=1.0, base_amplitude=AMPLITUDE)
    lane = Lane.periodic(chain, HarmonicBase.from_ratio(chain, 0.6, AMPLITUDE), STEPS)
    rest = State.at_rest(1, 7)
    predicted = law_of_default("contact").positions(lane, rest, STEPS)
    light, si = (
        np.max(np.abs(run(lane, rest, STEPS, "contact", enable_tgs=True, units=units).positions - predicted))
        for units in ("light", "SI")
    )
    assert np.max(chain.friction_bound) * lane.time_step < 1e-5
    assert light < DRAWN_BACK_PERIOD * AMPLITUDE
    assert si > 0.1 * AMPLITUDE


@pytest.mark.parametrize("tgs", [False, True])
def test_a_rotation_that_is_locked_still_yields_unless_it_is_heavy(tgs: bool) -> None:
    lane, state = lane_of(), random_state()
    heavy, yielding = (
        distance(lane, state, run(lane, state, formulation="contact", enable_tgs=tgs, inertia=value))
        for value in (1e30, 1e6)
    )
    assert yielding > 10 * heavy


def normal_impulses(lane: Lane, steps: int, *, tgs: bool) -> FloatArray:
    """Give what PhysX itself reports after every step, over the pressing force's, shape (steps, n)."""
    preset = Sapien().preset("contact", "default" if tgs else "tuned")
    model = SapienContactLane(lane, preset)
    given = model._chain.normal_force * model._time_step
    rows = []
    motion, step = model._started(random_state(), 0, steps)
    for load in model._loads(0, steps, motion):
        force = model._forces @ motion
        force[0] += load
        step(force)
        contacts = model._system.get_contacts()
        rows.append([sum(point.impulse[2] for point in contact.points) for contact in contacts])
    return np.array(rows) / given


@pytest.mark.parametrize("tgs", [False, True])
def test_a_pressed_sphere_neither_sinks_nor_is_pushed_out(tgs: bool) -> None:
    impulses = normal_impulses(lane_of(), STEPS, tgs=tgs)
    assert impulses.shape == (STEPS, 7)
    np.testing.assert_allclose(impulses, 1.0, rtol=ROUND_OFF["single"])


def test_a_sphere_that_is_pressed_alone_sinks_in(monkeypatch: pytest.MonkeyPatch) -> None:
    def press_inner_alone(self: SapienContactLane, normal_load: FloatArray) -> None:
        self._pushing[normal_load.size :, 2] = -normal_load

    monkeypatch.setattr(SapienContactLane, "_set_normal_load", press_inner_alone)
    assert np.min(normal_impulses(lane_of(), 50, tgs=False)) < 0.9


@pytest.mark.parametrize("mass_ratio", [1e-6, 1e-3, 1e3])
def test_neither_mass_of_a_cell_is_lost_beside_the_other(mass_ratio: float, monkeypatch: pytest.MonkeyPatch) -> None:
    """An articulation in which the lighter one carries loses it, and tells another friction."""
    rng = np.random.default_rng(1)
    lane = lane_of(0.3, 0.9, mass_ratio=mass_ratio * rng.uniform(0.7, 1.4, 7))
    state, bound = State.at_rest(1, 7), lane.chain.friction_bound
    motion, expected = run(lane, state), scheme(lane, state, STEPS)[2]
    assert distance(lane, state, motion) < ROUNDINGS
    assert np.max(np.abs(motion.friction - expected) / bound) < FRICTION_TOLERANCE["single"]
    if mass_ratio == 1e3:
        carried = CarriedCoordinates(np.zeros(7, dtype=bool))
        monkeypatch.setattr(CarriedCoordinates, "of_chain", lambda _chain: carried)
        lost = run(lane, state)
        assert distance(lane, state, lost) > ROUNDINGS
        assert np.max(np.abs(lost.friction - expected) / bound) > 10 * np.max(
            np.abs(motion.friction - expected) / bound
        )


@pytest.mark.parametrize("formulation", FORMULATIONS)
def test_friction_of_a_sliding_contact_is_its_bound(formulation: str) -> None:
    lane, state = lane_of(0.01), random_state()
    motion, expected = run(lane, state, formulation=formulation), scheme(lane, state, STEPS)[2]
    bound = lane.chain.friction_bound[0]
    sliding = np.isclose(np.abs(expected), bound, rtol=ROUND_OFF["double"])
    assert np.mean(sliding) > 0.9
    np.testing.assert_allclose(motion.friction[sliding], expected[sliding], rtol=ROUND_OFF["double"])


@pytest.mark.parametrize("friction_ratio", [0.3, 5.0])
def test_drag_of_links_is_not_read_as_friction(friction_ratio: float) -> None:
    """Stuck and sliding contacts of the default: friction and drag are what changes the momentum of inner masses."""
    lane, state = lane_of(friction_ratio, 0.6), random_state()
    motion = Sapien().build([lane], "joint", "default").run(state, 0, STEPS)[0]
    chain, cells = lane.chain, slice(7, 14)
    position, velocity = (
        np.vstack([first, rows])
        for first, rows in ((state.positions, motion.positions), (state.velocities, motion.velocities))
    )
    force = -(position @ chain.stiffness_matrix + velocity @ chain.damping_matrix)[:-1, cells]
    drag = 0.05 * chain.inner_mass * velocity[:-1, cells]
    friction = chain.inner_mass * np.diff(velocity[:, cells], axis=0) / lane.time_step - force + drag
    largest = np.max(np.abs(friction))
    assert np.max(np.abs(motion.friction - friction)) < FRICTION_TOLERANCE["single"] / 10 * largest


def test_state_of_a_joint_is_passed_on_to_its_roundings() -> None:
    simulation, state = Sapien().build([lane_of()], "joint"), random_state()
    whole = simulation.run(state, 0, STEPS)[0]
    for step in range(0, STEPS, 10):
        state = simulation.advance(state, step, 10)
    assert np.max(np.abs(state.positions[0] - whole.positions[-1])) <= TUNED_SPLIT * AMPLITUDE


@pytest.mark.parametrize(("formulation", "bound"), [("joint", SINGLE_PRECISION_PERIOD), ("contact", DRAWN_BACK_PERIOD)])
def test_heavy_stiff_and_small_chains_step_by_the_law_of_the_default(formulation: str, bound: float) -> None:
    for mass, stiffness, length in ((1e6, 1e9, AMPLITUDE), (1e-3, 1.0, 1e-6), (1.0, 1e3, 1.0)):
        chain = Chain.from_ratios(friction_ratio=0.3, outer_mass=mass, chain_stiffness=stiffness, base_amplitude=length)
        lane, rest = Lane.periodic(chain, HarmonicBase.from_ratio(chain, 0.9, length), STEPS), State.at_rest(1, 7)
        own = Sapien().build([lane], formulation, "default").run(rest, 0, STEPS)[0].positions
        assert np.max(np.abs(own - law_of_default(formulation).positions(lane, rest, STEPS))) < bound * length


def test_an_unstable_motion_is_silent_and_shows(capfd: pytest.CaptureFixture[str]) -> None:
    simulation = Sapien().build([unstable_lane()], "joint")
    end = simulation.advance(State.at_rest(1, 7), 0, 400)
    assert np.max(np.abs(end.positions)) > 1e6 * AMPLITUDE
    assert capfd.readouterr() == ("", "")


@pytest.mark.parametrize("formulation", FORMULATIONS)
def test_lanes_outlive_what_python_collects(formulation: str) -> None:
    """Bodies do not keep their scene: without it the process ends."""
    model = Sapien().lane_models[formulation](lane_of(), Sapien().preset(formulation, "tuned"))
    motion = model._motion(random_state())
    step = model._begin(motion)
    gc.collect()
    step(np.zeros(14))
    assert np.all(np.isfinite(motion))
