"""Workers of a dask cluster that runs already, on this machine or on many."""

import tempfile
from concurrent.futures import Future
from pathlib import Path
from typing import Any

from reference_lcp.validation import ParameterError
from scenarios.execution.local_processes import TIME_LIMIT, Batch, Executor, LocalExecutor, WorkerDied, answer_within
from scenarios.tasks.result import Result

CONNECT_SECONDS = 15
"""How long a scheduler may take to answer."""


def executor_for(workers: int | None, time_limit: float, scheduler: str | None) -> Executor:
    """Give the workers of a scheduler where one is named, processes on this machine otherwise.

    Raises
    ------
    ParameterError
        If a number is outside its range, both workers and a scheduler are named, or the scheduler cannot be used.
    """
    if scheduler is None:
        return LocalExecutor(workers, time_limit)
    if workers is not None:
        raise ParameterError(f"workers = {workers} with scheduler = {scheduler!r}; allowed: one of the two")
    return DaskExecutor(scheduler, time_limit)


class DaskExecutor(Executor):
    """The workers of a dask scheduler: as many batches on the way as there are workers.

    A task whose worker dies is given to another one as often as the scheduler allows
    (``distributed.scheduler.allowed-failures``), and is blocked then. Workers need this suite and the engines.

    Parameters
    ----------
    address
        Of the scheduler, such as ``tcp://node1:8786``.
    time_limit
        Seconds that a batch may take, > 0; the worker is ended then, and its nanny starts another.

    Raises
    ------
    ParameterError
        If dask.distributed is not installed, nobody answers at the address, or the scheduler has no workers.
    """

    def __init__(self, address: str, time_limit: float = TIME_LIMIT):
        self._client = _connected(address)
        workers = len(self._client.scheduler_info(n_workers=-1)["workers"])
        if workers == 0:
            self._client.close()
            raise ParameterError(f"scheduler = {address!r} has no workers; allowed: at least one")
        worker = DaskWorker(self._client)
        super().__init__(lambda _place: worker, workers, time_limit)

    def close(self) -> None:
        """Leave the cluster; it goes on without us."""
        super().close()
        self._client.close()


class DaskWorker:
    """Whichever worker the scheduler chooses."""

    def __init__(self, client: Any):
        self._executor = client.get_executor(pure=False, retries=0)

    def submit(self, batch: Batch, limit: float) -> Future[list[Result]]:
        """Give the batch to the scheduler."""
        future: Future[list[Result]] = self._executor.submit(answer_on_cluster, batch, limit)
        return future

    def result(self, future: Future[list[Result]], limit: float) -> list[Result]:
        """Give the answers, or say that workers died of this batch."""
        from distributed import KilledWorker

        try:
            return future.result()
        except KilledWorker:
            raise WorkerDied(f"workers of the cluster died: a crash, or the time limit of {limit:g} s") from None

    def close(self) -> None:
        """Take back what is not begun."""
        self._executor.shutdown(wait=False)


def answer_on_cluster(batch: Batch, limit: float) -> list[Result]:
    """Answer a batch in a worker of the cluster."""
    with tempfile.TemporaryDirectory() as folder:
        return answer_within(batch, limit, Path(folder) / "note")


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
            f"scheduler = {address!r} does not answer: {problem}; allowed: the address of a dask scheduler"
        ) from None
