"""Box2D: what only single precision, sleep, joints and limits of its steps do."""

import dataclasses
import subprocess
import sys

import numpy as np
import pytest

from multibody_xval.engines.box2d import Box2D
from multibody_xval.engines.interface.tolerances import SINGLE
from reference_lcp.chain.drives import StillBase
from reference_lcp.chain.mass_in_mass import Chain
from reference_lcp.chain.simulation import Lane
from reference_lcp.chain.trajectory import State, Trajectory
from tests.engines.scheme_oracle import (
    AMPLITUDE,
    ROUNDINGS,
    STEPS,
    built_with,
    distance,
    lane_of,
    random_state,
    uneven_lane,
)

pytestmark = pytest.mark.needs("box2d")


def run(lane: Lane, state: State, steps: int = STEPS, formulation: str = "joint", **options: object) -> Trajectory:
    return built_with(Box2D(), lane, formulation, **options).run(state, 0, steps)[0]


@pytest.mark.parametrize(("joint", "units"), [("prismatic", "lane"), ("prismatic", "SI"), ("friction", "SI")])
def test_motion_of_uneven_cells_equals_the_scheme_to_single_precision(joint: str, units: str) -> None:
    """Box2D makes a mass one again when the body is told not to turn after it has been told its mass."""
    lane, state = uneven_lane(), random_state()
    motion = run(lane, state, joint=joint, units=units)
    assert distance(lane, state, motion) < ROUNDINGS
    # more than single precision cannot be: a finer result would be another engine's
    assert distance(lane, state, motion) > SINGLE / 10


def test_small_boxes_do_not_touch_the_cell_beside_theirs() -> None:
    """In SI units Box2D's skins are as thick as boxes of a chain that moves by a millimetre."""
    lane = lane_of()
    small = dataclasses.replace(lane, drive=dataclasses.replace(lane.drive, amplitude=AMPLITUDE / 10))
    pressed = Box2D().build([small], "contact", "default").run(State.at_rest(1, 7), 0, 20)[0].normal_force
    np.testing.assert_allclose(pressed, np.broadcast_to(lane.chain.normal_force, pressed.shape), rtol=1e-4)


def test_friction_joints_let_small_impulses_go() -> None:
    """Box2D does not normalise a vector shorter than 1.2e-7, and where it should bound one, all but removes it."""
    chain = Chain.from_ratios(friction_ratio=0.3, outer_mass=1e-6, chain_stiffness=1e-3)
    lane, state = dataclasses.replace(lane_of(), chain=chain), random_state()
    assert np.max(chain.friction_bound * lane.time_step) < 2**-23
    assert distance(lane, state, run(lane, state, units="SI", joint="prismatic")) < ROUNDINGS
    assert distance(lane, state, run(lane, state, units="SI", joint="friction")) > 0.01


def test_motion_far_above_the_displacement_scale_is_not_cut_off() -> None:
    """In SI units Box2D stops a step of more than two metres short."""
    lane, state = lane_of(), random_state(size=1e7)
    assert distance(lane, state, run(lane, state, 50)) < ROUNDINGS
    assert distance(lane, state, run(lane, state, 50, units="SI")) > 0.1


def test_slow_chains_do_not_fall_asleep() -> None:
    """Box2D stops what is slower than 0.01 m/s for half a second; the argument doSleep of a world is ignored."""
    lane = dataclasses.replace(lane_of(0.0, damping_ratio=0.0), drive=StillBase(1e-5))
    state = State(random_state(size=1e-3).positions, np.zeros((1, 14)))
    asleep, awake = (run(lane, state, 3 * STEPS, units="SI", AllowSleeping=allowed) for allowed in (True, False))
    assert awake.time[-1] > 0.5
    assert distance(lane, state, awake) < 10 * ROUNDINGS
    assert distance(lane, state, asleep) > 0.1


def test_warnings_as_errors_do_not_end_the_interpreter() -> None:
    """Box2D's own module warns while it is loaded, and dies if that is raised."""
    program = "from multibody_xval.engines.box2d.joint import import_box2d; print(import_box2d().b2World().bodyCount)"
    done = subprocess.run([sys.executable, "-W", "error", "-c", program], capture_output=True, text=True, check=False)
    assert (done.returncode, done.stdout.strip(), done.stderr) == (0, "0", "")


def test_one_sweep_from_nothing_finds_no_friction() -> None:
    """Box2D bounds friction by the normal impulse of the sweep before."""
    lane, state = lane_of(), random_state()
    motion = run(lane, state, STEPS, "contact", velocityIterations=1)
    assert np.all(motion.friction == 0)
    assert distance(lane, state, motion) > 0.1


def test_boxes_that_pass_the_largest_step_are_reported() -> None:
    fast = State(np.zeros((1, 14)), np.full((1, 14), 100 * AMPLITUDE / lane_of().time_step))
    with pytest.raises(RuntimeError, match="Box2D cuts off at"):
        Box2D().build([lane_of(0.0)], "contact").advance(fast, 0, 1)
