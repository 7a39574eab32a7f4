"""Versions of an engine as variants of a run: results apart, crashes and hangs their own, missing ones refused."""

import os
import re
from contextlib import suppress
from pathlib import Path

import numpy as np
import pytest

from engines.interface.variant import Variant
from reference_lcp.errors import ParameterError
from reference_lcp.process import run_command
from reports import report
from reports.cli.console_script import app
from scenarios.functions import check, sweep
from scenarios.runs.evaluator import Evaluator
from scenarios.runs.local_processes import LocalExecutor
from tests.scenarios.runs.builders import steady

BESIDE, OWN, CRASHES, HANGS = (Variant(f"mujoco{version}") for version in ("", "@3.99.0", "@3.97.0", "@3.96.0"))

LIMIT = 8.0
"""Seconds that a batch may take."""

pytestmark = pytest.mark.usefixtures("installed_versions")


def test_results_of_a_version_are_its_own() -> None:
    keys = {steady(variant=variant, cells=1).key() for variant in (BESIDE, OWN, CRASHES)}
    assert len(keys) == 3
    assert '"version":"3.99.0"' in steady(variant=OWN, cells=1).text()


@pytest.mark.slow  # waits for processes
def test_a_version_that_crashes_or_hangs_dies_alone_and_says_where(store) -> None:
    with Evaluator(store, LocalExecutor(2, LIMIT)) as evaluator:
        tasks = [steady(variant=variant, cells=1) for variant in (BESIDE, OWN, CRASHES, HANGS)]
        beside, own, crashed, hung = evaluator.evaluate(tasks)
    assert own.converged
    assert own.transmittance_db == beside.transmittance_db
    assert re.search(r"mujoco@3\.97\.0 crashed with signal 11 \(SIGSEGV\) during 'build', in string_at", crashed.reason)
    assert hung.reason.startswith(f"stopped at the time limit of {LIMIT:g} s")
    assert not processes_of("mujoco@")


def processes_of(part: str) -> list[str]:
    """Processes of this user whose command holds a text."""
    commands = []
    for file in Path("/proc").glob("[0-9]*/cmdline"):
        with suppress(OSError):
            commands.append(file.read_text(errors="replace"))
    return [
        command for command in commands if part in command and str(os.environ["MULTIBODY_XVAL_ENVIRONMENTS"]) in command
    ]


MISSING = (
    r"'mujoco@3\.98\.0' cannot be used: its environment is not installed; multibody-xval engines install "
    r"mujoco@3\.98\.0"
)


@pytest.mark.parametrize(
    ("command", "engine"),
    [("unit-cell", "mujoco@3.98.0"), ("cost", "mujoco@3.98.0:joint:default"), ("accuracy", "mujoco@3.98.0")],
)
def test_a_command_that_names_a_missing_version_ends_with_the_command_that_installs_it(
    command: str, engine: str, capsys: pytest.CaptureFixture[str]
) -> None:
    assert run_command(app, ["run", command, "--engine", engine]) == 2
    assert re.fullmatch(f"error: engine = {MISSING}\n", capsys.readouterr().err)


def test_a_sweep_file_that_names_a_missing_version_is_refused(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    file = tmp_path / "sweep.toml"
    file.write_text('engines = ["mujoco@3.98.0"]\n[grid]\nfriction_ratio = [0.3]\nfrequency_ratio = [0.9]\n')
    assert run_command(app, ["sweep", str(file), "--out", str(tmp_path / "out.nc")]) == 2
    assert re.search(MISSING, capsys.readouterr().err)


@pytest.mark.slow
def test_functions_take_versions_and_name_missing_ones() -> None:
    with pytest.raises(ParameterError, match=MISSING):
        sweep(["mujoco@3.98.0"], 0.3, 0.9)
    with pytest.raises(ParameterError, match=MISSING):
        check("unit-cell", ["mujoco@3.98.0"])
    data = sweep(["mujoco@3.99.0", "mujoco"], 0.3, 0.9, chain={"cells": 1}, workers=1)
    assert data["variant"].values.tolist() == ["mujoco@3.99.0", "mujoco"]
    assert np.ptp(data["transmittance_db"].values) == 0


@pytest.mark.slow
def test_a_dataset_of_a_version_that_is_not_there_is_read(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    data = sweep(["reference", "mujoco@3.99.0"], 0.3, [0.5, 0.9], chain={"cells": 1}, workers=1)
    monkeypatch.setenv("MULTIBODY_XVAL_ENVIRONMENTS", str(tmp_path / "none"))
    report(data, tmp_path / "page")
    assert "MuJoCo 3.99.0" in (tmp_path / "page" / "index.html").read_text()
