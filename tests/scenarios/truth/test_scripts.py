"""Blocks in plain engines, as a newcomer builds them, judged by the problems."""

import subprocess
import sys

import pytest

from multibody_xval.scenarios.truth import judged, problem_named, read_motion
from multibody_xval.scenarios.truth.record import FOLDER


def found(folder, engine, kind, name, *options):
    """Run a script on a problem, without the suite; give what is judged."""
    words = [str(FOLDER / f"scripts/{engine}_blocks.py"), kind, str(FOLDER / f"problems/{name}.json"), *options]
    run = subprocess.run([sys.executable, *words], cwd=folder, capture_output=True, text=True, check=True)
    file, problem = folder / "motion.csv", problem_named(name)
    file.write_text(run.stdout)
    return judged(problem, read_motion(file, problem))


PASS = [
    *(("pybullet", name) for name in ("block-breaks-away", "slope-grid")),
    *(("rapier", name) for name in ("block-held", "block-stops")),
    ("sapien", "block-held"),
]


@pytest.mark.parametrize(("engine", "name"), [pytest.param(*own, marks=pytest.mark.needs(own[0])) for own in PASS])
def test_joints_of_plain_engines_pass(engine, name, tmp_path):
    assert (found(tmp_path, engine, "joint", name).verdict == "agrees").all()


@pytest.mark.needs("pinocchio")
def test_a_solver_that_stops_early_lets_a_joint_of_pinocchio_creep(tmp_path):
    early, exact = (found(tmp_path, "pinocchio", "joint", "block-held", *more).iloc[0] for more in ((), ("exact",)))
    assert (early.verdict, exact.verdict) == ("deviates", "agrees")
    assert early.velocity_off < 1e-6


@pytest.mark.needs("mujoco")
@pytest.mark.parametrize("options", [(), ("exact",)])
def test_a_joint_of_mujoco_creeps_as_its_impedance_says(options, tmp_path):
    block = found(tmp_path, "mujoco", "joint", "block-held", *options).iloc[0]
    assert (block.exact, block.motion, block.verdict) == ("held", "slid", "deviates")
    # A (1 − d_0)/d_0 · load · d_max τ / 2 with d_0 = 0.9, d_max = 0.95, τ = 0.02 s
    assert block.velocity_off == pytest.approx(0.5 * (0.1 / 0.9) * 1.5 * 0.95 * 0.02 / 2, rel=1e-6)


@pytest.mark.needs("mujoco")
def test_a_block_on_the_ground_stops_where_friction_has_spent_its_energy(tmp_path):
    block = found(tmp_path, "mujoco", "contact", "block-stops").iloc[0]
    assert block.position_off <= block.position_allowed
