"""``run figure3``, ``accuracy``, ``work-precision`` and ``friction-map``: tables, files, and when they fail."""

import csv
import math
from pathlib import Path

import pandas as pd
import pytest

from multibody_xval.reports.cli.console_script import app
from multibody_xval.reports.cli.ending import run_command
from multibody_xval.scenarios.model import EXACT, Case, Config, Result, Run, Status, failed
from multibody_xval.scenarios.ruler.exact_values import ruler
from multibody_xval.scenarios.ruler.proven import proven
from multibody_xval.scenarios.store import opened
from multibody_xval.scenarios.studies.claims import STATED, claim_cases
from multibody_xval.scenarios.studies.figure3 import exact_edges

TUNED = Config("mujoco")


def stored(path: Path, off: float = 0.0, lost: int = 0) -> Path:
    """Fill a store with exact values for the claims' points, of which those of an engine are off, and some are lost."""
    places = [(case, 400) for case in claim_cases()]
    own = [Run(TUNED, *place) for place in places]
    results = {run: failed("crashed") for run in own[:lost]}
    for run in [*own, *(run for run in ruler(places) if run.config != EXACT)]:
        factor = (1 + 1e-4 / run.steps) * (1 + off * (run.config == TUNED))
        numbers = {"transmittance": proven().get(run.case, 0j) * factor, "stuck": (0.5,) * 7}
        own_result = Result(status=Status.PERIODIC, residual=1e-10, amplification=1.0, periods=9, **numbers)
        results.setdefault(run, own_result)
    with opened(path) as store:
        store.add(results)
    return path


def figure3(store: Path, *options: str) -> int:
    return run_command(app, ["run", "figure3", "--no-run", f"--store={store}", f"--out={store.parent}", *options])


def test_figure_3_says_claims_verdicts_edges_and_the_finding_of_engines(tmp_path: Path, capsys) -> None:
    assert figure3(stored(tmp_path / "s.sqlite"), "--engine=mujoco") == 0
    printed, document = capsys.readouterr().out, (tmp_path / "figure3.md").read_text(encoding="utf-8")
    lines = printed.splitlines()
    assert max(map(len, lines)) <= 80
    assert len(lines) <= 48, "it fits one screen, with a long path"
    assert "judged numbers agree with the exact motion" in "".join(lines[-2:]), "the finding comes last"
    printed = " ".join(printed.split())
    for text in (
        "a: the band is wider than without friction",
        "With MuJoCo (tuned to the chain)",
        "Claims of the paper: a ",
    ):
        assert text in printed
        assert text in document
    assert "`multibody-xval run figure3 --engine=mujoco --out=" in document
    rows = list(csv.DictReader((tmp_path / "figure3.csv").read_text(encoding="utf-8").splitlines()))
    assert {(row["engine"], row["steps"]) for row in rows} == {("reference", "400"), ("mujoco", "400")}
    assert len([row for row in rows if row["engine"] == "mujoco"]) == len(claim_cases())
    assert [(tmp_path / f"figure3.{ending}").read_bytes()[:4] for ending in ("svg", "pdf")] == [b"<?xm", b"%PDF"]


def test_figure_3_is_the_reference_alone_unless_engines_are_named_and_says_what_is_assumed(
    tmp_path: Path, capsys
) -> None:
    assert figure3(stored(tmp_path / "s.sqlite", off=0.01)) == 0
    printed, table = capsys.readouterr().out, (tmp_path / "figure3.csv").read_text(encoding="utf-8")
    assert {row["engine"] for row in csv.DictReader(table.splitlines())} == {"reference"}
    assert "MuJoCo" not in printed
    printed = " ".join(printed.split())
    assert "Assumed: mass ratio 1, stiffness ratio 1, damping ratio 0.01" in printed
    for name, claim in STATED.items():
        assert f"{name}: {claim}: " in printed


def test_the_edges_of_the_reference_are_shown_in_order_with_their_bars() -> None:
    curves = [Case(friction_ratio=own, frequency_ratio=1.0) for own in (5.0, 0.3, 0.0)]
    places = {"exact": [1.17, 0.637, math.nan], "exact_bar": 3 * [4e-8], "frequency_ratio": 3 * [1.1], "error": 3 * [0]}
    found = pd.DataFrame({"engine": "reference", "formulation": "joint", "preset": "tuned", "edge": "lower", **places})
    shown = exact_edges(pd.concat([found.assign(curve=curves), found.assign(curve=curves, edge="upper")]))
    assert shown["friction ratio"].tolist() == ["0", "0.3", "5"]
    assert shown["exact motion"].tolist() == ["–", "0.6370000", "1.1700000"]
    assert shown["error bar"][1] == "4e-08"


def test_figure_3_fails_where_a_judged_number_deviates_or_too_many_are_lost(tmp_path: Path, capsys) -> None:
    assert figure3(stored(tmp_path / "off.sqlite", off=0.01), "--engine=mujoco") == 1
    assert "numbers deviate" in capsys.readouterr().out
    assert figure3(stored(tmp_path / "lost.sqlite", lost=60), "--engine=mujoco") == 1
    assert "60 of 180 numbers failed: crashed" in capsys.readouterr().out
    assert figure3(stored(tmp_path / "few.sqlite", lost=20), "--engine=mujoco") == 0


@pytest.mark.slow
def test_accuracy_and_work_of_the_reference_are_those_of_its_scheme(tmp_path: Path) -> None:
    """First order; below 0.01 dB at the six points."""
    out, speed, chart = tmp_path / "accuracy.csv", tmp_path / "speed.csv", tmp_path / "speed.png"
    assert run_command(app, ["run", "accuracy", "--engine", "reference:all:all", "--out", str(out)]) == 0
    (row,) = csv.DictReader(out.read_text().splitlines())
    assert float(row["six_400_db"]) < 0.01 < float(row["map_db"]) < 0.2
    assert 0.8 < float(row["order"]) < 1.3
    assert row["periodic"] == row["points"] == "68"
    words = ["--engine", "reference", "--steps=200", "--steps=100", f"--out={speed}", f"--out={chart}", "--workers=1"]
    assert run_command(app, ["run", "work-precision", *words]) == 0
    errors = [float(row["error_db"]) for row in csv.DictReader(speed.read_text().splitlines())][:2]
    assert 0 < errors[1] < 0.6 * errors[0], "the error falls with the step"
    assert chart.read_bytes().startswith(b"\x89PNG")


@pytest.mark.needs("rapier")
def test_friction_map_writes_every_speed_and_angle_and_a_figure(tmp_path: Path, capsys, monkeypatch) -> None:
    """Rapier's friction is μ N at all of them."""
    monkeypatch.setattr("multibody_xval.scenarios.catalogue.friction_map.SPEEDS", (1e-3, 0.1))
    outs = [tmp_path / f"map.{ending}" for ending in ("md", "csv", "svg")]
    assert run_command(app, ["run", "friction-map", "--engine=rapier", *(f"--out={out}" for out in outs)]) == 0
    assert "0.001 m/s" in capsys.readouterr().out
    assert [out.stat().st_size > 500 for out in outs] == 3 * [True]
    rows = list(csv.DictReader(outs[1].read_text(encoding="utf-8").splitlines()))
    assert len({(row["preset"], row["speed"], row["angle"]) for row in rows}) == len(rows) == 2 * 2 * 4
    assert max(abs(float(row["friction"])) for row in rows) < 1e-3
