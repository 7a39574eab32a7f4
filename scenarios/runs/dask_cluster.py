"""Workers of a dask cluster that runs already, on this machine or on many."""

import asyncio
import contextlib
import logging
import sys
import threading
import time
from collections.abc import Collection
from concurrent.futures import FIRST_COMPLETED, CancelledError, wait
from functools import partial
from typing import Any

from multibody_xval.scenarios.runs import TIME_LIMIT
from multibody_xval.scenarios.runs.executor import Batch, Executor, InProcessExecutor, Run, WorkerDied, WorkerExecutor
from multibody_xval.scenarios.runs.failures import ExecutorError
from multibody_xval.scenarios.runs.local_processes import LocalExecutor, unavailable_reason
from multibody_xval.scenarios.runs.result import Result
from multibody_xval.scenarios.runs.worker import identity_of
from reference_lcp.errors import ParameterError, shown, text_of

_own = threading.local()
"""The processes of each thread of the worker."""


def run_on_cluster(batch: Batch, identity: str, limit: float) -> list[Result]:
    """Run a batch as on the client's machine; see `LocalExecutor.run_for_client`."""
    executor: LocalExecutor = vars(_own).setdefault("executor", LocalExecutor(1))  # which starts nothing so far
    return executor.run_for_client(batch, identity, limit)


LOST = (Exception, asyncio.CancelledError)
"""What a client raises that has lost its scheduler: in short, anything, and what ends its own coroutines."""

NOISY = (
    "concurrent.futures",
    "distributed",
    "distributed.client",
    "distributed.core",
    "distributed.utils",
    "tornado.application",
    "asyncio",
)
"""Loggers that print tracebacks where a scheduler is lost, which this module says in one line."""

CONNECT_SECONDS = 15
"""How long connecting to a scheduler may take."""

REPLY_SECONDS = 5
"""How long a scheduler may take to say which workers it has."""

CHECK_SECONDS = 1
"""Interval at which it is asked while nothing ends."""

LOST_SECONDS = 30
"""How long a cluster may have no worker: a nanny starts a new one in a few seconds."""

CLOSE_SECONDS = 1
"""How long disconnecting may take, from a scheduler that does not reply either."""


def executor_for(workers: int | None = None, time_limit: float = TIME_LIMIT, scheduler: str | None = None) -> Executor:
    """Give the workers of a scheduler where one is named, or those of this machine, or this process where it has none.

    Without processes there is one worker, and nothing is stopped at the limit; more workers are refused.
    """
    if scheduler is None:
        executor = LocalExecutor(workers, time_limit)  # it starts nothing so far
        reason = unavailable_reason()
        if reason is None:
            return executor
        if workers not in (None, 1):
            raise ParameterError(f"workers = {workers}; allowed here: 1, since {reason}")
        print(f"{reason}: one that crashes or hangs ends the command; what is stored stays", file=sys.stderr)
        return InProcessExecutor()
    if not isinstance(scheduler, str):
        raise ParameterError(f"scheduler = {shown(scheduler)}; allowed: an address such as 'tcp://node1:8786'")
    if workers is not None:
        raise ParameterError(f"workers = {workers} with scheduler = {scheduler!r}; allowed: one of the two")
    return DaskExecutor(scheduler, time_limit)


class DaskExecutor(WorkerExecutor):
    """The workers of a dask scheduler: as many batches on the way as there are workers.

    A worker of the cluster gives each batch to a process of its own machine, which serves one engine, and is ended at
    the time limit, as those of `LocalExecutor` are. Workers need this suite and the engines, in the same versions; the
    points of an engine that differs are blocked. The scheduler and its workers must be trusted: what they send is
    unpickled, which can run anything. An address without them is refused.
    """

    def __init__(self, address: str, time_limit: float = TIME_LIMIT):
        self._address = address
        self._client = _connected(address)
        workers = self._workers()
        if workers == 0:
            self._client.close()
            raise ParameterError(f"scheduler = {address!r} has no workers; allowed: at least one")
        super().__init__(workers, time_limit)
        self._futures = self._client.get_executor(pure=False, retries=0)
        self._last_worker = time.monotonic()

    def close(self) -> None:
        """Cancel what is not begun, and disconnect; the cluster goes on, and one that is lost needs neither."""
        for leave in (partial(self._futures.shutdown, wait=False), partial(self._client.close, timeout=CLOSE_SECONDS)):
            with contextlib.suppress(*LOST):
                leave()

    def _start(self, batch: Batch) -> Run:
        identity = identity_of(batch[0].variant)
        try:
            run: Run = self._futures.submit(run_on_cluster, batch, identity, self._limit)
        except LOST as problem:  # the client is closed once it has lost its scheduler
            raise self._lost(text_of(problem)) from None
        return run

    def _wait(self, running: Collection[Run]) -> None:
        """Wait; raise `ExecutorError` if the scheduler or its last worker stay away."""
        while not wait(running, CHECK_SECONDS, FIRST_COMPLETED).done:
            if self._workers() > 0:
                self._last_worker = time.monotonic()
            elif time.monotonic() > self._last_worker + LOST_SECONDS:
                raise self._lost(f"no worker for {LOST_SECONDS:g} s")

    def _results(self, run: Run) -> list[Result]:
        from distributed import KilledWorker

        try:
            return run.result()
        except WorkerDied:
            raise
        except KilledWorker:
            raise WorkerDied("workers of the cluster died") from None
        except CancelledError:
            raise self._lost("the connection is closed") from None
        except Exception as problem:  # such as a worker that has no suite
            raise WorkerDied(f"the cluster's worker failed: {type(problem).__name__}: {text_of(problem)}") from None

    def _abandon(self, running: Collection[Run]) -> None:
        for run in running:
            with contextlib.suppress(*LOST):
                run.cancel()

    def _workers(self) -> int:
        """Give the number of workers; 0 if the scheduler does not say."""
        try:
            identity = self._client.sync(self._client.scheduler.identity, n_workers=-1, callback_timeout=REPLY_SECONDS)
        except LOST:  # it cannot be reached, or is about to be given up by the client
            return 0
        return len(identity["workers"])

    def _lost(self, what: str) -> ExecutorError:
        return ExecutorError(f"scheduler = {self._address!r} is lost: {what}")


def _connected(address: str) -> Any:
    try:
        from distributed import Client
    except ImportError:
        raise ParameterError(
            f"scheduler = {address!r}: distributed is not installed; pip install '.[cluster]' in the suite's folder"
        ) from None
    for name in NOISY:
        logging.getLogger(name).setLevel(logging.CRITICAL)
    try:
        return Client(address, timeout=CONNECT_SECONDS, set_as_default=False)  # type: ignore[no-untyped-call]
    except (OSError, ValueError) as problem:
        raise ParameterError(
            f"scheduler = {address!r} cannot be reached: {problem}; allowed: the address of a dask scheduler"
        ) from None
