"""What a sweep's file may ask for beside its grid: adaptive frequencies, drive, presets, tolerances."""

import csv
import dataclasses
from collections import Counter
from pathlib import Path

import numpy as np
import pytest
from scipy.interpolate import PchipInterpolator

from multibody_xval.engines.interface.variant import Variant
from multibody_xval.reports.cli.console_script import app
from multibody_xval.scenarios import functions
from multibody_xval.scenarios.runs import dask_cluster
from multibody_xval.scenarios.runs.evaluator import Evaluator
from multibody_xval.scenarios.runs.executor import InProcessExecutor
from multibody_xval.scenarios.runs.parameters import ChainRatios, Excitation
from multibody_xval.scenarios.runs.result import Result
from multibody_xval.scenarios.runs.store import ResultStore
from multibody_xval.scenarios.runs.task import SteadyStateTask
from multibody_xval.scenarios.sweeps import dataset
from multibody_xval.scenarios.sweeps.adaptive_grid import level
from multibody_xval.scenarios.sweeps.dataset import STATUSES, sweep_dataset
from multibody_xval.scenarios.sweeps.dataset_reader import read_dataset
from multibody_xval.scenarios.sweeps.refinement import ForTheAccuracy
from multibody_xval.scenarios.sweeps.run import SweepSummary, compared_points, evaluate_sweep, stored_points
from multibody_xval.scenarios.sweeps.spec_file import read_sweep
from multibody_xval.scenarios.sweeps.sweep import Sweep
from reference_lcp.chain.linear_response import frictionless_transmittance
from reference_lcp.errors import ParameterError
from reference_lcp.observables.transmittance import decibel
from reference_lcp.process import run_command
from tests.scenarios.runs.builders import certified

CONTENT = """\
engines = ["reference:joint", "mujoco:joint"]
[grid]
friction_ratio = [0.0, 0.3]
frequency_ratio = { first = 0.5, last = 1.5, accuracy_db = 1.0, least_spacing = 0.005 }
[chain]
cells = 2
[drive]
kind = "force"
amplitude = 5.0
[tolerances]
transmittance_db = 0.01
"""


@pytest.fixture
def file(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.setattr(dask_cluster, "executor_for", lambda *_: InProcessExecutor())
    return written(tmp_path, CONTENT)


def written(folder: Path, content: str) -> Path:
    file = folder / "sweep.toml"
    file.write_text(content)
    return file


def test_adaptive_curves_of_the_command_are_right_between_their_points(file: Path, capsys) -> None:
    """Frictionless curve of the reference, driven by a force, against the closed form of the linear chain."""
    store, out = file.with_suffix(".sqlite"), file.with_suffix(".csv")
    assert run_command(app, ["sweep", str(file), "--store", str(store), "--out", str(out)]) == 0
    printed = capsys.readouterr().out
    assert "unresolved" in printed
    asked = read_sweep(file)
    with ResultStore(store) as kept:
        whole, points = stored_points(asked, kept)
    found = sweep_dataset(whole, points)
    counts = Counter(point.comparison.verdict for point in compared_points(whole, points)[Variant("mujoco")])
    curve = found.transmittance_db.sel(variant="reference", friction_ratio=0.0).dropna("frequency_ratio")
    eta = np.linspace(0.52, 1.48, 25)
    chain = ChainRatios(cells=2).chain(0.0)
    exact = [
        level(decibel(frictionless_transmittance(chain, Excitation(kind="force", amplitude=5.0).drive(chain, one))))
        for one in eta.tolist()
    ]
    # as accurate as asked, by a multiple; the Euler scheme's own error, below 0.2 dB, is part of that
    interpolated = PchipInterpolator(curve.frequency_ratio.values, [level(one) for one in curve.values])(eta)
    assert np.max(np.abs(interpolated - exact)) < 1.5
    assert set(counts) == {"agree"}
    assert sum(counts.values()) == int((found.status.sel(variant="mujoco") == STATUSES.index("converged")).sum())
    assert len(list(csv.DictReader(out.read_text().splitlines()))) == found.status.size


def test_each_curve_has_points_of_its_own_and_interruption_changes_none(file: Path) -> None:
    asked = read_sweep(written(file.parent, CONTENT.replace(', "mujoco:joint"', "")))
    with ResultStore(file.with_suffix(".sqlite")) as store:
        assert sweep_dataset(*stored_points(asked, store)).sizes["frequency_ratio"] > 0
        with Evaluator(store, InProcessExecutor()) as evaluator:
            evaluator.evaluate([asked.task(*place) for place in ForTheAccuracy(asked).due()])
        summary = evaluate_sweep(asked, store, InProcessExecutor(), verdicts=False)
        whole, points = stored_points(asked, store)
        found = sweep_dataset(whole, points)
    free, rubbing = (sorted(p.frequency_ratio for p in points if p.case == case) for case in asked.cases)
    assert free != rubbing
    assert summary.statuses == {(Variant("reference"), "converged"): len(free) + len(rubbing)}
    assert int((found.status == STATUSES.index("missing")).sum()) == 2 * len({*free, *rubbing}) - len(free) - len(
        rubbing
    )


def test_command_and_function_say_the_same_of_a_sweep(file: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """A variant whose law predicts a disagreement, beside the reference: step errors, predictions and verdicts."""
    monkeypatch.setattr(functions, "executor_for", lambda *_: InProcessExecutor())
    engines, out = ["reference", "exudyn-regularised:joint:default"], file.with_suffix(".nc")
    content = f"engines = {engines}\n[grid]\nfriction_ratio = [0.3]\nfrequency_ratio = [0.9]\n[chain]\ncells = 2\n"
    assert run_command(app, ["sweep", str(written(file.parent, content)), "--store", str(file.with_suffix(".db")),
                             "--out", str(out)]) == 0  # fmt: skip
    by_command, by_function = read_dataset(out), functions.sweep(engines, 0.3, 0.9, chain={"cells": 2})
    assert list(by_command.variant.values) == list(by_function.variant.values)
    for name in ("transmittance_db", "step_error_db", "law_value_db", "verdict"):
        assert not by_function[name].sel(variant=engines[1]).isnull().any(), name
        np.testing.assert_array_equal(by_command[name], by_function[name])


def test_force_and_base_of_equal_friction_ratio_are_different_questions_and_amplitude_changes_no_answer() -> None:
    usual = SteadyStateTask(variant=Variant("reference"), friction_ratio=0.3, frequency_ratio=0.9)
    louder = dataclasses.replace(usual, excitation=Excitation(amplitude=1.0))
    pushed = dataclasses.replace(usual, excitation=Excitation(kind="force", amplitude=10.0))
    assert len({usual.key(), louder.key(), pushed.key()}) == 3
    assert "excitation" not in usual.as_data()
    chains = [task.setting() for task in (usual, louder, pushed)]
    ratios = [chain.friction_bound[0] / drive.displacement_scale(chain) for chain, drive in chains]
    assert ratios == pytest.approx([0.3 * 1000] * 3)


def test_lists_give_every_cell_its_own_and_friction_follows_its_profile(tmp_path: Path) -> None:
    chain = "cells = 2\nmass_ratio = [0.5, 2.0]\nouter_mass_ratio = [1, 1.5]\nfriction_profile = [1.0, 0.0]"
    read = read_sweep(written(tmp_path, CONTENT.replace("cells = 2", chain)))
    task = next(one for one in read.tasks() if one.friction_ratio == 0.3)
    assert task.chain.inner_mass == pytest.approx([0.5, 3.0])
    assert task.chain.friction_bound[1] == 0.0 < task.chain.friction_bound[0]
    equal = next(read_sweep(written(tmp_path, CONTENT)).tasks())
    assert {"outer_mass_ratio", "friction_profile"} & equal.as_data()["ratios"].keys() == set()
    assert {"outer_mass_ratio", "friction_profile"} < task.as_data()["ratios"].keys()


def test_list_must_fit_every_length_of_the_chain(tmp_path: Path) -> None:
    content = CONTENT.replace("cells = 2", "mass_ratio = [0.5, 2.0]").replace("[grid]", "[grid]\ncells = [2, 3]")
    with pytest.raises(ParameterError, match=r"chain.mass_ratio has 2 values and the chain 3 cells; allowed: one"):
        read_sweep(written(tmp_path, content))


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ("cells = 2", "damping_ratio = [0.1, -0.1]", r"chain.damping_ratio.1 = -0.1; .*greater than or equal to 0"),
        ('kind = "force"', 'kind = "wind"', r"sweep.toml: drive.kind = 'wind'; input should be 'base' or 'force'"),
        ("amplitude = 5.0", "amplitude = 0.0", r"drive.amplitude = 0.0; input should be greater than 0"),
        ("amplitude = 5.0", "size = 5.0", r"drive.size is unknown"),
        ("transmittance_db = 0.01", "transmittance_db = -1.0", r"tolerances.transmittance_db = -1.0; .*greater than 0"),
        ("transmittance_db = 0.01", "", r"tolerances.transmittance_db is missing"),
        ('"reference:joint", ', "", r"tolerances.transmittance_db = 0.01 without the reference .*allowed: "),
        ("accuracy_db = 1.0", "accuracy_db = 0.0", r"grid.frequency_ratio.accuracy_db = 0.0; .*greater than 0"),
        ("accuracy_db = 1.0", "accuracy_db = 1.0, points = 3", r"grid.frequency_ratio.points is unknown"),
        ("first = 0.5", "first = 1.5", r"grid.frequency_ratio.last = 1.5; allowed: > first = 1.5"),
        ("friction_ratio = [0.0, 0.3]", "friction_ratio = { first = 0.1, last = 1.0, accuracy_db = 1.0 }",
         r"grid.friction_ratio has an accuracy; allowed: of frequency_ratio only"),
        ("mujoco:joint", "mujoco:joint:fast", r"preset of mujoco = 'fast' is unknown; allowed: tuned"),
        ("mujoco:joint", "mujoco:sweeps=3", r"option 'sweeps' cannot be set in mujoco:joint:tuned; allowed"),
    ],
)  # fmt: skip
def test_mistake_is_named_with_its_key_and_value(file: Path, old: str, new: str, message: str) -> None:
    assert old in CONTENT
    with pytest.raises(ParameterError, match=message):
        read_sweep(written(file.parent, CONTENT.replace(old, new)))


@pytest.mark.parametrize(
    ("engines", "expected"),
    [
        ('["mujoco"]', ["mujoco"]),
        ('["mujoco:all:default"]', ["mujoco:joint:default", "mujoco:contact:default"]),
        ('["mujoco", "mujoco:noslip_iterations=3"]', ["mujoco", "mujoco:noslip_iterations=3"]),
    ],
)
def test_names_of_a_file_are_those_of_the_command_line(file: Path, engines: str, expected: list[str]) -> None:
    content = CONTENT.partition("[tolerances]")[0].replace('["reference:joint", "mujoco:joint"]', engines)
    asked = read_sweep(written(file.parent, content))
    assert [str(variant) for variant in asked.variants] == expected


def test_summary_names_every_reason_once_and_the_periods_that_suffice() -> None:
    summary, variant = SweepSummary(), Variant("mujoco")
    for periods in range(1, 101):
        summary.add(variant, certified(7, periods=periods))
    for _ in range(2):
        summary.add(variant, Result.blocked("crashed"))
    for multiple in (3, 0, 1):
        summary.add(variant, Result(status="period limit", periods=401, multiple=multiple))
    assert [summary.quantile_of_periods(variant, part) for part in (0.5, 0.99, 1.0)] == [50, 99, 100]
    assert summary.quantile_of_periods(Variant("pybullet"), 0.5) is None
    assert {reason: count for (_, reason), count in summary.reasons.items()} == {
        "crashed": 2,
        "period limit, period 3": 1,
        "period limit, no period up to 8": 1,
        "period limit": 1,
    }


def test_outcomes_of_kept_answers_are_those_of_the_answers_with_and_without_a_multiple(tmp_path: Path) -> None:
    asked = [
        SteadyStateTask(variant=Variant("reference"), friction_ratio=0.3, frequency_ratio=eta)
        for eta in (0.5, 0.7, 0.9)
    ]
    with ResultStore(tmp_path / "s.sqlite") as store:
        store.keep([(asked[0], Result(status="period limit", periods=401, multiple=3))])
        store.keep([(asked[1], certified(7, periods=28))])
        store._connection.execute(
            "UPDATE answers SET answer = json_remove(answer, '$.multiple') WHERE key = ?", (asked[1].key(),)
        )
        assert list(store.results(asked)) == [
            Result(status="period limit", periods=401, multiple=3),
            certified(7, periods=28),
            None,
        ]


@pytest.mark.parametrize("axis", ["mass_ratio", "steps_per_period"])
def test_dataset_says_once_what_each_parameter_is(file: Path, axis: str) -> None:
    """A parameter is an axis, or an attribute."""
    asked = read_sweep(file)
    values = {"mass_ratio": 0.7, "steps_per_period": asked.steps_per_period}
    varied = Sweep(asked.variants, {**asked.axes, axis: (values[axis],)}, asked.ratios, asked.steps_per_period)
    kept = dataset._attributes(varied, None)
    assert axis not in kept
    (other,) = values.keys() - {axis}
    assert kept[other] == (asked.steps_per_period if other == "steps_per_period" else asked.ratios.mass_ratio)
    assert kept["stiffness_ratio"] == asked.ratios.stiffness_ratio
