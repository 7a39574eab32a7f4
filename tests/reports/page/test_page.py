"""The page: its sections, its files, and where its results may come from."""

import re
from pathlib import Path

import pandas as pd
import pytest

from multibody_xval.engines.mujoco import MuJoCo
from multibody_xval.reports import report
from multibody_xval.reports.page import tables
from multibody_xval.reports.page.drift import drift_runs
from multibody_xval.reports.page.sources import stored_page
from multibody_xval.reports.page.write import SECTIONS, write_page
from multibody_xval.scenarios.compute.batch import run_batch
from multibody_xval.scenarios.model import Result, Run
from multibody_xval.scenarios.report_plan import report_configs
from multibody_xval.scenarios.result_tables import now, points
from multibody_xval.scenarios.ruler.judge import judged
from multibody_xval.scenarios.store import Stored
from multibody_xval.scenarios.sweeps.dataset import dataset, write_dataset
from multibody_xval.scenarios.sweeps.file import sweep_of
from reference_lcp.errors import ParameterError
from tests.reports.conftest import SWEEP, kept


def test_every_section_and_every_file_that_the_page_names_is_there(stored: list[Stored], tmp_path: Path) -> None:
    write_page(stored, tmp_path, "multibody-xval report", left_out="Left out: nothing.")
    page = (tmp_path / "index.html").read_text(encoding="utf-8")
    found = re.findall(r'<section id="(\w+)"', page)
    assert found == ["headline", *SECTIONS]
    assert re.findall(r'<li><a href="#(\w+)"', page) == [*SECTIONS]
    assert "Figure 3" not in page, "its chain has seven cells"
    assert "Left out: nothing." in page
    names = re.findall(r'\sid="([^"]+)"', page)
    assert len(names) == len(set(names))
    named = set(re.findall(r'href="([\w/]+\.(?:csv|pdf))"', page))
    figures = {"headline", "transmittance", "errors", "edges", "stick_slip"}
    assert {f"figures/{name}.pdf" for name in figures} <= named
    assert [name for name in named if not (tmp_path / name).stat().st_size] == []
    assert len(pd.read_csv(tmp_path / "points.csv")) == sum(row.run.config.preset_name != "exact" for row in stored)


def test_the_first_screen_shows_the_drift_of_a_stack_and_what_to_paste(
    stored: list[Stored], stacks: list[Stored], tmp_path: Path
) -> None:
    """Three boxes creep by millimetres per second with MuJoCo's default options; the recipe's lines stop them."""
    assert [str(own.run.config) for own in stacks] == ["mujoco:contact:default", "mujoco:contact:recommended"]
    write_page([*stored, *stacks], tmp_path, "report")
    (row,) = pd.read_csv(tmp_path / "drift.csv", thousands=",").to_dict("records")
    assert row["engine"] == "MuJoCo"
    assert row["exact"] == 0
    assert row["default options"] > 1000
    assert row["recipe"] < 1
    first = (tmp_path / "index.html").read_text(encoding="utf-8").partition('<section id="transmittance"')[0]
    assert "impratio=&#34;10000&#34;" in first
    assert "Boxes that should rest creep at up to 7," in first
    assert " µm/s with the recipe (MuJoCo)." in first


def test_a_report_is_made_where_an_engine_is_absent(monkeypatch) -> None:
    """All engines are those that are installed; one that comes with the suite and is absent lacks its drift alone."""
    monkeypatch.setattr(MuJoCo, "unavailable_reason", lambda _: "no wheel")
    assert "mujoco" not in {own.engine for own in report_configs(["all"])}
    usual = report_configs()
    assert "mujoco" in {own.engine for own in usual}
    assert "mujoco" not in {run.config.engine for run in drift_runs(usual)}


def test_stores_of_two_environments_make_one_page(results: dict[Run, Result], tmp_path: Path) -> None:
    names = ("reference", "mujoco")
    files = [
        kept({run: own for run, own in results.items() if (run.config.engine == "mujoco") == (name == "mujoco")},
             tmp_path / f"{name}.sqlite")
        for name in names
    ]  # fmt: skip
    written = stored_page(files, tmp_path / "out", "report --no-run")
    assert written.failures == []
    assert set(pd.read_csv(tmp_path / "out" / "errors.csv").configuration) >= {"mujoco:joint:tuned"}
    with pytest.raises(ParameterError, match="shows more than the stores hold: of mujoco:joint:"):
        stored_page(files[:1], tmp_path / "out", "report --no-run")
    with pytest.raises(ParameterError, match=r"engine = mujoco has no results in .*; allowed: of "):
        stored_page(files[:1], tmp_path / "other", "report --no-run", ["mujoco"])


def test_a_dataset_makes_a_page_without_edges(stored: list[Stored], tmp_path: Path) -> None:
    data = dataset(sweep_of(SWEEP), judged(points(stored)))
    page = report(data, tmp_path / "own").read_text()
    assert 'id="edges"' not in page
    assert "agrees with the exact motion in all 3 simulations" in page
    write_dataset(data, tmp_path / "own.nc")
    again = report(tmp_path / "own.nc", tmp_path / "again").read_text()
    same = [text.partition("<p>Command:")[0] for text in (page, again)]
    assert same[0] == same[1]


def test_a_chain_that_a_force_drives_has_newton_on_the_page_and_in_its_files(tmp_path: Path) -> None:
    """Its amplitude is in newton wherever people read it, and nothing is over U0."""
    sweep = sweep_of({
        "engines": ["reference", "mujoco"], "grid": {"friction_ratio": [0.3], "frequency_ratio": [0.9]},
        "chain": {"cells": 2}, "drive": {"kind": "force", "amplitude": 0.3},
    })  # fmt: skip
    stored = now({run: run_batch([run])[0] for run in sweep.runs()})
    assert tables.place(sweep.places[0].case) == "friction ratio 0.3, cells 2, drive force, amplitude 0.3 N"
    write_page(stored, tmp_path, "report")
    page = (tmp_path / "index.html").read_text(encoding="utf-8")
    assert "Amplitude of the last mass over P0 / k_c, " in page
    assert "displacement" not in page
    write_dataset(dataset(sweep, judged(points(stored))), tmp_path / "own.csv")
    for name in ("points", "transitions", "own"):
        table = pd.read_csv(tmp_path / f"{name}.csv")
        assert (set(table.amplitude), set(table.amplitude_unit)) == ({0.3}, {"N"})
        assert "displacement" not in table
