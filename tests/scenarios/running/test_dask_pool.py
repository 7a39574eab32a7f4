"""Two workers of a dask cluster on this machine: the same answers, and one line where something is wrong."""

import contextlib
import json
import re
import subprocess
import sys
import threading
import time
from collections.abc import Iterator
from pathlib import Path

import pytest

from multibody_xval.scenarios.model import REFERENCE, Case, Config, Run, Status
from multibody_xval.scenarios.output_files import RunError
from multibody_xval.scenarios.running.evaluate import Means, computed, stored_results
from reference_lcp.errors import ParameterError

pytest.importorskip("distributed")
pytestmark = pytest.mark.slow  # processes that start and end

STEPS = 100


@contextlib.contextmanager
def running(
    module: str, *options: str, environment: dict[str, str], says: str
) -> Iterator[tuple[str, subprocess.Popen]]:
    """Run a command of dask to the end of the context; gives what matched in its output, and its process."""
    command = [sys.executable, "-m", module, *options, "--no-dashboard"]
    with subprocess.Popen(command, stderr=subprocess.PIPE, text=True, env=environment) as process:
        try:
            yield next(found[0] for line in process.stderr if (found := re.search(says, line))), process
        finally:
            process.terminate()


@pytest.fixture
def cluster(install) -> Iterator[tuple[str, subprocess.Popen]]:
    """Address and process of a scheduler with two workers, for which the deadly engines are installed."""
    environment = install("faulty").environment
    scheduler = running("distributed.cli.dask_scheduler", "--port=0", environment=environment, says=r"tcp://\S+:\d+")
    with install("faulty").visible(), scheduler as (address, process):
        options = (address, "--nworkers=2", "--nthreads=1")
        with running("distributed.cli.dask_worker", *options, environment=environment, says="Registered to"):
            yield address, process


def runs_of(name: str, *frequency_ratios: float) -> list[Run]:
    cases = [Case(friction_ratio=0.3, frequency_ratio=eta, cells=2) for eta in frequency_ratios]
    return [Run(Config(name), case, STEPS) for case in cases]


def test_the_answers_are_those_of_this_machine(cluster) -> None:
    runs = [*runs_of("mujoco", 0.4, 0.6, 0.9), *runs_of(REFERENCE.engine, 0.4, 0.6, 0.9)]
    here, there = (
        {own.run: json.loads(own.result.to_json()) | {"seconds": 0} for own in computed(runs, means)}
        for means in (Means(workers=2), Means(scheduler=cluster[0]))
    )
    assert here == there


def test_a_run_that_hangs_or_crashes_fails_alone(cluster) -> None:
    runs = [run for name in ("faulty-hang", "faulty-crash") for run in runs_of(name, 0.5, 0.6)]
    hung, sound, crashed, other = (own.result for own in computed(runs, Means(scheduler=cluster[0], seconds_a_run=3.0)))
    assert sound.status is other.status is Status.PERIODIC
    assert hung.status is crashed.status is Status.FAILED
    assert "time limit" in hung.reason
    assert "SIGSEGV" in crashed.reason


def test_nobody_at_the_address_is_a_line_and_is_no_longer_asked(monkeypatch) -> None:
    monkeypatch.setattr("multibody_xval.scenarios.running.dask_pool.CONNECT_SECONDS", 1)
    with pytest.raises(ParameterError, match=r"scheduler = 'tcp://127.0.0.1:9' cannot be reached"):
        computed(runs_of("mujoco", 0.9), Means(scheduler="tcp://127.0.0.1:9"))
    with pytest.raises(ParameterError, match="cannot be reached"):
        computed(runs_of("mujoco", 0.9), Means(scheduler="-1"))
    with pytest.raises(ValueError, match="No client"):
        pytest.importorskip("distributed").default_client()


def test_a_scheduler_that_dies_ends_the_command_in_a_line_and_keeps_what_is_stored(cluster, tmp_path: Path) -> None:
    address, scheduler = cluster
    store, many = tmp_path / "results.sqlite", [0.3 + number / 4000 for number in range(4000)]

    def killed() -> None:
        while not store.exists() or not stored_results(store):
            time.sleep(0.2)
        scheduler.kill()

    threading.Thread(target=killed, daemon=True).start()
    begin = time.monotonic()
    with pytest.raises(RunError, match="is lost; what is stored stays"):
        computed(runs_of(REFERENCE.engine, *many), Means(scheduler=address, store=store))
    assert time.monotonic() - begin < 120
    assert len(stored_results(store)) > 0
