"""The suite as users have it: two packages, beside folders of theirs that are called ``engines`` or ``reports``."""

import os
import re
import subprocess
import sys
import venv
import zipfile
from itertools import product
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[1]
PACKAGES = {"multibody_xval", "reference_lcp"}
ROOMS = ("engines", "scenarios", "reports")
FOREIGN = (*ROOMS, "truth", "tests")
"""What a project of a user may well have of its own."""

OWN_TEST = """\
import importlib
from pathlib import Path

import pytest

from multibody_xval import sweep


@pytest.mark.parametrize("name", ["engines", "scenarios", "reports", "truth"])
def test_own_packages_are_those_of_this_folder(name):
    assert Path(importlib.import_module(name).__file__).parents[1] == Path(__file__).parents[1]


def test_the_suite_works_beside_them_in_its_processes_too():
    data = sweep(["reference", "mujoco:noslip_iterations=3"], 0.3, [0.8, 0.9], chain={"cells": 1}, workers=1)
    assert "mujoco:noslip_iterations=3" in data.configuration.values
    assert not data.transmittance_db.isnull().any()
"""


def python(folder: Path, *arguments: str, **variables: str) -> subprocess.CompletedProcess[str]:
    command = [sys.executable, *arguments]
    environment = {**os.environ, **variables}
    return subprocess.run(command, capture_output=True, text=True, check=False, cwd=folder, env=environment)


BUILD = "import sys; from hatchling.build import build_wheel; build_wheel(sys.argv[1])"


@pytest.mark.slow
def test_a_project_with_folders_of_these_names_is_tested_beside_the_wheel_of_two_packages(tmp_path: Path) -> None:
    """It is built by the backend itself, and has every module once."""
    assert python(ROOT, "-c", BUILD, str(tmp_path / "built")).returncode == 0
    (wheel,) = (tmp_path / "built").iterdir()
    with zipfile.ZipFile(wheel) as archive:
        files = {name for name in archive.namelist() if ".dist-info/" not in name}
    assert {name.split("/")[0] for name in files} == PACKAGES
    of_rooms = {f"multibody_xval/{file.relative_to(ROOT)}" for room in ROOMS for file in (ROOT / room).rglob("*.py")}
    others = {str(file.relative_to(ROOT)) for file in (ROOT / "reference_lcp").rglob("*.py")}
    doors = {f"multibody_xval/{file.name}" for file in (ROOT / "multibody_xval").glob("*.py")}
    assert {name for name in files if name.endswith(".py")} == of_rooms | others | doors
    venv.create(tmp_path / "environment", with_pip=False)
    (packages,) = (tmp_path / "environment/lib").glob("python*/site-packages")
    own = str(ROOT)  # of an editable installation: the suite is that of the wheel, and no checkout is found
    shared = [path for path in sys.path if path.endswith(("site-packages", "dist-packages")) and path != own]
    (packages / "shared.pth").write_text("\n".join(shared))
    project = tmp_path / "project"
    for name in FOREIGN:
        (project / name).mkdir(parents=True)
        (project / name / "__init__.py").write_text('"""Of the user."""\n')
    (project / "tests/test_own.py").write_text(OWN_TEST)
    variables = {name: value for name, value in os.environ.items() if name not in ("PYTHONPATH", "VIRTUAL_ENV")}

    def own_python(*arguments: str) -> str:
        done = subprocess.run(
            [tmp_path / "environment/bin/python", "-m", *arguments],
            capture_output=True, text=True, check=False, cwd=project, env=variables,
        )  # fmt: skip
        assert done.returncode == 0, done.stdout + done.stderr
        return done.stdout

    own_python("pip", "install", "--quiet", "--no-deps", "--no-index", "--disable-pip-version-check", str(wheel))
    assert "5 passed" in own_python("pytest", "-q", "-p", "no:cacheprovider")


def test_the_door_imports_nothing_before_a_name_is_used_and_a_room_not_by_its_bare_name() -> None:
    """A module that is imported under two names has two registries of engines."""
    code = "import sys, multibody_xval; print(*(name for name in sys.modules if name.split('.')[0] in sys.argv[1:]))"
    done = python(ROOT, "-c", f"{code}; import engines", *PACKAGES, "numpy")
    assert done.stdout.split() == ["multibody_xval"]
    expected = "ImportError: engines is a folder of the suite, and no package; allowed: multibody_xval.engines"
    assert expected in done.stderr


@pytest.mark.slow
def test_a_study_of_a_graded_chain_takes_twenty_lines(tmp_path: Path) -> None:
    """That of the tutorial: sweep, figure, edges, stick and slip."""
    page = (ROOT / "docs/how_to/chains_and_sweeps.md").read_text(encoding="utf-8")
    study = re.search(r"## A study in twenty lines\n.*?```python\n(.*?)```", page, flags=re.DOTALL)[1]
    assert len(study.splitlines()) <= 20
    done = python(tmp_path, "-c", study, MPLBACKEND="agg")
    assert done.returncode == 0, done.stderr
    assert (tmp_path / "graded.pdf").read_bytes().startswith(b"%PDF")
    edges = [line.split() for line in done.stdout.splitlines() if line.endswith("agrees")]
    assert [(row[1], row[2]) for row in edges] == list(product(("0.1", "0.3"), ("reference", "mujoco")))
