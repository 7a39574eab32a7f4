"""``multibody-xval compare``: what is printed and written, and how it ends."""

import json
import re
from pathlib import Path

import pandas as pd
import pytest

from multibody_xval.reports.changes import Comparison, markdown
from multibody_xval.reports.cli.console_script import app
from multibody_xval.reports.cli.ending import run_command
from multibody_xval.reports.cli.exit_code import ExitCode
from multibody_xval.scenarios.compare.stores import compare
from multibody_xval.scenarios.model import failed
from tests.scenarios.stores import CASE, OTHER, with_bound, write_store

BEFORE = {CASE: with_bound(1.01), OTHER: with_bound(1.05, OTHER)}
WORSE = {CASE: with_bound(1.05), OTHER: BEFORE[OTHER]}
BETTER = {CASE: BEFORE[CASE], OTHER: with_bound(1.01, OTHER)}


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """Stores of versions of an engine: before, worse, better, and one that crashes."""
    monkeypatch.chdir(tmp_path)
    write_store(tmp_path / "before.sqlite", BEFORE, "3.3.7", options={"cone": "'flat'", "iterations": "4"})
    write_store(tmp_path / "worse.sqlite", WORSE, "4.0.0", options={"cone": "'flat'", "iterations": "9"})
    write_store(tmp_path / "better.sqlite", BETTER, "4.0.0")
    write_store(tmp_path / "crashing.sqlite", {**BEFORE, CASE: failed("it crashed\x1b[2J")}, "4.0.0")
    return tmp_path


def compared(*arguments: object) -> int:
    return run_command(app, ["compare", *map(str, arguments)])


@pytest.mark.parametrize(
    ("now", "code", "strict", "says"),
    [
        ("worse", ExitCode.FAILED, ExitCode.FAILED, "1 regressed, 9 unchanged: before.sqlite is closer"),
        ("better", ExitCode.DONE, ExitCode.FAILED, "1 improved, 9 unchanged: better.sqlite is closer"),
        ("crashing", ExitCode.FAILED, ExitCode.FAILED, "1 missing, 9 unchanged: where both have a result, both"),
        ("before", ExitCode.DONE, ExitCode.DONE, "10 unchanged: both are as close to the exact motion."),
    ],
)
def test_a_worse_version_fails_and_a_better_one_passes(folder, now, code, strict, says, capsys, monkeypatch) -> None:
    monkeypatch.setenv("COLUMNS", "80")
    assert compared("before.sqlite", f"{now}.sqlite") == code
    printed = capsys.readouterr().out
    assert printed.splitlines()[-1].startswith(f"10 points, from before.sqlite to {now}.sqlite: {says}")
    assert "\x1b" not in printed
    if now == "worse":
        assert printed.startswith("mujoco 3.3.7 → 4.0.0\n")
        assert "mujoco:joint:tuned: options iterations 4 → 9\n" in printed
        assert re.search(r"friction 0.3, frequency 0.47 +regressed: transmittance", printed)
        assert max(map(len, printed.splitlines()[3:-1])) <= 80
    assert compared("before.sqlite", f"{now}.sqlite", "--strict") == strict


def test_files_say_what_the_command_says(folder) -> None:
    outs = [f"--out=changes{ending}" for ending in (".md", ".json", ".csv")]
    assert compared("before.sqlite", "crashing.sqlite", "--db=0.5", *outs) == ExitCode.FAILED
    content, table = json.loads(Path("changes.json").read_text()), pd.read_csv("changes.csv")
    counts = {"points": 10, "missing": 1, "regressed": 0, "unchanged": 9, "passes": False, "db": 0.5, "strict": False}
    assert {name: content[name] for name in counts} == counts
    assert table.change.tolist() == [row["change"] for row in content["changes"]]
    (gone,) = table[table.change == "missing"].to_dict("records")
    assert (gone["frequency_ratio"], gone["status_now"], gone["version_now"]) == (0.47, "failed", "4.0.0")
    assert "| missing: periodic before, failed now: it crashed\\x1b[2J |" in Path("changes.md").read_text()


def test_a_document_of_many_changes_folds_them_and_fits_a_comment(folder) -> None:
    """GitHub takes 65,536 characters; all points are in the other formats."""
    changes = compare("before.sqlite", "worse.sqlite")
    row = changes[changes.change == "regressed"]
    many = pd.concat([row.assign(error_percent_now=row.error_percent_now + k) for k in range(1000)])
    head, folded = markdown(Comparison(many, "a", "b", 0.001, strict=False)).split("<details>")
    assert head.count("| regressed: ") == 10
    assert f"| {row.error_percent_now.item() + 999:.3g} |" in head
    assert "<summary>100 more points, and 890 that are not shown</summary>" in folded
    assert len(head + folded) < 65_536


def test_default_options_of_mujoco_are_farther_from_the_exact_motion_at_every_point(tmp_path: Path, capsys) -> None:
    out, names = tmp_path / "changes.json", ["mujoco:joint:tuned", "mujoco:joint:default"]
    assert compared(*(f"--engine={name}" for name in names), "--workers=1", f"--out={out}") == ExitCode.FAILED
    assert f"24 points, from {names[0]} to {names[1]}" in capsys.readouterr().out
    changes = [row["change"] for row in json.loads(out.read_text())["changes"]]
    assert (len(changes), set(changes) <= {"regressed", "missing"}) == (24, True)
