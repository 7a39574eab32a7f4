"""Genesis: what only its softness and its recipe do; what it shares with other worlds is in `test_worlds.py`."""

import math

import numpy as np
import pytest

from multibody_xval.engines.interface.registry import engine
from multibody_xval.engines.interface.scene import ArmScene, ContactScene, JointScene, Scene
from reference_lcp.chain.drives import StillBase
from reference_lcp.chain.simulation import Lane
from reference_lcp.chain.trajectory import State
from tests.engines.scheme_oracle import AMPLITUDE, lane_of, run

pytestmark = pytest.mark.needs("genesis")


@pytest.mark.parametrize(
    ("time_step", "left"),
    [(1e-3, 1 - 1e-3 * 2 * 0.9 / (0.95 * 0.01)), (8e-3, 1 - 0.9 / 0.95)],
    ids=["time constant of its own", "time constant of two steps"],
)
def test_default_joint_leaves_a_stick_the_part_of_its_slip_that_a_time_constant_leaves(time_step, left) -> None:
    chain = lane_of(50.0, cells=1, damping_ratio=0.0, inner_damping_ratio=0.0).chain
    slipping = State(np.zeros((1, 2)), np.array([[0.0, 1e-3]]))
    after = run("genesis:joint:default", Lane(chain, StillBase(AMPLITUDE), time_step), slipping, 1)
    assert after.relative_velocity[0, 0] == pytest.approx(1e-3 * left, rel=1e-8)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("scene", "most"),
    [(ContactScene(slope=math.atan(0.45)), 0.5), (JointScene(load=0.9), 1.0), (ArmScene(friction=(1.09,)), 10.0)],
    ids=["slope", "hinge", "arm"],
)
def test_recipe_holds_what_creeps_with_default_options_by_a_hundred_times_as_much(scene: Scene, most: float) -> None:
    def creep(preset: str) -> float:
        world = engine("genesis").scene_with(scene, preset, engine("genesis").scene_step, sleeping=False)
        rows = world.run(300)
        world.close()
        return 1e6 * float(np.linalg.norm(rows[-1, :3] - rows[100, :3])) / 2

    assert creep("recommended") < most
    assert creep("default") > 100 * most
