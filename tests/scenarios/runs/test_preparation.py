"""What engines do before their first run, such as compiling: in no task's time, and limited by itself."""

import sys
from pathlib import Path
from types import SimpleNamespace

import pytest

from multibody_xval.engines.interface.variant import Variant
from multibody_xval.scenarios.runs.local_processes import LocalExecutor
from multibody_xval.scenarios.runs.worker import LAW_LIMIT, Worker
from reference_lcp import terminal
from reference_lcp.schemes.sequential import SequentialSimulation
from tests.scenarios.runs.builders import evaluated

BATCH_SECONDS = 5.0
"""What a batch may take: less than `faulty-slowly-ready` takes to be ready."""

RATIOS = [0.4, 0.6, 0.7, 0.8, 0.9]
"""One more than a batch holds: both workers have one."""


@pytest.fixture
def run(notes, tmp_path: Path, monkeypatch, capsys):
    """Run points of an engine on two workers; gives their status and reason, and what a terminal is told."""
    terminal.say_in_terminal.cache_clear()

    def ran(engine: str, ratios=tuple(RATIOS)) -> tuple[list[tuple[str, str]], str]:
        monkeypatch.setattr(sys.stderr, "isatty", lambda: True)
        results = evaluated([engine], ratios, LocalExecutor(2, BATCH_SECONDS), tmp_path / "store.sqlite").values()
        return [(str(result.status), result.reason) for result in results], capsys.readouterr().err

    return ran


def times_prepared(folder: Path) -> int:
    return len((folder / "prepared").read_text().splitlines())


@pytest.mark.slow  # waits for processes
def test_preparation_that_takes_longer_than_a_task_may_is_not_counted_as_its_time_and_said_once(run, notes) -> None:
    points, told = run("faulty-slowly-ready")
    assert points == len(RATIOS) * [("converged", "")]
    assert times_prepared(notes) == 2  # each worker for itself
    assert told.strip() == "Sound compiles its kernels: at most 60 s; what is made is kept for later runs"


@pytest.mark.slow  # waits for processes
def test_preparation_that_hangs_is_ended_at_its_own_limit_once_for_all_points(run, notes) -> None:
    points, told = run("faulty-never-ready", RATIOS[:3])
    assert [status for status, _ in points] == 3 * ["blocked"]
    reason = "Sound compiles nothing: stopped at the time limit of 2 s, in prepare (unprepared.py:"
    assert all(text.startswith(reason) for _, text in points)
    assert times_prepared(notes) == 1
    assert not told.strip()


@pytest.mark.parametrize(
    ("engine", "reason"),
    [
        ("faulty-compiler", "Sound compiles its kernels: RuntimeError: no compiler"),
        ("faulty-early", "Sound compiles its kernels: the worker process crashed: Segmentation fault, in "),
    ],
)
def test_preparation_that_fails_blocks_all_points_with_its_reason(run, notes, engine, reason) -> None:
    points, _ = run(engine, RATIOS[:3])
    assert all(status == "blocked" and text.startswith(reason) for status, text in points)
    assert times_prepared(notes) == 1


@pytest.mark.slow  # waits for processes
def test_points_whose_engine_could_not_be_prepared_are_run_again(run, notes) -> None:
    """The machine is the cause, and may be another one by then; what the store holds does not keep them blocked."""
    for attempt in (1, 2):
        run("faulty-compiler", RATIOS[:1])
        assert times_prepared(notes) == attempt


@pytest.mark.parametrize("fails", [False, True])
def test_the_model_of_a_law_is_compiled_once_for_each_length_and_never_blocks_a_point(
    fails, monkeypatch, tmp_path
) -> None:
    begun, compiled = [], []

    def advance(self, state, start, steps):
        compiled.append((state.positions.shape, steps))
        if fails:
            raise RuntimeError("no law")
        return state

    monkeypatch.setattr(SequentialSimulation, "advance", advance)
    with (tmp_path / "crash log").open("w") as crash_log:
        worker = Worker(SimpleNamespace(send=begun.append), crash_log)
        for cells in (2, 7, 2):
            assert worker.preparation_problem(Variant.parse("mujoco:joint:default"), cells) is None
        assert begun == 2 * [("the law of MuJoCo is compiled", LAW_LIMIT)]
        assert compiled == [((1, 4), 1), ((1, 14), 1)]
        assert worker.preparation_problem(Variant("mujoco"), 7) is None, "the reference's step is compiled already"
        assert len(begun) == 2
