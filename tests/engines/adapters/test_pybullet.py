"""PyBullet: what only its motors, its contacts and its limits do."""

from pathlib import Path

import numpy as np
import pytest

from multibody_xval.engines.pybullet import PyBullet
from multibody_xval.engines.pybullet.joint import import_pybullet
from reference_lcp.chain.drives import HarmonicBase
from reference_lcp.chain.mass_in_mass import Chain
from reference_lcp.chain.simulation import Lane
from reference_lcp.chain.trajectory import State, Trajectory
from reference_lcp.errors import ParameterError
from tests.engines.scheme_oracle import (
    AMPLITUDE,
    STEPS,
    assert_equals_scheme,
    built_with,
    lane_of,
    with_coefficients,
)

pytestmark = pytest.mark.needs("pybullet")


def run(lane: Lane, state: State, steps: int, formulation: str = "joint") -> Trajectory:
    return PyBullet().build([lane], formulation).run(state, 0, steps)[0]


def test_the_longest_chain_equals_the_scheme_and_a_longer_one_is_refused() -> None:
    chain = Chain.from_ratios(cells=63, friction_ratio=0.3)
    lane = Lane.periodic(chain, HarmonicBase.from_ratio(chain, 0.6, AMPLITUDE), STEPS)
    assert_equals_scheme(lane, State.at_rest(1, 63), run(lane, State.at_rest(1, 63), 100))
    longer = Chain.from_ratios(cells=64)
    with pytest.raises(ParameterError, match=r"cells = 64 .* at most 63"):
        PyBullet().build([Lane(longer, lane.drive, lane.time_step)])


def with_option(name: str, value: float) -> Trajectory:
    """A period from rest, in the joint, with one tuned option changed."""
    return built_with(PyBullet(), lane_of(), **{name: value}).run(State.at_rest(1, 7), 0, STEPS)[0]


def test_the_motor_that_a_joint_is_born_with_would_freeze_the_chain() -> None:
    assert np.max(np.abs(with_option("outer motor force", 1e6).positions)) < 1e-6 * AMPLITUDE
    assert np.max(np.abs(with_option("outer motor force", 0.0).positions)) > 0.5 * AMPLITUDE


def test_damping_of_bodies_in_the_units_of_the_lane_would_stop_the_chain() -> None:
    """It is a rate: 0.04 in a second is another one in a time step."""
    assert np.max(np.abs(with_option("linearDamping", 0.04).positions)) < 0.5 * AMPLITUDE


def test_a_weak_gain_of_a_motor_is_not_coulomb_friction() -> None:
    """With 0.1 a motor leaves nine tenths of the relative velocity."""
    simulation = built_with(PyBullet(), lane_of(5.0, 0.3), velocityGain=0.1)
    trajectory = simulation.run(State.at_rest(1, 7), 0, STEPS)[0]
    assert np.max(np.abs(trajectory.relative_velocity)) > 1e-6 * AMPLITUDE


def test_the_reason_for_a_missing_package_names_the_python_versions(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("multibody_xval.engines.shared.pip_engine.importlib.util.find_spec", lambda _: None)
    reason = PyBullet().unavailable_reason()
    assert reason is not None
    assert "CPython 3.11" in reason


def test_coefficients_that_bullet_would_cut_off_are_refused() -> None:
    with pytest.raises(ParameterError, match=r"friction_coefficient = 11; allowed by Bullet: at most 10"):
        PyBullet().build([with_coefficients(11.0)], "contact")


LINK = """\
<robot name="arm"><link name="base"/>
<link name="link"><inertial><origin xyz="0.1 0 0"/><mass value="1"/>
<inertia ixx="0.01" iyy="0.01" izz="0.01" ixy="0" ixz="0" iyz="0"/></inertial></link>
<joint name="hinge" type="continuous"><parent link="base"/><child link="link"/><axis xyz="0 1 0"/>
<dynamics friction="{friction}"/></joint></robot>
"""
"""A link that gravity loads with 0.98 N m."""


def angle_after_a_second(file: Path, friction: float, *, motor: bool) -> float:
    """Angle of the link [rad], with the motor that its joint is loaded with, or without."""
    bullet = import_pybullet()
    file.write_text(LINK.format(friction=friction), encoding="utf-8")
    client = bullet.connect(bullet.DIRECT)
    try:
        bullet.setGravity(0, 0, -9.81, physicsClientId=client)
        robot = bullet.loadURDF(str(file), useFixedBase=True, physicsClientId=client)
        if not motor:
            bullet.setJointMotorControl2(robot, 0, bullet.VELOCITY_CONTROL, force=0, physicsClientId=client)
        for _ in range(240):
            bullet.stepSimulation(physicsClientId=client)
        return float(bullet.getJointState(robot, 0, physicsClientId=client)[0])
    finally:
        bullet.disconnect(client)


def test_what_holds_a_link_is_no_part_of_its_urdf_file(tmp_path: Path) -> None:
    """So there is no probe of such files: its numbers would be those of the motors that it sets."""
    file = tmp_path / "link.urdf"
    held, free = ([angle_after_a_second(file, own, motor=motor) for own in (0.0, 1.1, 6.0)] for motor in (True, False))
    assert held == [0.0] * 3
    assert free == [pytest.approx(2.4721, abs=1e-4)] * 3
    assert len(set(free)) == 1
