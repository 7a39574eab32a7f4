"""Joints that are thrown: the exact stop, engines that are wrong by little, and what MuJoCo and PyBullet make of it."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pandas as pd
import pytest
from scipy.integrate import solve_ivp

from multibody_xval.reports.reproducers.recipe import recipe_text
from multibody_xval.scenarios.catalogue.numbers import numbers
from multibody_xval.scenarios.catalogue.scenes.stopping_joints import JOINT_STOP, exact_stop
from multibody_xval.scenarios.compute.batch import run_batch
from multibody_xval.scenarios.model import Config
from multibody_xval.scenarios.ruler.judge import DEVIATES
from multibody_xval.scenarios.store import Stored
from tests.scenarios.point_mass import Wrong, point_mass_numbers

EVERY = {**JOINT_STOP.cases, **JOINT_STOP.held_out}

NOSLIP = Path(__file__).parents[2] / "reports" / "cli" / "probe_models" / "spin_noslip.xml"
"""A hinge of 1.96e-3 kg m² with damping 50, friction 5 and noslip_iterations 10, thrown with 20 rad/s."""


def measured(*configs: str, cases=JOINT_STOP.cases) -> pd.DataFrame:
    """Run cases in this process, a row a case at the engine's own time step, a column a configuration: how late."""
    scenario = replace(JOINT_STOP, cases=cases)
    runs = [run for name in configs for run in scenario.own_runs(Config.parse(name)).values()]
    table = numbers(scenario, [Stored(run, "1", run_batch([run])[0]) for run in runs])
    own = table[table.case.str.endswith("own step") & (table.quantity == "late")]
    return own.pivot(index="case", columns="configuration", values="value").rename(lambda case: case.rpartition(",")[0])


@pytest.mark.parametrize("name", EVERY)
def test_exact_stop_is_that_of_the_equation_of_motion(name) -> None:
    joint = EVERY[name].scene

    def motion(_time, state):
        return state[1], -joint.damping * state[1] - joint.friction

    def rests(_time, state):
        return state[1]

    rests.terminal = True
    time, way = exact_stop(joint)
    limits = {"rtol": 1e-12, "atol": 1e-14 * way, "method": "DOP853"}
    found = solve_ivp(motion, (0, 2 * time), (0, joint.velocity), events=rests, **limits)
    assert (found.t_events[0][0], found.y_events[0][0][0]) == pytest.approx((time, way), rel=1e-9)


@pytest.mark.parametrize(
    ("wrong", "case"),
    [
        (Wrong(friction=0.99), "no damping, 0.8 s, 1 ms"),
        (Wrong(friction=1.01), "no damping, 0.8 s, 1 ms"),
        (Wrong(damping=0.95), "damped, 0.22 s, 1 ms"),
        (Wrong(damping=1.05), "damped, 0.22 s, 1 ms"),
        (Wrong(friction=0.0), "damped, 7.4 ms, own step"),
        (Wrong(drift=2e-3), "damped, 0.21 ms, own step"),
    ],
)
def test_friction_or_damping_that_is_wrong_by_little_is_found(wrong, case) -> None:
    table = point_mass_numbers(JOINT_STOP, wrong)
    assert DEVIATES in set(table.verdict[table.case == case])


@pytest.mark.needs("mujoco")
def test_mujoco_stops_a_joint_with_damping_late_later_with_noslip_and_in_two_steps_with_the_recipe() -> None:
    default, noslip, recipe = configs = [
        "mujoco:joint:default", "mujoco:joint:default:noslip_iterations=10", "mujoco:joint:recommended",
    ]  # fmt: skip
    late = measured(*configs, cases=EVERY)
    heavy = late.loc["damped, 0.21 ms"]
    assert heavy[[default, noslip]].tolist() == pytest.approx([91.8, 2233.8], abs=0.1)
    assert (late[default] > 40).all()
    assert late[recipe].max() < 5


@pytest.mark.needs("mujoco")
@pytest.mark.parametrize(
    ("old", "new", "time"),
    [("", "", 0.004), ("model.dof_so", "# ", 0.092), ("model.dof_damping", "0 * model.dof_damping", 0.478)],
)
def test_recipe_that_is_pasted_stops_a_joint_with_damping(old, new, time) -> None:
    """Without the line of joints it stops as late as before, and with one that does not know of damping, later."""
    import mujoco

    model = mujoco.MjModel.from_xml_path(str(NOSLIP))
    model.opt.noslip_iterations = 0
    text = recipe_text("mujoco").replace(old, new)
    lines = [own for line in text.splitlines() if (own := line.strip()).startswith("model.")]
    exec("\n".join(lines), {"model": model, "mujoco": mujoco})
    data = mujoco.MjData(model)
    data.qvel[0] = 20
    while abs(data.qvel[0]) >= 1e-3:
        mujoco.mj_step(model, data)
    assert data.time == pytest.approx(time, abs=1e-9)


@pytest.mark.needs("pybullet")
def test_friction_of_a_urdf_stops_no_joint_in_pybullet_and_a_motor_does() -> None:
    late = measured("pybullet:joint:default", "pybullet:joint:recommended")
    assert late.loc["no damping, 0.8 s"].tolist() == [np.inf, pytest.approx(0, abs=1)]
    assert late.loc["damped, 0.22 s"].tolist() == [pytest.approx(739, abs=1), pytest.approx(-3, abs=1)]


@pytest.mark.needs("sapien")
def test_recipe_of_sapien_leaves_no_damping_of_links_that_turn() -> None:
    late = measured("sapien:joint:default", "sapien:joint:recommended", cases={"hinge": EVERY["no damping, 0.8 s"]})
    assert late.loc["hinge"].tolist() == pytest.approx([-10, 0], abs=1e-6)
