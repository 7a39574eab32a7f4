"""Engines that crash, hang, are killed or give no numbers: blocked with the reason, and everything else goes on."""

import json
import os
import re
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest

from scenarios.runs import local_processes
from scenarios.runs.evaluator import Evaluator
from scenarios.runs.local_processes import LocalExecutor, LocalWorker
from scenarios.runs.result import LONGEST_REASON
from scenarios.runs.store import opened_store
from scenarios.runs.worker_template import PRINTED_BYTES, START_SECONDS
from tests.scenarios.runs.builders import ended, running, steady

LIMIT = 8.0
"""Seconds that a batch may take: importing an engine and its compiled code takes some on a machine that is busy."""

PROCESSES = 5
"""Processes of an executor with two workers: a template, and a supervisor and the worker itself for each."""

SCRIPT = """
import json, sys, time
from pathlib import Path
from engines.interface.variant import Variant
from scenarios.runs.evaluator import Evaluator
from scenarios.runs.local_processes import LocalExecutor
from scenarios.runs.parameters import ChainRatios
from scenarios.runs.task import SteadyStateTask
from scenarios.runs.store import ResultStore

def task(name, eta):
    return SteadyStateTask(variant=Variant(name), friction_ratio=0.3, frequency_ratio=eta, ratios=ChainRatios(cells=2))

if __name__ == "__main__":
    names, file = sys.argv[1].split(","), Path(sys.argv[2])
    asked = [task(name, eta) for name in names for eta in json.loads(sys.argv[3])]
    with ResultStore(file) as store, Evaluator(store, LocalExecutor(2, LIMIT)) as evaluator:
        found = evaluator.evaluate(asked)
    rows = [(q.variant.engine, q.frequency_ratio, a.status, a.reason, a.transmittance_db) for q, a in zip(asked, found)]
    print(json.dumps(rows))
""".replace("LIMIT", str(LIMIT))


@pytest.fixture
def client(install, tmp_path):
    """Ask engines of the faulty package, on two workers with a time limit; gives the command's end."""
    script, environment = (
        tmp_path / "ask.py",
        install("mutations").environment | {"FAULTY_CHILD": str(tmp_path / "child")},
    )
    script.write_text(SCRIPT)

    def asked(*names: str, ratios=(0.4, 0.5, 0.9)) -> subprocess.CompletedProcess[str]:
        line = [sys.executable, str(script), ",".join(names), str(tmp_path / "store.sqlite"), json.dumps(list(ratios))]
        return subprocess.run(line, env=environment, capture_output=True, text=True, check=True, timeout=120)

    return asked


@pytest.fixture
def ask(client):
    """Ask engines in the same way; gives status and reason by engine and frequency ratio."""

    def asked(*names: str, **more) -> dict[tuple[str, float], tuple[str, str]]:
        printed = client(*names, **more).stdout
        return {(engine, eta): (status, reason) for engine, eta, status, reason, _ in json.loads(printed)}

    return asked


@pytest.fixture(scope="module")
def rows(install, tmp_path_factory) -> dict[tuple[str, float], tuple[str, str]]:
    """Answers of engines that end, hang or are held up, together on four workers: their time limits pass at once."""
    hanging = ("faulty-hang", "faulty-stopped", "faulty-disarms", "faulty-sending")
    others = ("reference", "faulty-crash", "faulty-killed", "faulty-thread", "mujoco")
    folder = tmp_path_factory.mktemp("deadly")
    script = folder / "ask.py"
    script.write_text(SCRIPT.replace("LocalExecutor(2", "LocalExecutor(4"))
    begin = time.monotonic()
    names = ",".join((*hanging, *others))
    printed = install("mutations").run(str(script), names, str(folder / "store.sqlite"), "[0.4, 0.5, 0.9]")
    assert time.monotonic() - begin < 180  # a stopped process would never end
    return {(engine, eta): (status, reason) for engine, eta, status, reason, _ in json.loads(printed)}


def test_segmentation_fault_a_hang_and_a_killed_process_block_their_own_points_only(rows) -> None:
    deadly = {"faulty-crash", "faulty-hang", "faulty-killed", "faulty-stopped", "faulty-disarms", "faulty-sending"}
    for (engine, eta), (status, _) in rows.items():
        assert status == ("blocked" if eta == 0.5 and engine in deadly else "converged"), (engine, eta)
    assert rows["faulty-crash", 0.5][1].startswith("the worker process crashed: Segmentation fault, in ")
    assert rows["faulty-hang", 0.5][1].startswith(f"stopped at the time limit of {LIMIT:g} s, in run (deadly.py:")
    assert rows["faulty-killed", 0.5][1] == "the worker process was killed"


def test_whatever_an_engine_raises_is_the_result_of_its_point_alone(ask) -> None:
    """An end of the program, an interrupt, an exception without words: in a worker all of them are the engine's."""
    rows = ask("faulty-exits", "faulty-interrupts", "faulty-unspeakable", "reference")
    for (engine, eta), (status, _) in rows.items():
        deadly = eta == 0.5 and engine.startswith("faulty")
        assert status == ("blocked" if deadly else "converged"), (engine, eta)
    assert rows["faulty-exits", 0.5][1] == "SystemExit: 0"
    assert rows["faulty-interrupts", 0.5][1] == "KeyboardInterrupt:"
    assert rows["faulty-unspeakable", 0.5][1] == "UnspeakableError: its message cannot be read (RuntimeError)"


def test_the_time_limit_holds_for_a_process_that_cannot_keep_it_itself(rows) -> None:
    """One is stopped, one has disarmed its alarm: both are ended from outside, with their process groups."""
    for name in ("faulty-stopped", "faulty-disarms"):
        assert rows[name, 0.5] == ("blocked", f"stopped at the time limit of {LIMIT:g} s")
        assert rows[name, 0.4][0] == rows[name, 0.9][0] == "converged"


@pytest.mark.parametrize("engine", ["faulty-forks", "faulty-daemon"])
def test_an_engine_that_forks_or_starts_a_daemon_is_answered_once_and_leaves_no_process(ask, tmp_path, engine) -> None:
    """A daemon has a session of its own and no parent."""
    rows = ask(engine, ratios=(0.4, 0.5))
    assert [status for status, _ in rows.values()] == ["converged", "converged"]
    assert not running(int((tmp_path / "child").read_text()))


def test_worker_that_is_stopped_while_it_sends_and_one_with_a_thread_left_behind_end(rows) -> None:
    """One message ends in the middle; the other process would wait for its thread. The client waits for neither."""
    assert rows["faulty-sending", 0.5] == ("blocked", f"stopped at the time limit of {LIMIT:g} s")
    assert (
        rows["faulty-sending", 0.4][0] == rows["faulty-thread", 0.4][0] == rows["faulty-thread", 0.5][0] == "converged"
    )


def test_what_an_engine_prints_and_says_is_cut(client) -> None:
    """A hundred megabytes on standard output, a million words in an error."""
    done = client("faulty-flood", "faulty-talks", ratios=(0.5,))
    flood, talks = json.loads(done.stdout)
    assert flood[2] == "converged"
    assert f"… ({100_000_000 - PRINTED_BYTES} bytes more)" in done.stderr
    assert done.stderr.count("~") == PRINTED_BYTES
    assert talks[2] == "blocked"
    assert re.fullmatch(r"RuntimeError: (word )+.*… \(\d+ characters more\)", talks[3])
    assert len(talks[3]) < LONGEST_REASON + 40


def test_what_an_engine_does_to_its_process_is_felt_by_no_other(install, tmp_path) -> None:
    """One worker for both engines in turn: a process for each engine."""
    script, site = tmp_path / "ask.py", install("mutations")
    script.write_text(SCRIPT.replace("LocalExecutor(2", "LocalExecutor(1"))
    alone, after = (
        {row[0]: row[2:] for row in json.loads(site.run(str(script), names, str(tmp_path / names), "[0.9]"))}
        for names in ("reference", "faulty-changes,reference")
    )
    assert after["reference"] == alone["reference"]
    assert after["faulty-changes"][2] != pytest.approx(alone["reference"][2], abs=0.1)


def test_numbers_that_are_not_finite_are_blocked(ask) -> None:
    rows = ask("faulty-nan", "faulty-sound", ratios=(0.9,))
    status, reason = rows["faulty-nan", 0.9]
    assert status == "blocked"
    assert re.fullmatch(r"the engine's position is not finite at \S+ s in cell 1: nan", reason)
    assert rows["faulty-sound", 0.9][0] == "converged"


def test_engine_of_another_version_in_the_worker_is_blocked_with_both_named(ask) -> None:
    rows = ask("faulty-version", "faulty-sound", ratios=(0.9,))
    status, reason = rows["faulty-version", 0.9]
    assert status == "blocked"
    here, expected = reason.removeprefix("not the same in the worker: ").split("; expected: ")
    assert here.startswith("faulty-version 9.9.9, Python ")
    assert expected == here.replace("9.9.9", "1.0.0")
    assert rows["faulty-sound", 0.9][0] == "converged"


def test_engine_that_dies_at_point_after_point_is_not_asked_forever(ask) -> None:
    """The same point in ever other digits: each is a question of its own, and each kills."""
    near = [0.5 + k * 1e-12 for k in range(6)]
    rows = ask("faulty-killed", "reference", ratios=near)
    reasons = [rows["faulty-killed", eta][1] for eta in near]
    assert reasons.count("the worker process was killed") >= 3
    assert "not run: 3 points before, the worker process was killed" in reasons
    assert all(rows["reference", eta][0] == "converged" for eta in near)


def descendants_of(process: int) -> set[int]:
    try:
        children = {int(child) for child in Path(f"/proc/{process}/task/{process}/children").read_text().split()}
    except FileNotFoundError:
        return set()
    return children.union(*map(descendants_of, children))


@pytest.mark.skipif(not Path("/proc/self/task").is_dir(), reason="needs Linux's list of processes")
@pytest.mark.parametrize("signalled", [signal.SIGKILL, signal.SIGINT], ids=["killed", "interrupted"])
def test_workers_end_with_their_client(install, tmp_path, signalled) -> None:
    """kill −9 leaves no time to say goodbye, Ctrl-C must not wait for a batch; nothing may compute for nobody."""
    script = tmp_path / "ask.py"
    # a shell's background jobs ignore Ctrl-C, and so would all that they start
    heeds = "import signal\nsignal.signal(signal.SIGINT, signal.default_int_handler)\n"
    script.write_text(heeds + SCRIPT.replace(f"(2, {LIMIT})", "(2, 600.0)"))
    site = install("mutations")
    command = [sys.executable, str(script), "faulty-sound", str(tmp_path / "store.sqlite")]
    ratios = json.dumps([0.4 + 1e-3 * k for k in range(400)])
    client = subprocess.Popen([*command, ratios], env=site.environment, stderr=subprocess.DEVNULL)
    processes: set[int] = set()
    give_up = time.monotonic() + 60
    while len(processes) < PROCESSES and time.monotonic() < give_up:
        time.sleep(0.1)
        processes = descendants_of(client.pid)
    assert len(processes) == PROCESSES
    time.sleep(3)
    os.kill(client.pid, signalled)
    client.wait(10)
    assert ended(processes, START_SECONDS)


def test_models_of_laws_share_the_process_of_the_reference(monkeypatch) -> None:
    """They are the suite's own code: starting a process each would take longer than their work."""
    started = []

    class Counted(LocalWorker):
        def __init__(self, engine, *more):
            started.append(engine)
            super().__init__(engine, *more)

    monkeypatch.setattr(local_processes, "LocalWorker", Counted)
    names = ("pymunk@law:joint:default", "reference", "siconos@law")
    tasks = [steady(variant=name, cells=1) for name in names]
    with opened_store(None) as store, Evaluator(store, LocalExecutor(1)) as evaluator:
        assert {result.status for result in evaluator.evaluate(tasks)} == {"converged"}
    assert started == ["reference"]
