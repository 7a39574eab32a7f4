"""A chain that a force drives: its amplitude is in newton wherever people read it, and nothing is over U0."""

from pathlib import Path

import pandas as pd
import pytest

from multibody_xval.reports.page import tables
from multibody_xval.reports.page.write import write_page
from multibody_xval.scenarios.compute.batch import run_batch
from multibody_xval.scenarios.result_tables import now, points
from multibody_xval.scenarios.ruler.judge import judged
from multibody_xval.scenarios.store import Stored
from multibody_xval.scenarios.sweeps.dataset import dataset, write_dataset
from multibody_xval.scenarios.sweeps.file import sweep_of

SWEEP = sweep_of({
    "engines": ["reference", "mujoco"], "grid": {"friction_ratio": [0.3], "frequency_ratio": [0.9]},
    "chain": {"cells": 2}, "drive": {"kind": "force", "amplitude": 0.3},
})  # fmt: skip


@pytest.fixture(scope="module")
def stored() -> list[Stored]:
    return now({run: run_batch([run])[0] for run in SWEEP.runs()})


def test_a_page_and_its_files_have_newton(stored: list[Stored], tmp_path: Path) -> None:
    assert tables.place(SWEEP.places[0].case) == "friction ratio 0.3, cells 2, drive force, amplitude 0.3 N"
    write_page(stored, tmp_path, "report")
    page = (tmp_path / "index.html").read_text(encoding="utf-8")
    assert "Amplitude of the last mass over P0 / k_c, " in page
    assert "displacement" not in page
    write_dataset(dataset(SWEEP, judged(points(stored))), tmp_path / "own.csv")
    for name in ("points", "transitions", "own"):
        table = pd.read_csv(tmp_path / f"{name}.csv")
        assert (set(table.amplitude), set(table.amplitude_unit)) == ({0.3}, {"N"})
        assert "displacement" not in table
