"""The workers of a dask cluster, started by hand on a port of its own: the same answers, bit for bit."""

import asyncio
import contextlib
import re
import sqlite3
import subprocess
import sys
import time
from collections.abc import Iterator
from pathlib import Path

import pytest

from multibody_xval.scenarios.runs.local_processes import LocalExecutor
from reference_lcp import ParameterError
from reference_lcp.errors import ExitCode
from tests.scenarios.runs.builders import evaluated, eventually, numbers, statuses

pytest.importorskip("distributed")
from distributed import default_client

from multibody_xval.scenarios.runs.dask_cluster import CLOSE_SECONDS, DaskExecutor


@contextlib.contextmanager
def running(module: str, *options: str, environment=None, says: str) -> Iterator[tuple[subprocess.Popen[str], str]]:
    """Run a command of dask until the end of the context; gives the process, and what matched in its output."""
    process = subprocess.Popen(
        [sys.executable, "-m", module, *options], stderr=subprocess.PIPE, text=True, env=environment
    )
    try:
        for line in process.stderr:
            found = re.search(says, line)
            if found:
                yield process, found[0]
                break
        else:
            raise AssertionError(f"{module} ended without {says!r}")
    finally:
        process.terminate()
        process.wait()
        process.stderr.close()


@contextlib.contextmanager
def cluster(*options: str, environment=None) -> Iterator[tuple[str, dict[str, subprocess.Popen[str]]]]:
    """Run a scheduler with a command that starts its workers; gives its address, and both processes."""
    quiet = ("--nthreads", "1", "--no-dashboard")
    with running("distributed.cli.dask_scheduler", "--port", "0", quiet[2], says=r"tcp://\S+:\d+") as scheduler:
        command = ("distributed.cli.dask_worker", scheduler[1], *quiet, *options)
        with running(*command, environment=environment, says="Registered to") as worker:
            yield scheduler[1], {"scheduler": scheduler[0], "worker": worker[0]}


@pytest.fixture(scope="module")
def scheduler(install) -> Iterator[str]:
    """Address of a scheduler with two workers, for which the faulty engines are installed."""
    environment = {**install("mutations").environment, "FAULTY_VERSION": "9.9.9"}
    with cluster("--nworkers", "2", environment=environment) as (address, _):
        yield address


@pytest.mark.slow  # waits for processes
def test_cluster_and_local_processes_give_the_same_table(scheduler) -> None:
    executors = LocalExecutor(2), DaskExecutor(scheduler)
    here, there = (numbers(("mujoco", "reference"), (0.4, 0.6, 0.9), executor) for executor in executors)
    assert here == there


@pytest.mark.slow
def test_engine_of_another_version_on_the_cluster_is_blocked_with_both_named(scheduler, faulty) -> None:
    results = evaluated(["faulty-sound", "faulty-version"], (0.9,), DaskExecutor(scheduler, 5.0))
    assert list(statuses(results).values()) == ["converged", "blocked"]
    reason = results["faulty-version", 0.9].reason
    assert reason.startswith("not the same in the worker: faulty-version 9.9.9, Python ")
    assert "; expected: faulty-version 1.0.0, Python " in reason


@pytest.mark.slow  # waits for processes
def test_an_engine_prepares_itself_on_the_cluster_in_no_tasks_time(scheduler, faulty) -> None:
    """One takes 6 s, where a batch may take 5; the other does not end within the 2 s that it names."""
    results = evaluated(["faulty-slowly-ready", "faulty-never-ready"], (0.9,), DaskExecutor(scheduler, 5.0))
    assert list(statuses(results).values()) == ["converged", "blocked"]
    reason = results["faulty-never-ready", 0.9].reason
    assert reason.startswith("Sound compiles nothing: stopped at the time limit of 2 s, in prepare")


def test_nobody_at_the_address_is_an_error_that_names_it(monkeypatch) -> None:
    monkeypatch.setattr("multibody_xval.scenarios.runs.dask_cluster.CONNECT_SECONDS", 1)
    with pytest.raises(ParameterError, match=r"scheduler = 'tcp://127.0.0.1:9' cannot be reached"):
        DaskExecutor("tcp://127.0.0.1:9")
    with pytest.raises(ParameterError, match="scheduler = 'nonsense:nonsense' cannot be reached"):
        DaskExecutor("nonsense:nonsense")
    with pytest.raises(ValueError, match="No client"):  # what else uses dask in this process does not meet it
        default_client()


@pytest.mark.slow
@pytest.mark.parametrize("problem", [OSError, TimeoutError, asyncio.CancelledError])
def test_leaving_a_lost_cluster_raises_nothing_that_hides_why_it_is_lost(scheduler, monkeypatch, problem) -> None:
    executor, closed = DaskExecutor(scheduler), []

    def lost(*_: object) -> None:
        raise problem

    monkeypatch.setattr(executor._client, "cancel", lost)
    monkeypatch.setattr(executor._client, "close", lambda **how: closed.append(how))
    monkeypatch.setattr(executor._client, "sync", lost)
    assert executor._workers() == 0
    executor.close()
    assert closed == [{"timeout": CLOSE_SECONDS}]


LARGE = """
engines = ["mujoco:joint:tuned"]
[grid]
friction_ratio = [0.1, 0.3, 0.6, 1.0]
frequency_ratio = { first = 0.3, last = 1.6, points = 1000 }
"""

LOST_WITHIN = 60.0
"""Seconds within which a command has to notice that its cluster is lost."""


def has_a_result(store: Path) -> bool:
    with contextlib.suppress(sqlite3.Error), contextlib.closing(sqlite3.connect(store)) as connection:
        return connection.execute("SELECT count(*) FROM results").fetchone()[0] > 0
    return False


@pytest.mark.slow
@pytest.mark.parametrize("lost", ["scheduler", "worker"])
def test_lost_cluster_ends_a_sweep_within_a_minute_with_one_line(tmp_path, lost) -> None:
    (tmp_path / "sweep.toml").write_text(LARGE)
    store = tmp_path / "sweep.sqlite"
    with cluster("--nworkers", "1", "--no-nanny") as (address, processes):
        command = [sys.executable, "-m", "multibody_xval", "sweep", "sweep.toml", "--scheduler", address]
        sweep = subprocess.Popen(command, cwd=tmp_path, stderr=subprocess.PIPE, text=True)
        assert eventually(lambda: has_a_result(store), within=120)
        processes[lost].kill()
        begin = time.monotonic()
        _, error = sweep.communicate(timeout=2 * LOST_WITHIN)
        assert time.monotonic() - begin < LOST_WITHIN
    assert sweep.returncode == ExitCode.RUN_FAILED, error
    lines = [line for line in error.splitlines() if line.startswith("error: ")]
    assert len(lines) == 1
    assert "is lost" in lines[0]
    assert "Traceback" not in error
    assert has_a_result(store)
