"""The suite beside files of the user's that have the names of its packages."""

import os
import pydoc
import re
import subprocess
import sys
import zipfile
from pathlib import Path

import pytest

import multibody_xval

ROOT = Path(__file__).parents[1]
SHADOWS = ("engines", "scenarios", "reports", "reference_lcp")

SCRIPT = """\
from multibody_xval import check, report, sweep

if __name__ == "__main__":
    data = sweep(["reference", "mujoco:noslip_iterations=3"], 0.3, [0.8, 0.9], chain={"cells": 1}, workers=1)
    print(list(data.variant.values))
    print(int(data.transmittance_db.isnull().sum()), callable(check), callable(report))
"""


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    for name in SHADOWS:
        (tmp_path / f"{name}.py").write_text("raise SystemExit('the file of the working folder')\n")
    return tmp_path


def python(folder: Path, *arguments: str, **variables: str) -> subprocess.CompletedProcess[str]:
    command = [sys.executable, *arguments]
    environment = {**os.environ, **variables}
    return subprocess.run(command, capture_output=True, text=True, check=False, cwd=folder, env=environment)


@pytest.mark.slow
def test_three_functions_run_beside_files_with_the_names_of_the_packages(folder: Path) -> None:
    """Workers too: they are processes of their own."""
    (folder / "my.py").write_text(SCRIPT)
    done = python(folder, "my.py")
    assert done.returncode == 0, done.stderr
    variants, numbers = done.stdout.splitlines()
    assert "'mujoco:noslip_iterations=3'" in variants
    assert numbers == "0 True True"


@pytest.mark.slow
def test_a_study_of_a_graded_chain_takes_twenty_lines(tmp_path: Path) -> None:
    """That of the tutorial: sweep, figure, edges, stick and slip."""
    page = (ROOT / "docs/tutorials/own_chain.md").read_text(encoding="utf-8")
    (study,) = re.findall(r"```python\n(.*?)```", page, flags=re.DOTALL)
    assert len(study.splitlines()) <= 20
    (tmp_path / "study.py").write_text(study)
    done = python(tmp_path, "study.py", MPLBACKEND="agg")
    assert done.returncode == 0, done.stderr
    assert (tmp_path / "graded.pdf").read_bytes().startswith(b"%PDF")
    edges = [line.split() for line in done.stdout.splitlines() if line.endswith("agree")]
    assert [(row[1], row[2]) for row in edges] == [
        (engine, friction) for engine in ("reference", "mujoco") for friction in ("0.1", "0.3")
    ]
    assert [row[3] for row in edges[:2]] == [row[3] for row in edges[2:]], "MuJoCo tuned takes the reference's step"
    assert done.stdout.splitlines()[-1].startswith("<SteadyState −5.71")


def test_a_file_that_was_imported_before_is_named(folder: Path) -> None:
    (folder / "engines.py").write_text("mine = True\n")
    done = python(folder, "-c", "import engines; import multibody_xval")
    assert f"engines has been imported from {folder / 'engines.py'}" in done.stderr
    assert "import multibody_xval first" in done.stderr


def test_python_m_says_which_file_hides_a_package(folder: Path) -> None:
    (folder / "reference_lcp.py").unlink()
    (folder / "reports.py").unlink()
    done = python(folder, "-m", "reports", "run")
    assert done.returncode == 2
    assert done.stderr.startswith(f"error: {folder / 'engines.py'} hides the package engines of the suite; allowed: ")


def test_an_empty_folder_of_that_name_hides_nothing(tmp_path: Path) -> None:
    (tmp_path / "engines").mkdir()
    assert python(tmp_path, "-m", "reports", "run").returncode == 0


@pytest.mark.slow
def test_the_wheel_holds_the_facade(tmp_path: Path) -> None:
    """Built by the backend itself, unpacked, and imported from there, in a folder with files of those names."""
    build = "import sys; from hatchling.build import build_wheel; build_wheel(sys.argv[1])"
    built = python(ROOT, "-c", build, str(tmp_path))
    assert built.returncode == 0, built.stderr
    (wheel,) = tmp_path.glob("*.whl")
    unpacked, own = tmp_path / "unpacked", tmp_path / "own"
    own.mkdir()
    for name in SHADOWS:
        (own / f"{name}.py").write_text("raise SystemExit('the file of the working folder')\n")
    with zipfile.ZipFile(wheel) as archive:
        archive.extractall(unpacked)
    code = "import multibody_xval as x; print(x.__file__); print(x.sweep.__module__, x.report.__module__)"
    done = python(own, "-c", code, PYTHONPATH=str(unpacked))
    assert done.returncode == 0, done.stderr
    assert done.stdout.splitlines() == [str(unpacked / "multibody_xval/__init__.py"), "scenarios.functions reports"]


@pytest.mark.parametrize("name", multibody_xval.__all__)
def test_every_name_of_the_door_is_there_with_a_docstring(name: str) -> None:
    assert getattr(multibody_xval, name).__doc__


def test_help_of_a_sweep_fits_a_screen() -> None:
    assert len(pydoc.render_doc(multibody_xval.sweep, renderer=pydoc.plaintext).splitlines()) <= 45


def test_every_package_says_that_it_has_types() -> None:
    assert all((ROOT / name / "py.typed").is_file() for name in ("multibody_xval", *SHADOWS))
