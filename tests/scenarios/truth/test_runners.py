"""Runners that are copied into other projects: each passes with its example engine, and a broken twin fails."""

import os
import shutil
import subprocess
import sys
from collections.abc import Iterable
from pathlib import Path

import pytest

from multibody_xval.scenarios.truth import problems
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


def judged(language: str, folder: Path, files: Iterable[Path], change: tuple[str, str] | None = None):
    """Run a copy of a runner with its example engine on files; a text of the engine is changed."""
    ending, compiler = LANGUAGES[language]
    if compiler and not shutil.which(compiler[0]):
        (pytest.fail if os.environ.get("CI") else pytest.skip)(f"{compiler[0]} is not installed")
    for file in RUNNERS.glob("*.*"):
        shutil.copy(file, folder)
    if change:
        example = folder / f"example.{ending}"
        text = example.read_text()
        assert text.count(change[0]) == 1
        example.write_text(text.replace(*change))
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
    run = judged(language, tmp_path, FILES)
    assert run.returncode == 0, run.stderr
    lines = run.stdout.splitlines()
    assert len(lines) == len(problems())
    assert all(line.startswith("ok") for line in lines)


@pytest.mark.parametrize("language", LANGUAGES)
def test_ten_percent_more_friction_fail_wherever_something_slides(language, tmp_path):
    normal = {"python": "normal = h *", "c++": "normal = h *", "rust": "c2[i], h *"}[language]
    run = judged(language, tmp_path, FILES, (normal, normal.replace("h *", "1.1 * h *")))
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
    run = judged(language, tmp_path, [FOLDER / "problems" / "block-held.json"], change)
    assert run.returncode == 1
    assert run.stdout.startswith("FAILED")
