"""What is said of a command while it computes: step, part, time left, the first result."""

import io
import re
from pathlib import Path

import pytest
from rich.console import Console
from rich.progress import Progress

from multibody_xval.scenarios.model import REFERENCE, Case, Result, Run, Status, failed
from multibody_xval.scenarios.running import progress
from multibody_xval.scenarios.running.evaluate import Means, computed
from multibody_xval.scenarios.running.progress import LINES, Steps, shown

STEPS = 100


def run_at(number: int) -> Run:
    return Run(REFERENCE, Case(friction_ratio=0.3, frequency_ratio=0.5 + number / 1000, cells=2), STEPS)


def ended(*numbers: int) -> dict[Run, Result]:
    return {run_at(number): Result(status=Status.PERIODIC, transmittance=1.0 + 0j) for number in numbers}


@pytest.fixture
def clock(monkeypatch) -> list[float]:
    """A clock that tests set."""
    now = [0.0]
    monkeypatch.setattr(progress.time, "monotonic", lambda: now[0])
    return now


def test_a_line_has_step_part_and_time_left_from_the_start(capsys, clock) -> None:
    with shown(["grid", "edges"]) as steps:
        steps.begin()
        steps.more(100)
        clock[0] = 10.0
        steps.ended(ended(*range(50)))
        steps.ended(ended(*range(50, 100)))
    lines = capsys.readouterr().err.splitlines()
    assert lines == [
        "step 1 of 2, grid: 0 of 100 runs, about 20 s left",
        "first result: reference, friction 0.3, frequency 0.5, cells 2: 0.000 dB",
        "step 1 of 2, grid: 50 of 100 runs, about 10 s left",
        "step 1 of 2, grid: 100 of 100 runs",
    ]


def test_a_step_without_runs_is_not_shown(capsys) -> None:
    with shown(["grid", "adaptive curves", "edges"]) as steps:
        for runs in (1, 0, 2):
            steps.begin()
            steps.more(runs)
    assert re.findall("step . of 3, [a-z ]*", capsys.readouterr().err) == ["step 1 of 3, grid", "step 3 of 3, edges"]


def test_a_step_that_grows_goes_on_saying_so(capsys) -> None:
    with shown(["edges"]) as steps:
        steps.begin()
        for first in (0, 20, 40):
            steps.more(20)
            steps.ended(ended(*range(first, first + 20)))
    parts = re.findall(r"(\d+) of (\d+) runs", capsys.readouterr().err)
    assert parts == [("0", "20"), ("20", "20"), ("40", "40"), ("60", "60")]


def test_many_results_are_a_few_lines(capsys) -> None:
    with shown(["grid"]) as steps:
        steps.begin()
        steps.more(400)
        for number in range(400):
            steps.ended(ended(number))
    assert capsys.readouterr().err.count("grid: ") == LINES + 1


def test_what_has_failed_is_not_the_first_result(capsys) -> None:
    with shown(["grid"]) as steps:
        steps.begin()
        steps.more(2)
        steps.ended({run_at(1): failed("it crashed")})
        assert "first result" not in capsys.readouterr().err
        steps.ended(ended(2))
    assert "first result: reference, friction 0.3, frequency 0.502" in capsys.readouterr().err


def test_a_terminal_has_one_bar_for_the_step_that_has_runs() -> None:
    console = Console(file=io.StringIO(), force_terminal=True, width=120)
    with Progress(console=console) as bar:
        steps = Steps(["grid", "edges"], bar)
        steps.begin()
        assert bar.tasks == []
        steps.more(4)
        steps.ended(ended(1))
        assert [(task.description, task.completed, task.total) for task in bar.tasks] == [("step 1 of 2, grid", 1, 4)]
        steps.begin()
        assert bar.tasks == []


def test_what_a_store_has_is_neither_counted_nor_the_first_result(tmp_path: Path, capsys) -> None:
    means = Means(store=tmp_path / "results.sqlite", workers=1)
    computed([run_at(1), run_at(2)], means, "grid")
    lines = capsys.readouterr().err.splitlines()
    assert lines[0] == "grid: 0 of 2 runs, about 1 s left"
    assert lines[-1] == "grid: 2 of 2 runs"
    computed([run_at(1), run_at(2)], means, "grid", then=[("more", lambda table: [run_at(3)] * (len(table) == 2))])
    first, second, *_ = capsys.readouterr().err.splitlines()
    assert first == "step 2 of 2, more: 0 of 1 runs, about 1 s left"
    assert second.startswith("first result: reference, friction 0.3, frequency 0.503")
    computed([run_at(1), run_at(2)], means, "grid")
    assert capsys.readouterr().err == ""
