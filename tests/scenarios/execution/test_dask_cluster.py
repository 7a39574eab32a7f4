"""The workers of a dask cluster, started by hand on a port of its own: the same answers, bit for bit."""

import contextlib
import re
import subprocess
import sys
import time
from collections.abc import Iterator

import pytest

from engines.interface.variant import Variant
from reference_lcp import ParameterError
from scenarios.execution.evaluator import Evaluator
from scenarios.execution.local_processes import LocalExecutor
from scenarios.execution.store import ResultStore
from scenarios.tasks.parameters import ChainRatios
from scenarios.tasks.task import SteadyStateTask

pytest.importorskip("distributed")
from scenarios.execution.dask_cluster import DaskExecutor


@contextlib.contextmanager
def started(module: str, *options: str, environment=None, says: str) -> Iterator[str]:
    """Run a command of dask until the end of the context; gives what matched in its output."""
    process = subprocess.Popen(
        [sys.executable, "-m", module, *options], stderr=subprocess.PIPE, text=True, env=environment
    )
    try:
        for line in process.stderr:
            found = re.search(says, line)
            if found:
                yield found[0]
                break
        else:
            raise AssertionError(f"{module} ended without {says!r}")
    finally:
        process.terminate()
        process.wait()
        process.stderr.close()


@pytest.fixture(scope="module")
def scheduler(install) -> Iterator[str]:
    """Address of a scheduler with two workers, for which the faulty engines are installed."""
    environment = install("faulty").environment
    quiet = ("--no-dashboard",)
    with started("distributed.cli.dask_scheduler", "--port", "0", *quiet, says=r"tcp://\S+:\d+") as address:
        options = ("--nworkers", "2", "--nthreads", "1", *quiet)
        with started(
            "distributed.cli.dask_worker", address, *options, environment=environment, says="Registered to|Starting"
        ):
            time.sleep(5)
            yield address


def task(eta: float, name: str = "mujoco") -> SteadyStateTask:
    return SteadyStateTask(variant=Variant(name), friction_ratio=0.3, frequency_ratio=eta, ratios=ChainRatios(cells=2))


def test_cluster_and_local_processes_give_the_same_table(scheduler, tmp_path) -> None:
    asked = [task(eta, name) for eta in (0.4, 0.6, 0.9) for name in ("mujoco", "reference")]
    tables = []
    for name, executor in (("local", LocalExecutor(2)), ("cluster", DaskExecutor(scheduler))):
        with ResultStore(tmp_path / f"{name}.sqlite") as store, Evaluator(store, executor) as evaluator:
            tables.append([(a.transmittance_db, a.residual, a.transitions) for a in evaluator.evaluate(asked)])
    assert tables[0] == tables[1]


def test_nobody_at_the_address_is_an_error_that_names_it(monkeypatch) -> None:
    monkeypatch.setattr("scenarios.execution.dask_cluster.CONNECT_SECONDS", 1)
    with pytest.raises(ParameterError, match=r"scheduler = 'tcp://127.0.0.1:9' cannot be reached"):
        DaskExecutor("tcp://127.0.0.1:9")
    with pytest.raises(ParameterError, match="scheduler = 'nonsense:nonsense' cannot be reached"):
        DaskExecutor("nonsense:nonsense")
