"""Genesis: what only its scenes, its cones, its softness and its traps do."""

import dataclasses
import json
import math
import subprocess
import sys

import numpy as np
import pytest

from multibody_xval.engines.interface.registry import engine
from multibody_xval.engines.interface.scene import ArmScene, ContactScene, JointScene, Scene
from multibody_xval.engines.mujoco.contact import LEAST_COEFFICIENT as MUJOCOS_LEAST
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

CREEP = 1e-7
"""Largest distance from the scheme of a tuned contact, over U0: ten times its residual slip compliance."""


def run(lane: Lane, state: State, formulation: str = "joint", preset: str = "tuned", steps: int = STEPS) -> Trajectory:
    simulation = ENGINE.build([lane], formulation, preset)
    trajectory = simulation.run(state, 0, steps)[0]
    simulation.close()
    return trajectory


def assert_same_bits(first: Trajectory, second: Trajectory) -> None:
    for name in ("positions", "velocities", "friction", "normal_force"):
        assert np.array_equal(getattr(first, name), getattr(second, name)), f"{name} differ"


@where_installed
@pytest.mark.parametrize(
    ("time_step", "left"),
    [(1e-3, 1 - 1e-3 * 2 * 0.9 / (0.95 * 0.01)), (8e-3, 1 - 0.9 / 0.95)],
    ids=["time constant of its own", "time constant of two steps"],
)
def test_default_joint_leaves_a_stick_the_part_of_its_slip_that_a_time_constant_leaves(
    time_step: float, left: float
) -> None:
    chain = lane_of(50.0, cells=1, damping_ratio=0.0, inner_damping_ratio=0.0).chain
    slipping = State(np.zeros((1, 2)), np.array([[0.0, 1e-3]]))
    after = run(Lane(chain, StillBase(AMPLITUDE), time_step), slipping, "joint", "default", 1)
    assert after.relative_velocity[0, 0] == pytest.approx(1e-3 * left, rel=1e-8)


@where_installed
def test_friction_does_not_press_by_signorinis_law_and_does_by_the_pyramid() -> None:
    lane, state = lane_of(), random_state()
    own = run(lane, state, "contact").normal_force
    assert own == pytest.approx(np.broadcast_to(lane.chain.normal_force, own.shape), rel=1e-12)
    assert np.max(run(lane, state, "contact", HELD).normal_force / lane.chain.normal_force) > 1.5


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
