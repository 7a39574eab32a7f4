"""What is said of a command while it computes: step, part, time left, the first result."""

from multibody_xval.scenarios.model import REFERENCE, Case, Result, Run, Status
from multibody_xval.scenarios.running import progress
from multibody_xval.scenarios.running.progress import shown


def run_at(number: int) -> Run:
    return Run(REFERENCE, Case(friction_ratio=0.3, frequency_ratio=0.5 + number / 1000, cells=2), 100)


def test_a_line_has_step_part_and_time_left_once_engines_are_loaded(capsys, monkeypatch) -> None:
    """The first results come after 10 s, most of which is no run; 40 more in 4 s: the other 40 take 4 s."""
    now = [0.0]
    monkeypatch.setattr(progress.time, "monotonic", lambda: now[0])
    with shown(["grid", "edges"]) as steps:
        steps.begin()
        steps.more(100)
        for now[0], part in ((10.0, range(20)), (14.0, range(20, 60)), (18.0, range(60, 100))):
            steps.ended({run_at(number): Result(status=Status.PERIODIC, transmittance=1.0 + 0j) for number in part})
    assert capsys.readouterr().err.splitlines() == [
        "step 1 of 2, grid: 0 of 100 runs",
        "first result: reference, friction 0.3, frequency 0.5, cells 2: 0.000 dB",
        "step 1 of 2, grid: 20 of 100 runs",
        "step 1 of 2, grid: 60 of 100 runs, about 4 s left",
        "step 1 of 2, grid: 100 of 100 runs",
    ]


def test_a_step_that_grows_while_it_runs_has_few_lines(capsys) -> None:
    """Band edges are refined in rounds of a few runs: a line for each round would be a hundred."""
    with shown(["edges"]) as steps:
        steps.begin()
        for number in range(100):
            steps.more(2)
            steps.ended({run_at(2 * number + own): Result(status=Status.PERIODIC) for own in range(2)})
    lines = capsys.readouterr().err.splitlines()
    assert 10 < sum("edges: " in line for line in lines) < 30, "a line more for each tenth more of the runs"
