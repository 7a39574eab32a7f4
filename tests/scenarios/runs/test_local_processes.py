"""Engines that crash, hang, are killed or give no numbers: blocked with the reason, and everything else goes on."""

import re
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest

from multibody_xval.scenarios.runs import local_processes
from multibody_xval.scenarios.runs.local_processes import LocalExecutor, LocalWorker
from multibody_xval.scenarios.runs.result import LONGEST_REASON, Result
from multibody_xval.scenarios.runs.supervisor import PRINTED_BYTES
from multibody_xval.scenarios.runs.worker_template import START_SECONDS
from tests.scenarios.runs.builders import ended, evaluated, eventually, running, statuses

LIMIT = 8.0
"""Seconds that a batch may take: importing an engine and its compiled code takes some on a machine that is busy."""

PROCESSES = 5
"""Processes of an executor with two workers: a template, and a supervisor and the worker itself for each."""

RATIOS = (0.4, 0.5, 0.9)
"""Faulty engines that do not fail everywhere do so at the second one."""

pytestmark = pytest.mark.usefixtures("faulty")


def asked(*engines: str, ratios=RATIOS, workers: int = 2) -> dict[tuple[str, float], Result]:
    return evaluated(engines, ratios, LocalExecutor(workers, LIMIT))


HANGING = ("faulty-hang", "faulty-stopped", "faulty-disarms", "faulty-sending")
DEADLY = (
    "faulty-crash",
    "faulty-killed",
    "faulty-exits",
    "faulty-interrupts",
    "faulty-unspeakable",
    "faulty-mumbles",
    *HANGING,
)
HARMLESS = ("reference", "mujoco", "faulty-thread", "faulty-sound")
USELESS = ("faulty-nan", "faulty-version")


@pytest.fixture(scope="module")
def rows(faulty) -> dict[tuple[str, float], Result]:
    """Answers of engines that end, hang or are held up, together on four workers: their time limits pass at once."""
    begin = time.monotonic()
    results = asked(*DEADLY, *HARMLESS, *USELESS, workers=4)
    assert time.monotonic() - begin < 180  # a stopped process would never end
    return results


@pytest.mark.slow  # waits for processes
def test_an_engine_that_fails_in_whatever_way_blocks_its_own_points_only(rows) -> None:
    for (engine, eta), status in statuses(rows).items():
        blocked = engine in USELESS or (engine in DEADLY and eta == 0.5)
        assert status == ("blocked" if blocked else "converged"), (engine, eta)


@pytest.mark.slow  # waits for processes
@pytest.mark.parametrize(
    ("engine", "reason"),
    [
        ("faulty-crash", "the worker process crashed: Segmentation fault, in .*"),
        ("faulty-hang", rf"stopped at the time limit of {LIMIT:g} s, in run \(deadly\.py:.*"),
        ("faulty-killed", "the worker process was killed"),
        ("faulty-exits", "SystemExit: 0"),
        ("faulty-interrupts", "KeyboardInterrupt:"),
        ("faulty-unspeakable", r"UnspeakableError: its message cannot be read \(RuntimeError\)"),
        ("faulty-mumbles", r"OSError: no file \\udc80\\x1b\[2J"),
        ("faulty-nan", r"the engine's position is not finite at \S+ s in cell 1: nan"),
    ],
)
def test_whatever_ends_a_run_is_the_reason_of_its_point(rows, engine, reason) -> None:
    """An end of the program, an interrupt, an exception without words: in a worker all of them are the engine's."""
    assert re.fullmatch(reason, rows[engine, 0.5].reason)


@pytest.mark.slow  # waits for processes
@pytest.mark.parametrize("name", ["faulty-stopped", "faulty-disarms", "faulty-sending"])
def test_the_time_limit_holds_for_a_process_that_cannot_keep_it_itself(rows, name) -> None:
    """One is stopped, one has disarmed its alarm, one is stopped while it sends: all are ended from outside."""
    assert rows[name, 0.5].reason == f"stopped at the time limit of {LIMIT:g} s"


@pytest.mark.parametrize("engine", ["faulty-forks", "faulty-daemon"])
def test_an_engine_that_forks_or_starts_a_daemon_is_answered_once_and_leaves_no_process(notes, engine) -> None:
    """A daemon has a session of its own and no parent."""
    assert set(statuses(asked(engine, ratios=(0.4, 0.5))).values()) == {"converged"}
    assert not running(int((notes / "child").read_text()))


def test_what_an_engine_prints_and_says_is_cut(capfd) -> None:
    """A hundred megabytes on standard output, a million words in an error."""
    rows = asked("faulty-flood", "faulty-talks", ratios=(0.5,))
    printed, talks = capfd.readouterr().err, rows["faulty-talks", 0.5]
    assert rows["faulty-flood", 0.5].converged
    assert f"… ({100_000_000 - PRINTED_BYTES} bytes more)" in printed
    assert printed.count("~") == PRINTED_BYTES
    assert talks.status == "blocked"
    assert re.fullmatch(r"RuntimeError: (word )+.*… \(\d+ characters more\)", talks.reason)
    assert len(talks.reason) < LONGEST_REASON + 40


@pytest.mark.slow
def test_what_an_engine_does_to_its_process_is_felt_by_no_other() -> None:
    """One worker for both engines in turn: a process for each engine."""
    alone, after = (
        {name: result.transmittance_db for (name, _), result in asked(*names, ratios=(0.9,), workers=1).items()}
        for names in (("reference",), ("faulty-changes", "reference"))
    )
    assert after["reference"] == alone["reference"]
    assert after["faulty-changes"] != pytest.approx(alone["reference"], abs=0.1)


@pytest.mark.slow  # waits for processes
def test_engine_of_another_version_in_the_worker_is_blocked_with_both_named(rows) -> None:
    reason = rows["faulty-version", 0.9].reason.removeprefix("not the same in the worker: ")
    here, expected = reason.split("; expected: ")
    assert here.startswith("faulty-version 9.9.9, Python ")
    assert expected == here.replace("9.9.9", "1.0.0")


@pytest.mark.slow
def test_engine_that_dies_at_point_after_point_is_not_asked_forever() -> None:
    """The same point in ever other digits: each is a question of its own, and each kills."""
    near = [0.5 + k * 1e-12 for k in range(6)]
    rows = asked("faulty-killed", "reference", ratios=near)
    reasons = [rows["faulty-killed", eta].reason for eta in near]
    assert reasons.count("the worker process was killed") >= 3
    assert "not run: 3 points before, the worker process was killed" in reasons
    assert all(rows["reference", eta].converged for eta in near)


def descendants_of(process: int) -> set[int]:
    try:
        children = {int(child) for child in Path(f"/proc/{process}/task/{process}/children").read_text().split()}
    except FileNotFoundError:
        return set()
    return children.union(*map(descendants_of, children))


CLIENT = """
import signal
from multibody_xval.scenarios.runs.local_processes import LocalExecutor
from tests.scenarios.runs.builders import evaluated
# a shell's background jobs ignore Ctrl-C, and so would all that they start
signal.signal(signal.SIGINT, signal.default_int_handler)
evaluated(["faulty-hang", "faulty-disarms"], [0.5], LocalExecutor(2, 600.0))
"""


@pytest.mark.slow  # waits for processes
@pytest.mark.skipif(not Path("/proc/self/task").is_dir(), reason="needs Linux's list of processes")
@pytest.mark.parametrize("signalled", [signal.SIGKILL, signal.SIGINT], ids=["killed", "interrupted"])
def test_workers_end_with_their_client(signalled) -> None:
    """kill −9 leaves no time to say goodbye, Ctrl-C must not wait for a batch; nothing may compute for nobody."""
    with subprocess.Popen([sys.executable, "-c", CLIENT], stderr=subprocess.DEVNULL) as client:
        try:
            assert eventually(lambda: len(descendants_of(client.pid)) == PROCESSES, START_SECONDS)
            time.sleep(3)
            processes = descendants_of(client.pid)
            client.send_signal(signalled)
            client.wait(10)
        finally:
            client.kill()
    assert len(processes) == PROCESSES
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
    assert set(statuses(evaluated(names, (0.9,), LocalExecutor(1))).values()) == {"converged"}
    assert started == ["reference"]
