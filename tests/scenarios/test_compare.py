"""Two configurations beside the exact motion: closer is improved, farther is regressed, the same is unchanged."""

import json
from dataclasses import replace
from pathlib import Path

import pandas as pd
import pytest

from multibody_xval.reports.cli.console_script import app
from multibody_xval.scenarios.compare import compared, conclusion, fails, pairs, summary
from multibody_xval.scenarios.compute.batch import run_batch
from multibody_xval.scenarios.exact_values import ruler
from multibody_xval.scenarios.judge import judged
from multibody_xval.scenarios.model import REFERENCE, Case, Config, Result, Run, failed
from multibody_xval.scenarios.result_tables import points
from multibody_xval.scenarios.store import Stored
from reference_lcp.errors import ExitCode
from reference_lcp.process import run_command

CASE, STEPS = Case(friction_ratio=0.3, frequency_ratio=0.47), 400
ONE, OTHER = Config("mujoco"), Config("pybullet")


@pytest.fixture(scope="module")
def ruled() -> list[Stored]:
    """Results of the ruler at the case."""
    return [Stored(run, "1", run_batch([run])[0]) for run in ruler([(CASE, STEPS)])]


def with_bound(factor: float) -> Result:
    """The scheme's steady state where the friction bound is wrong by a factor."""
    return run_batch([Run(REFERENCE, replace(CASE, friction_ratio=factor * 0.3), STEPS)])[0]


def changed(ruled: list[Stored], before: Result, now: Result) -> pd.DataFrame:
    rows = [Stored(Run(own, CASE, STEPS), "1", result) for own, result in ((ONE, before), (OTHER, now))]
    table = judged(points([*ruled, *rows]))
    return compared(table[table.config == ONE], table[table.config == OTHER], "mujoco -> pybullet")


GIVEN = {
    "improved": (1.05, 1.01),
    "regressed": (1.01, 1.05),
    "unchanged": (1.02, 1.02),
}


@pytest.mark.parametrize("change", GIVEN)
def test_the_error_to_the_exact_motion_decides(ruled, change: str) -> None:
    rows = changed(ruled, *(with_bound(factor) for factor in GIVEN[change]))
    assert rows.change.tolist() == [change]
    assert fails(rows) == (change == "regressed")


def test_a_steady_state_that_is_gone_is_missing_and_one_that_is_new_is_improved(ruled) -> None:
    sound, broken = with_bound(1.0), failed("it crashed")
    assert changed(ruled, sound, broken).change.tolist() == ["missing"]
    assert changed(ruled, broken, sound).change.tolist() == ["improved"]
    assert changed(ruled, broken, broken).change.tolist() == ["unchanged"]


def test_a_change_without_an_exact_value_is_unknown_and_fails(ruled) -> None:
    rows = changed([own for own in ruled if own.run.config == REFERENCE][:1], with_bound(1.01), with_bound(1.05))
    assert rows.change.tolist() == ["unknown"]
    assert fails(rows)


MATCHED = {
    "two engines": (["mujoco", "mujoco:joint:default"], ["pybullet:joint:default", "pybullet:contact"], [1], [0]),
    "an option": (["mujoco:joint:default", "mujoco"], ["mujoco:noslip_iterations=3"], [1], [0]),
    "one and one": (["mujoco:joint:default"], ["pybullet:contact"], [0], [0]),
    "nothing": (["mujoco:joint:default", "mujoco"], ["pybullet:contact"], [], []),
}


@pytest.mark.parametrize("case", MATCHED)
def test_formulations_and_presets_are_matched_whatever_their_options(case: str) -> None:
    *names, left, right = MATCHED[case]
    before, now = ([Config.parse(name) for name in own] for own in names)
    assert pairs(before, now) == [(before[i], now[k]) for i, k in zip(left, right, strict=True)]


def test_the_sentence_at_the_end_says_which_is_closer(ruled) -> None:
    rows = changed(ruled, with_bound(1.05), with_bound(1.0))
    assert conclusion(rows, "mujoco", "pybullet").endswith("1 improved: pybullet is closer to the exact motion.")
    assert summary(rows).improved.tolist() == [1]


def test_default_options_of_mujoco_are_farther_from_the_exact_motion_at_every_point(tmp_path: Path, capsys) -> None:
    out, names = tmp_path / "changes.json", ["mujoco:joint:tuned", "mujoco:joint:default"]
    arguments = ["compare", *(f"--engine={name}" for name in names), "--workers=1", f"--out={out}"]
    assert run_command(app, arguments) == ExitCode.FAILED
    assert f"24 points, from {names[0]} to {names[1]}" in capsys.readouterr().out
    rows = json.loads(out.read_text())
    assert len(rows) == 24
    assert {row["change"] for row in rows} <= {"regressed", "missing"}


@pytest.mark.parametrize(
    ("arguments", "problem"),
    [
        (["--engine=mujoco"], "0 stores and 1 --engine; allowed: two stores, or two --engine and no store"),
        (["some.sqlite", "--engine=mujoco", "--engine=pybullet"], "1 stores and 2 --engine"),
        (["--engine=mujoco:joint:best", "--engine=pybullet"], "best"),
        (["--engine=mujoco:contact:tuned", "--engine=mujoco:nose=3"], "nose"),
        (["--engine=mujoco", "--engine=pybullet:contact:nothing"], "nothing"),
    ],
)
def test_wrong_input_ends_before_anything_runs(arguments: list[str], problem: str, capsys) -> None:
    assert run_command(app, ["compare", *arguments]) == ExitCode.WRONG_INPUT
    assert problem in capsys.readouterr().err
