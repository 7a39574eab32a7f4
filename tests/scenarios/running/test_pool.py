"""What one run does to its process is its own: the others have their results, and no process stays behind."""

import contextlib
import os
import subprocess
import sys
import time
from collections.abc import Iterator
from pathlib import Path

import pytest

from multibody_xval.scenarios.model import Case, Config, Result, Run, Status
from multibody_xval.scenarios.running.pool import run_missing
from multibody_xval.scenarios.running.processes import LocalPool, local
from multibody_xval.scenarios.store import opened

pytestmark = pytest.mark.skipif(sys.platform != "linux", reason="processes are looked at as Linux has them")

DEADLY, OTHERS = 0.5, (0.6, 0.9)
"""Frequency ratio at which the engines of this family fail, and some at which they do not."""

STEPS = 100
LIMIT = 5.0
"""Time limit of a run that hangs [s]."""

PATIENT = 60.0
"""Time limit of all others [s]: a process that begins anew may take long on a machine that is busy."""


@pytest.fixture(scope="module")
def child(install, tmp_path_factory) -> Iterator[Path]:
    """Show the engines of this family to all processes, and give the file in which they note what they leave behind."""
    file = tmp_path_factory.mktemp("faulty") / "child"
    with install("faulty").visible(), pytest.MonkeyPatch.context() as environment:
        environment.setenv("FAULTY_CHILD", str(file))
        yield file


@pytest.fixture(scope="module")
def pool(child) -> Iterator[LocalPool]:
    with local(2) as opened:
        yield opened


def ran(name: str, pool: LocalPool, file: Path | None = None, limit: float = PATIENT) -> dict[float, Result]:
    """Run an engine at all frequency ratios; gives its results by these."""
    config = Config(name)
    runs = [Run(config, Case(friction_ratio=0.3, frequency_ratio=eta, cells=2), STEPS) for eta in (DEADLY, *OTHERS)]
    with opened(file) as store:
        found = run_missing(runs, store, pool, seconds_a_run=limit)
    return {run.case.frequency_ratio: found[run] for run in runs}


@pytest.mark.parametrize(
    ("name", "reason"),
    [
        ("faulty-crash", "its process has ended by signal SIGSEGV"),
        pytest.param("faulty-hang", "no result within the time limit", marks=pytest.mark.slow),
        pytest.param("faulty-stopped", "no result within the time limit", marks=pytest.mark.slow),
        ("faulty-exits", "SystemExit"),
        ("faulty-killed", "its process has ended by signal SIGKILL"),
        ("faulty-unspeakable", "UnspeakableError"),
        ("faulty-mumbles", "no file"),
        ("faulty-leaves", "its process has ended with exit code 0"),
        ("faulty-interrupts", "KeyboardInterrupt"),
    ],
)
def test_a_run_that_ends_its_process_fails_alone(pool, name, reason) -> None:
    results = ran(name, pool, limit=LIMIT if "time limit" in reason else PATIENT)
    assert results[DEADLY].status is Status.FAILED
    assert reason in results[DEADLY].reason
    assert {results[eta].status for eta in OTHERS} == {Status.PERIODIC}


@pytest.mark.parametrize("name", ["faulty-flood", "faulty-forks", "faulty-thread", "faulty-sound"])
def test_what_an_engine_prints_or_changes_does_no_harm(pool, name, capfd) -> None:
    assert {own.status for own in ran(name, pool).values()} == {Status.PERIODIC}
    assert not any(capfd.readouterr())


def test_a_copy_that_an_engine_has_forked_of_its_process_takes_no_other_run(pool) -> None:
    """It would die unnoticed, and its runs wait for their time limit."""
    ran("faulty-forks", pool)
    for _ in range(4):
        begin = time.monotonic()
        assert "by signal SIGKILL" in ran("faulty-killed", pool)[DEADLY].reason
        assert time.monotonic() - begin < PATIENT


def running_names() -> set[str]:
    """Give the names of all processes."""
    names = set()
    for file in Path("/proc").glob("[0-9]*/comm"):
        with contextlib.suppress(OSError):
            names.add(file.read_text().strip())
    return names


@pytest.mark.slow  # waits until the pool is given up
def test_half_a_result_in_the_pipe_of_a_pool_ends_its_run_alone_and_no_process_stays_behind(child, monkeypatch) -> None:
    monkeypatch.setattr("multibody_xval.scenarios.running.pool.GRACE", 2.0)
    with local(2) as pool:
        ran("faulty-sound", pool)
        names = set(pool._names.values())
        results = ran("faulty-sending", pool, limit=LIMIT)
        assert results[DEADLY].status is Status.FAILED
        assert {results[eta].status for eta in OTHERS} == {Status.PERIODIC}
        assert {own.status for own in ran("faulty-sound", pool).values()} == {Status.PERIODIC}
        assert names.isdisjoint(pool._names.values()), "the pool was given up"
        names |= set(pool._names.values())
    assert names.isdisjoint(running_names())


def test_a_worker_that_was_killed_is_not_stored_and_tried_again(pool, tmp_path: Path) -> None:
    first = ran("faulty-killed", pool, tmp_path / "results.sqlite")
    with opened(tmp_path / "results.sqlite") as store:
        again = list(store.rows())
    assert first[DEADLY].circumstance
    assert sorted(row.run.case.frequency_ratio for row in again) == sorted(OTHERS)


@pytest.mark.slow
def test_what_workers_leave_behind_is_ended_and_other_children_are_not(child) -> None:
    own = subprocess.Popen([sys.executable, "-c", "import time; time.sleep(60)"])
    try:
        with local(1) as pool:
            ran("faulty-daemon", pool)
        assert own.poll() is None
        daemon = int(child.read_text())
        with pytest.raises(ProcessLookupError):
            os.kill(daemon, 0)
    finally:
        own.kill()
        own.wait()
