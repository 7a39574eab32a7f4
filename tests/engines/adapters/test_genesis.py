"""Genesis: its laws, which need no engine; and what only its scenes, its cones and its traps do."""

import dataclasses
import json
import math
import subprocess
import sys
from collections.abc import Mapping

import numpy as np
import pytest
from multibody_xval.engines.mujoco.step_model import LEAST_COEFFICIENT as MUJOCOS_LEAST

from multibody_xval.engines.interface.engine import Engine
from multibody_xval.engines.interface.law import Law
from multibody_xval.engines.interface.registry import engine
from multibody_xval.engines.interface.scene import ArmScene, ContactScene, JointScene, Scene
from multibody_xval.engines.interface.variant import Variant
from reference_lcp.chain.drives import StillBase
from reference_lcp.chain.preload import Preload
from reference_lcp.chain.simulation import Lane
from reference_lcp.chain.trajectory import State, Trajectory
from reference_lcp.errors import ParameterError
from tests.engines.scheme_oracle import (
    AMPLITUDE,
    STEPS,
    assert_equals_scheme,
    lane_of,
    random_state,
    uneven_lane,
    unstable_lane,
    with_coefficients,
)

ENGINE = engine("genesis")

HELD = "default:across=held"

where_installed = pytest.mark.needs("genesis")
every_preset = pytest.mark.parametrize(
    ("formulation", "preset"),
    [("joint", "tuned"), ("joint", "default"), ("contact", "tuned"), ("contact", "default"), ("contact", HELD)],
)

AS_INSTALLED = {"joint": "default", "contact": HELD}
"""Presets of which one step tells the law."""

CREEP = 1e-7
"""Largest distance from the scheme of a tuned contact, over U0: ten times its residual slip compliance."""


def law_of(formulation: str, **constants: float) -> Law:
    """The law of a default, of contacts that are held, with some of its constants replaced."""
    law = Variant.parse(f"genesis:{formulation}:{AS_INSTALLED[formulation]}").preset.stated_law()
    assert isinstance(law, Law)
    return with_constants(law, constants)


def with_constants(law: Law, values: Mapping[str, float]) -> Law:
    changed = {symbol: dataclasses.replace(law.constants[symbol], value=value) for symbol, value in values.items()}
    return dataclasses.replace(law, constants={**law.constants, **changed})


def still_lane(time_step: float, friction_ratio: float = 50.0) -> Lane:
    """One cell that nothing drives, without dashpots."""
    lane = lane_of(friction_ratio, cells=1, damping_ratio=0.0, inner_damping_ratio=0.0)
    return Lane(lane.chain, StillBase(AMPLITUDE), time_step)


def slip_left(stepped_by: Law | Engine, lane: Lane, formulation: str) -> float:
    """Part of a slip of 1 mm/s, with all springs at rest, that a step leaves."""
    state = State(np.zeros((1, 2)), np.array([[0.0, 1e-3]]))
    simulation = (
        stepped_by.build([lane])
        if isinstance(stepped_by, Law)
        else stepped_by.build([lane], formulation, AS_INSTALLED[formulation])
    )
    after = simulation.run(state, 0, 1)[0].relative_velocity[0, 0]
    simulation.close()
    return float(after) / 1e-3


@pytest.mark.parametrize(
    ("time_step", "left"),
    [(1e-3, 1 - 1e-3 * 2 * 0.9 / (0.95 * 0.01)), (4e-3, 1 - 4e-3 * 2 * 0.9 / (0.95 * 0.01)), (8e-3, 1 - 0.9 / 0.95)],
    ids=["small", "larger", "time constant of two steps"],
)
def test_law_of_the_joint_leaves_a_stick_the_part_of_its_slip_that_a_time_constant_leaves(
    time_step: float, left: float
) -> None:
    assert slip_left(law_of("joint"), still_lane(time_step), "joint") == pytest.approx(left, rel=1e-12)


@pytest.mark.parametrize("coefficient", [0.1, 0.5, 1.5])
def test_law_of_the_contact_leaves_a_stick_what_the_two_edges_along_it_leave(coefficient: float) -> None:
    lane = still_lane(1e-3)
    chain = dataclasses.replace(lane.chain, friction_coefficient=np.array([coefficient]))
    lane = dataclasses.replace(lane, chain=chain)
    inverse = 1 / chain.outer_mass[0] + 1 / chain.inner_mass[0]
    # λ = −2 μ² s / R with s = A λ + b w, at a depth of more than the width of solimp.
    softness = (1 + coefficient**2) * (0.05 / 0.95) * inverse / 3
    friction = -(2 / (0.95 * 0.01)) / (inverse + softness)
    left = 1 + 1e-3 * inverse * friction
    assert slip_left(law_of("contact"), lane, "contact") == pytest.approx(left, rel=1e-9)


@pytest.mark.parametrize("formulation", ["joint", "contact"])
def test_law_with_mujocos_time_constant_is_mujocos_where_inner_dashpots_are_none(formulation: str) -> None:
    """MuJoCo has those implicit; and its spheres have one more way to go, which makes contacts softer."""
    lane, state = uneven_lane(), random_state()
    lane = dataclasses.replace(lane, chain=dataclasses.replace(lane.chain, inner_damping=np.zeros(7)))
    if formulation == "contact":
        # so light plates that the inverse mass is theirs alone
        chain = dataclasses.replace(lane.chain, inner_mass=1e6 * lane.chain.inner_mass)
        lane = dataclasses.replace(lane, chain=chain)
    held = ":across=held" if formulation == "contact" else ""
    mujocos = Variant.parse(f"mujoco-warp:{formulation}:default{held}").preset.stated_law()
    assert isinstance(mujocos, Law)
    own, theirs = (law.build([lane]).run(state, 0, STEPS)[0] for law in (law_of(formulation, τ=0.02), mujocos))
    allowed = 1e-12 if formulation == "joint" else 1e-5
    assert np.max(np.abs(own.positions - theirs.positions)) < allowed * np.max(np.abs(theirs.positions))


def run(lane: Lane, state: State, formulation: str = "joint", preset: str = "tuned", steps: int = STEPS) -> Trajectory:
    simulation = ENGINE.build([lane], formulation, preset)
    trajectory = simulation.run(state, 0, steps)[0]
    simulation.close()
    return trajectory


def assert_same_bits(first: Trajectory, second: Trajectory) -> None:
    for name in ("positions", "velocities", "friction", "normal_force"):
        assert np.array_equal(getattr(first, name), getattr(second, name)), f"{name} differ"


@where_installed
@pytest.mark.parametrize("formulation", ["joint", "contact"])
@pytest.mark.parametrize("time_step", [1e-3, 8e-3])
def test_default_leaves_a_stick_what_its_law_leaves(formulation: str, time_step: float) -> None:
    """Genesis floors a time constant at two steps."""
    lane = still_lane(time_step)
    left = slip_left(law_of(formulation), lane, formulation)
    assert slip_left(ENGINE, lane, formulation) == pytest.approx(left, rel=1e-8)


@where_installed
def test_friction_does_not_press_by_signorinis_law_and_does_by_the_pyramid_as_its_law_says() -> None:
    lane, state = lane_of(), random_state()
    own = run(lane, state, "contact").normal_force
    assert own == pytest.approx(np.broadcast_to(lane.chain.normal_force, own.shape), rel=1e-12)
    pressed = run(lane, state, "contact", HELD).normal_force
    predicted = law_of("contact").build([lane]).run(state, 0, STEPS)[0].normal_force
    assert np.max(pressed / lane.chain.normal_force) > 1.5
    assert pressed == pytest.approx(predicted, rel=1e-3)


@where_installed
@every_preset
def test_lanes_of_one_scene_or_several_move_as_each_alone(formulation: str, preset: str) -> None:
    """Other time steps, masses, bounds, and cells without friction, in the order in which they were given."""
    lanes, state = [lane_of(0.3, 0.6), uneven_lane(), lane_of(0.1, 0.9, 2 * STEPS), lane_of(0.0, 1.3)], random_state(4)
    simulation = ENGINE.build(lanes, formulation, preset)
    together = simulation.run(state, 7, 50)
    ends = simulation.advance(state, 7, 50)
    simulation.close()
    for index, lane in enumerate(lanes):
        alone = ENGINE.build([lane], formulation, preset).run(state.subset([index]), 7, 50)[0]
        assert_same_bits(alone, together[index])
        assert np.array_equal(alone.positions[-1], ends.positions[index])


@where_installed
@pytest.mark.parametrize("formulation", ["joint", "contact"])
def test_lane_that_diverges_stops_and_leaves_the_others_alone(formulation: str) -> None:
    """At numbers that are not finite Genesis would end all environments of a scene."""
    steps, state = 3000, random_state(2)
    diverging, other = ENGINE.build([unstable_lane(), lane_of()], formulation).run(state, 0, steps)
    assert np.all(np.isfinite(diverging.positions))
    assert np.max(np.abs(diverging.positions)) > 1e6
    assert np.array_equal(diverging.positions[-1], diverging.positions[-2])
    assert np.array_equal(diverging.friction[-1], diverging.friction[-2])
    alone = run(lane_of(), state.subset([1]), formulation, steps=steps)
    assert np.array_equal(other.positions, alone.positions)
    assert np.array_equal(other.friction, alone.friction)


@where_installed
def test_bound_that_changes_in_time_is_that_of_its_lane_and_step() -> None:
    constant, state = uneven_lane(), random_state(2)
    changing = dataclasses.replace(constant, preload=Preload.at_multiple(constant.drive, 0.8, 1))
    first, second = ENGINE.build([constant, changing]).run(state, 0, STEPS)
    assert_same_bits(first, run(constant, state.subset([0])))
    bound = constant.chain.friction_coefficient * changing.preloads(0, STEPS)
    slides = np.abs(second.relative_velocity) > 0.1 * AMPLITUDE * constant.chain.resonator_frequency
    assert slides.any()
    assert np.abs(second.friction)[slides] == pytest.approx(bound[slides], rel=1e-9)


@where_installed
def test_coefficient_below_the_one_that_genesis_takes_for_it_is_refused_by_the_default_alone() -> None:
    lane, state = with_coefficients([0.5, 0.3, 0.002, 0.3, 0.3, 0.3, 0.3]), random_state()
    assert np.min(lane.chain.friction_coefficient) > MUJOCOS_LEAST
    assert_equals_scheme(lane, state, run(lane, state, "contact"), round_off=CREEP)
    for preset in ("default", HELD):
        with pytest.raises(ParameterError, match=r"friction_coefficient = 0.002; allowed: at least 0.01 in Genesis"):
            run(lane, state, "contact", preset)


TRAPS = """
import json, genesis as gs
gs.init(backend=gs.cpu, precision="64", logging_level="error")
MODEL = '''<mujoco><worldbody><body><inertial pos="0 0 0" mass="1" diaginertia="1 1 1"/>
<joint name="slip" type="slide" axis="1 0 0" frictionloss="1" solreffriction="0.5 1" solreflimit="0.02 1"/>
</body></worldbody></mujoco>'''

def refusal():
    try:
        gs.options.RigidOptions(friction_cone=gs.friction_cone.elliptic, noslip_iterations=1)
    except Exception as problem:
        return str(problem)

scene = gs.Scene(show_viewer=False, sim_options=gs.options.SimOptions(dt=0.001, gravity=(0, 0, 0)),
    rigid_options=gs.options.RigidOptions(constraint_timeconst=None))
chain = scene.add_entity(gs.morphs.MJCF(file=MODEL))
scene.build()
print("\\n" + json.dumps({
    "armature": chain.get_dofs_armature().tolist(),
    "time constant": float(chain.get_joint("slip").get_sol_params().flatten()[0]),
    "refusal": refusal(),
}))
"""


@where_installed
@pytest.mark.slow
def test_traps_of_genesis_are_still_there() -> None:
    """What the adapter goes round: once one of these is gone, so can be what goes round it."""
    done = subprocess.run([sys.executable, "-c", TRAPS], capture_output=True, text=True, check=True)
    traps = json.loads(done.stdout.strip().splitlines()[-1])
    assert traps["armature"] == [0.1], "of a joint that has none"
    assert traps["time constant"] == pytest.approx(0.02), "of friction: it is solreflimit's, not solreffriction's"
    assert "elliptic friction cone is not supported with the noslip solver" in traps["refusal"]


@where_installed
@pytest.mark.slow
def test_free_sphere_moves_by_mujocos_law_to_round_off_where_contacts_open_too() -> None:
    law = Variant.parse("genesis:contact:default").preset.stated_law()
    assert isinstance(law, Law)
    constant, state = lane_of(), random_state()
    opening = dataclasses.replace(constant, preload=Preload.at_multiple(constant.drive, 1.5, 1))
    for lane in (constant, opening):
        own, predicted = run(lane, state, "contact", "default"), law.build([lane]).run(state, 0, STEPS)[0]
        assert own.normal_gap is not None
        assert np.max(own.normal_gap) > 0, "nothing hops"
        assert np.max(np.abs(own.positions - predicted.positions)) < 1e-9 * AMPLITUDE
        assert np.max(np.abs(own.normal_gap - predicted.normal_gap)) < 1e-9 * AMPLITUDE


@where_installed
@pytest.mark.slow
@pytest.mark.parametrize(
    ("scene", "most"),
    [(ContactScene(slope=math.atan(0.45)), 0.5), (JointScene(load=0.9), 1.0), (ArmScene(friction=(1.09,)), 10.0)],
    ids=["slope", "hinge", "arm"],
)
def test_recipe_holds_what_creeps_as_installed_by_a_hundred_times_as_much(scene: Scene, most: float) -> None:
    def creep(preset: str) -> float:
        world = ENGINE.scene_with(scene, preset, ENGINE.scene_step, sleeping=False)
        rows = world.run(300)
        world.close()
        return 1e6 * float(np.linalg.norm(rows[-1, :3] - rows[100, :3])) / 2

    assert creep("recommended") < most
    assert creep("default") > 100 * most
