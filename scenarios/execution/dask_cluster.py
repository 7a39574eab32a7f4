"""Workers of a dask cluster that runs already, on this machine or on many."""

from collections.abc import Collection
from concurrent.futures import FIRST_COMPLETED, Future, wait
from typing import Any

from reference_lcp.validation import ParameterError, shown
from scenarios.execution.batch import Batch
from scenarios.execution.executor import TIME_LIMIT, WorkerDied, WorkerExecutor
from scenarios.execution.identity import identity_of
from scenarios.execution.local_processes import LocalExecutor
from scenarios.execution.worker import run_on_cluster
from scenarios.tasks.result import Result

CONNECT_SECONDS = 15
"""How long connecting to a scheduler may take."""


def executor_for(workers: int | None, time_limit: float, scheduler: str | None) -> "LocalExecutor | DaskExecutor":
    """Give the workers of a scheduler where one is named, processes on this machine otherwise.

    Raises
    ------
    ParameterError
        If a number is outside its range, both workers and a scheduler are named, or the scheduler cannot be used.
    """
    if scheduler is None:
        return LocalExecutor(workers, time_limit)
    if not isinstance(scheduler, str):
        raise ParameterError(f"scheduler = {shown(scheduler)}; allowed: an address such as 'tcp://node1:8786'")
    if workers is not None:
        raise ParameterError(f"workers = {workers} with scheduler = {scheduler!r}; allowed: one of the two")
    return DaskExecutor(scheduler, time_limit)


class DaskExecutor(WorkerExecutor["Future[list[Result]]"]):
    """The workers of a dask scheduler: as many batches on the way as there are workers.

    A batch whose worker dies is given to another one as often as the scheduler allows
    (``distributed.scheduler.allowed-failures``), and is blocked then. Workers need this suite and the engines, in the
    same versions; the points of an engine that differs are blocked. The scheduler and its workers must be trusted.

    Parameters
    ----------
    address
        Of the scheduler, such as ``tcp://node1:8786``.
    time_limit
        Seconds that a batch may take, > 0; the worker is ended then, and its nanny starts another.

    Raises
    ------
    ParameterError
        If dask.distributed is not installed, there is no scheduler at the address, or the scheduler has no workers.
    """

    def __init__(self, address: str, time_limit: float = TIME_LIMIT):
        self._client = _connected(address)
        workers = len(self._client.scheduler_info(n_workers=-1)["workers"])
        if workers == 0:
            self._client.close()
            raise ParameterError(f"scheduler = {address!r} has no workers; allowed: at least one")
        super().__init__(workers, time_limit)
        self._futures = self._client.get_executor(pure=False, retries=0)

    def close(self) -> None:
        """Cancel what is not begun, and disconnect; the cluster goes on."""
        self._futures.shutdown(wait=False)
        self._client.close()

    def _start(self, batch: Batch) -> Future[list[Result]]:
        identity = identity_of(batch[0].variant)
        future: Future[list[Result]] = self._futures.submit(run_on_cluster, batch, identity, self._limit)
        return future

    def _finished(self, running: Collection[Future[list[Result]]]) -> Collection[Future[list[Result]]]:
        return wait(running, return_when=FIRST_COMPLETED).done

    def _results(self, run: Future[list[Result]]) -> list[Result]:
        from distributed import KilledWorker

        try:
            return run.result()
        except KilledWorker:
            problem = f"workers of the cluster died: a crash, or the time limit of {self._limit:g} s"
            raise WorkerDied(problem) from None

    def _abandon(self, run: Future[list[Result]]) -> None:
        run.cancel()


def _connected(address: str) -> Any:
    """Connect to the scheduler."""
    try:
        from distributed import Client
    except ImportError:
        raise ParameterError(
            f"scheduler = {address!r}: dask.distributed is not installed; pip install 'multibody-xval[cluster]'"
        ) from None
    try:
        return Client(address, timeout=CONNECT_SECONDS)  # type: ignore[no-untyped-call]
    except (OSError, ValueError) as problem:
        raise ParameterError(
            f"scheduler = {address!r} cannot be reached: {problem}; allowed: the address of a dask scheduler"
        ) from None
