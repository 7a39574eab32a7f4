"""Answers are kept, found again, and survive engines that fail."""

import sqlite3
from contextlib import closing

import pytest

from multibody_xval.engines.interface import variant
from multibody_xval.engines.interface.engine import Engine
from multibody_xval.engines.interface.presets import Capabilities, Formulation, FrictionLaw, Preset
from multibody_xval.engines.interface.variant import Variant
from multibody_xval.scenarios.runs import evaluator as evaluation
from multibody_xval.scenarios.runs import local_processes
from multibody_xval.scenarios.runs import store as store_file
from multibody_xval.scenarios.runs.evaluator import Evaluator, StoredResults
from multibody_xval.scenarios.runs.executor import InProcessExecutor, run_batch
from multibody_xval.scenarios.runs.local_processes import LocalExecutor
from multibody_xval.scenarios.runs.result import Result, ResultStatus
from multibody_xval.scenarios.runs.store import ResultStore
from multibody_xval.scenarios.runs.task import Recorded, SteadyStateTask
from reference_lcp import ParameterError
from tests.scenarios.runs.builders import Invented, certified, numbers, steady


def test_kept_answer_is_found_by_an_equal_question_only(store) -> None:
    store.keep([(steady(), certified(transmittance_db=1.0))])
    assert store.find(steady()).transmittance_db == 1.0
    for other in (steady(friction_ratio=0.4), steady(0.91), steady(steps_per_period=800), steady(variant="mujoco")):
        assert store.find(other) is None


CRASHED = Result.blocked("crashed", by_engine=True)
KILLED = Result.blocked("the worker process was killed")
GOOD = certified(periods=30)


@pytest.mark.parametrize("release", [False, True], ids=["evaluate", "complete"])
def test_what_an_engine_blocked_is_recalled_and_run_again_on_request_other_blocks_always(store, release) -> None:
    tasks = [steady(eta) for eta in (0.5, 0.7, 0.9)]

    def completed(evaluator: Evaluator) -> dict[SteadyStateTask, Result]:
        ends = {}
        evaluator.complete(tasks, ends.__setitem__)
        return {each: ends[each] for each in tasks}

    def run(results: list[Result], **options: bool) -> tuple[list[str], list[float]]:
        executor = Invented(dict(zip(tasks, results, strict=True)).__getitem__)
        with Evaluator(store, executor, **options) as evaluator:
            ends = completed(evaluator) if release else dict(zip(tasks, evaluator.evaluate(tasks), strict=True))
        return [f"{ends[task].status} {ends[task].reason}".strip() for task in tasks], [
            task.frequency_ratio for task in executor.ran
        ]

    blocked = ["blocked crashed", "blocked the worker process was killed", "converged"]
    assert run([CRASHED, KILLED, GOOD]) == (blocked, [0.5, 0.7, 0.9])
    with StoredResults(store) as stored:  # what is run again is blocked until then
        assert [f"{end.status} {end.reason}".strip() for end in completed(stored).values()] == blocked
    assert run([GOOD, KILLED, CRASHED]) == (blocked, [0.7])
    assert run([GOOD, GOOD, CRASHED]) == (["blocked crashed", "converged", "converged"], [0.7])
    assert run([GOOD, CRASHED, CRASHED], retry_blocked=True) == (["converged"] * 3, [0.5])
    assert run([CRASHED] * 3, retry_blocked=True) == (["converged"] * 3, [])


def test_a_blocked_result_takes_the_place_of_no_other_one(store) -> None:
    """Two processes may run the same task at the same time."""
    for eta, kept, stays in ((0.9, GOOD, GOOD), (0.9, CRASHED, GOOD), (0.5, KILLED, KILLED), (0.5, CRASHED, CRASHED),
                             (0.5, GOOD, GOOD)):  # fmt: skip
        store.keep([(steady(eta), kept)])
        assert store.find(steady(eta)).to_json() == stays.to_json()


def test_foreign_and_damaged_files_are_refused_and_left_alone(tmp_path) -> None:
    foreign = tmp_path / "foreign.sqlite"
    with sqlite3.connect(foreign) as connection:
        connection.execute("CREATE TABLE theirs (x)")
    connection.close()
    text = tmp_path / "notes.txt"
    text.write_text("not a database, but long enough to look like one" * 10)
    older = tmp_path / "older.sqlite"
    ResultStore(older).close()
    with closing(sqlite3.connect(older)) as connection:
        connection.execute("PRAGMA user_version = 2")
    anew = "has layout 2; allowed: 3; the same command with a new --store computes anew"
    for file, message in ((foreign, "belongs to another program"), (text, "not a database"), (older, anew)):
        before = file.read_bytes()
        with pytest.raises(ParameterError, match=message):
            ResultStore(file)
        assert file.read_bytes() == before
    with pytest.raises(ParameterError, match="there is no folder"):
        ResultStore(tmp_path / "missing" / "results.sqlite")


def test_a_store_with_a_damaged_page_is_refused_where_it_is_only_read_and_left_alone(tmp_path) -> None:
    file = tmp_path / "results.sqlite"
    with ResultStore(file) as store:
        store.keep([(steady(eta / 10), certified(transmittance_db=eta)) for eta in range(1, 60)])
    content = bytearray(file.read_bytes())
    content[5 * 4096 : 6 * 4096] = b"\xff" * 4096
    file.write_bytes(content)
    refused = pytest.raises(ParameterError, match=r"is damaged: .*; the same command with a new --store computes anew")
    with ResultStore(file) as store, refused:
        store.check_pages()
    assert file.read_bytes() == content


def test_second_evaluation_computes_nothing(store, monkeypatch) -> None:
    asked = [*(steady(eta) for eta in (0.5, 0.9, 0.5)), steady().recording(Recorded.PERIOD)]
    with Evaluator(store, InProcessExecutor()) as evaluator:
        first = evaluator.evaluate(asked)
    monkeypatch.setattr(local_processes, "LocalWorker", None)
    counted = []
    with Evaluator(store, LocalExecutor(1)) as evaluator:
        evaluator.progress.recall = lambda tasks: counted.append(len(tasks))
        assert evaluator.evaluate(asked) == first
    assert sum(counted) == 3
    assert first[0] == first[2]
    assert all(answer.converged for answer in first)


def test_stored_answers_complete_with_what_is_kept_and_say_what_is_missing(store, monkeypatch) -> None:
    kept, unknown, absent = steady(), steady(0.5), steady(variant="pybullet")
    store.keep([(kept, Result(status=ResultStatus.PERIOD_LIMIT, periods=400, multiple=0))])
    missing = property(lambda asked: "no wheel" if asked.engine == "pybullet" else None)
    monkeypatch.setattr(Variant, "unavailable_reason", missing)
    counted = []
    with StoredResults(store) as stored:
        stored.progress.recall = counted.extend
        ends = []
        stored.complete([kept, unknown, absent], lambda *end: ends.append(end))
    assert ends == [
        (kept, Result(status="period limit", periods=400, multiple=0)),
        (unknown, Result(status="missing", reason="not evaluated so far")),
        (absent, Result(status="blocked", reason="not installed: no wheel")),
    ]
    assert counted == [kept, unknown, absent]


def test_only_what_is_not_stored_is_asked_whether_its_engine_can_represent_it(store, monkeypatch) -> None:
    store.keep([(steady(), certified())])
    monkeypatch.setattr(SteadyStateTask, "unsupported_reason", lambda _: "too heavy")
    stored, refused = Evaluator(store, InProcessExecutor()).evaluate([steady(), steady(0.5)])
    assert stored == certified()
    assert refused.reason == "cannot be represented: too heavy"


def test_complete_takes_tasks_a_part_at_a_time_as_their_results_come(store, monkeypatch) -> None:
    """Ten thousand tasks or ten: as many as `LOOKUP` are in memory, and no result."""
    monkeypatch.setattr(store_file, "LOOKUP", 3)
    monkeypatch.setattr(evaluation, "batches_of", lambda tasks: ([task] for task in tasks))
    taken, tasks = [], [steady(0.5 + 0.1 * k) for k in range(7)]
    store.keep([(tasks[4], Result(status=ResultStatus.PERIOD_LIMIT, periods=400))])

    evaluator = Evaluator(store, Invented(lambda _task: certified(periods=9)))
    ends, in_memory = {}, []

    def note(task, end) -> None:
        ends[task.frequency_ratio] = end.periods
        in_memory.append(len(taken) - len(ends))

    evaluator.complete((taken.append(task) or task for task in tasks), note)
    assert max(in_memory) < 3
    assert ends == {task.frequency_ratio: 400 if task == tasks[4] else 9 for task in tasks}
    assert evaluator.new_tasks(tasks) == tasks
    assert [result.periods for result in store.results(tasks)] == [9, 9, 9, 9, 400, 9, 9]


def test_a_store_with_an_unknown_status_says_which_file_and_which_status(tmp_path) -> None:
    file = tmp_path / "results.sqlite"
    with ResultStore(file) as store:
        store.keep([(steady(), certified(transmittance_db=1.0))])
        assert type(store.find(steady()).status) is ResultStatus
    with sqlite3.connect(file) as connection:
        changed = """UPDATE answers SET answer = replace(answer, '"converged"', '"solved"')"""
        assert connection.execute(changed).rowcount == 1
    connection.close()
    refused = pytest.raises(ParameterError, match=r"results\.sqlite: status of a result = 'solved'; allowed: ")
    with ResultStore(file) as store, refused:
        store.find(steady())


def test_number_of_workers_does_not_change_the_answers() -> None:
    one, two = (numbers(("reference", "mujoco"), (0.5, 0.9), LocalExecutor(workers)) for workers in (1, 2))
    assert one == two


@pytest.mark.parametrize(("asked", "processors", "workers"), [(None, 3, 3), (None, None, 1), (2, 3, 2)])
def test_there_are_as_many_workers_as_processors_unless_said_otherwise(monkeypatch, asked, processors, workers) -> None:
    monkeypatch.setattr(local_processes.os, "cpu_count", lambda: processors)
    assert LocalExecutor(asked)._slots == workers


def test_workers_below_one_are_refused() -> None:
    with pytest.raises(ParameterError, match="workers = 0"):
        LocalExecutor(0)


class _Failing(Engine):
    name = "failing"
    capabilities = Capabilities(
        title="Failing", package="none", licence="MIT", friction_law=FrictionLaw.COULOMB,
        presets={Formulation.JOINT: {"tuned": Preset("fails", {})}},
    )  # fmt: skip
    missing: str | None = None
    failure: BaseException | None = None

    def version(self) -> str:
        return "1"

    def unavailable_reason(self) -> str | None:
        return self.missing

    def _build(self, lanes, formulation, preset):
        raise self.failure


@pytest.mark.parametrize(
    ("failure", "missing", "reason", "by_engine"),
    [
        (RuntimeError("solver gave up\nat step 3"), None, "RuntimeError: solver gave up at step 3", True),
        (ParameterError("friction_bound = 9"), None, "cannot be represented: friction_bound = 9", True),
        (RuntimeError("/tmp/\udcff\x1b[2J"), None, "RuntimeError: /tmp/\\udcff\\x1b[2J", True),
        (SystemExit(0), None, "SystemExit: 0", True),
        (MemoryError(), None, "MemoryError:", False),
        (OSError(24, "too many files"), None, "OSError: [Errno 24] too many files", False),
        (None, "no wheel for this Python", "not installed: failing: no wheel for this Python", False),
    ],
)
def test_engine_that_fails_gives_blocked_answers_with_the_reason(
    monkeypatch, store, failure, missing, reason, by_engine
) -> None:
    """An error of the machine is not the engine's; whatever its text is, it can be kept."""
    failing = _Failing()
    failing.failure, failing.missing = failure, missing
    monkeypatch.setattr(variant, "engine", lambda _name: failing)
    blocked = ("blocked", reason, by_engine)
    tasks = [steady(), steady(0.5)]
    store.keep(zip(tasks, run_batch(tasks), strict=True))
    assert [(a.status, a.reason, a.by_engine) for a in store.results(tasks)] == [blocked, blocked]
