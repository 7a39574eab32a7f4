"""Runners for other projects pass with their example engines and fail with broken twins; blocks in plain engines."""

import os
import shutil
import subprocess
import sys
from collections.abc import Iterable
from pathlib import Path

import pytest

from multibody_xval.scenarios.truth import judged, problem_named, problems, read_motion
from multibody_xval.scenarios.truth.record import FOLDER

RUNNERS = FOLDER / "runners"
FILES = sorted((FOLDER / "problems").glob("*.json"))

LANGUAGES = {
    "python": ("py", None),
    "c++": ("cpp", ["g++", "-std=c++17", "-O2", "-Wall", "-Wextra", "-Werror", "example.cpp", "-o", "example"]),
    "rust": ("rs", ["rustc", "-O", "-D", "warnings", "example.rs"]),
}
"""Ending of each language's files, and what compiles them."""

SLIDING = [name for name in problems() if name not in ("block-held", "chain-frictionless", "chain-locked")]
"""Problems in which a contact slides."""


def example(language: str, folder: Path, files: Iterable[Path], change: tuple[str, str] = ("", "")):
    """Run a copy of a runner with its example engine on files; a text of the engine is changed."""
    ending, compiler = LANGUAGES[language]
    if compiler and not shutil.which(compiler[0]):
        (pytest.fail if os.environ.get("CI") else pytest.skip)(f"{compiler[0]} is not installed")
    for file in RUNNERS.glob("*.*"):
        shutil.copy(file, folder)
    text = (folder / f"example.{ending}").read_text()
    assert not change[0] or text.count(change[0]) == 1
    (folder / f"example.{ending}").write_text(text.replace(*change))
    if compiler:
        subprocess.run(compiler, cwd=folder, check=True, capture_output=True, text=True)
    command = ["./example"] if compiler else [sys.executable, "example.py"]
    return subprocess.run([*command, *map(str, files)], cwd=folder, capture_output=True, text=True, check=False)


every_language = pytest.mark.parametrize(
    "language",
    [pytest.param(name, marks=[pytest.mark.slow] if compiler else []) for name, (_, compiler) in LANGUAGES.items()],
)
"""Compilers take a second; what they compile fails by default where friction is wrong."""


@pytest.mark.slow
@pytest.mark.parametrize("language", LANGUAGES)
def test_the_example_engine_passes_every_problem(language, tmp_path):
    run = example(language, tmp_path, FILES)
    assert run.returncode == 0, run.stderr
    lines = run.stdout.splitlines()
    assert len(lines) == len(problems())
    assert all(line.startswith("ok") for line in lines)


@pytest.mark.parametrize("language", LANGUAGES)
def test_ten_percent_more_friction_fail_wherever_something_slides(language, tmp_path):
    normal = {"python": "normal = h *", "c++": "normal = h *", "rust": "c2[i], h *"}[language]
    run = example(language, tmp_path, FILES, (normal, normal.replace("h *", "1.1 * h *")))
    assert run.returncode == 1
    failed = [Path(line.split()[1].rstrip(":")).stem for line in run.stdout.splitlines() if line.startswith("FAILED")]
    assert failed == SLIDING


@every_language
def test_creep_of_a_micrometre_a_second_fails(language, tmp_path):
    change = {
        "python": ("np.where(held, wanted,", "np.where(held, wanted + 1e-6 / (w[c1] + w[c2]),"),
        "c++": ("held ? wanted :", "held ? wanted + 1e-6 / (w[c1[i]] + w[c2[i]]) :"),
        "rust": ("if held { wanted }", "if held { wanted + 1e-6 / (w[a] + w[b]) }"),
    }[language]
    run = example(language, tmp_path, [FOLDER / "problems" / "block-held.json"], change)
    assert run.returncode == 1
    assert run.stdout.startswith("FAILED")


def found(folder, engine, kind, name):
    """Run a script on a problem, without the suite; give what is judged."""
    words = [str(FOLDER / f"scripts/{engine}_blocks.py"), kind, str(FOLDER / f"problems/{name}.json")]
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


@pytest.mark.needs("mujoco")
def test_a_joint_of_mujoco_creeps_as_its_impedance_says_and_a_block_on_the_ground_stops(tmp_path):
    block = found(tmp_path, "mujoco", "joint", "block-held").iloc[0]
    assert (block.exact, block.motion, block.verdict) == ("held", "slid", "deviates")
    # A (1 − d_0)/d_0 · load · d_max τ / 2 with d_0 = 0.9, d_max = 0.95, τ = 0.02 s
    assert block.velocity_off == pytest.approx(0.5 * (0.1 / 0.9) * 1.5 * 0.95 * 0.02 / 2, rel=1e-6)
    block = found(tmp_path, "mujoco", "contact", "block-stops").iloc[0]
    assert block.position_off <= block.position_allowed
