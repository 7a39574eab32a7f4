"""The workers of a dask cluster, each of which runs what it gets in processes of its own machine."""

import multiprocessing
import time
from collections.abc import Iterator
from concurrent.futures import BrokenExecutor, Future, wait
from contextlib import contextmanager
from typing import Any

from multibody_xval.scenarios.processes import GRACE, LOOK_SECONDS, Job, LocalPool
from reference_lcp.errors import ParameterError, shown

CONNECT_SECONDS = 15
"""How long a scheduler may take to answer."""


class DaskPool:
    """The workers of a dask cluster."""

    def __init__(self, client: Any):
        self._executor = client.get_executor(pure=False, retries=0)
        self.slots = max(1, len(client.scheduler_info()["workers"]))

    def submit(self, job: Job) -> "Future[Any]":
        """Start a job on any worker."""
        future: Future[Any] = self._executor.submit(isolated, job)
        return future

    def is_lost(self, serves: str) -> bool:
        """Never: workers see that themselves."""
        return False

    def give_up(self, serves: str) -> None:
        """Leave it: workers end what passes its limit themselves."""


@contextmanager
def dask(address: str) -> Iterator[DaskPool]:
    """Give the workers of a dask cluster that runs already; it and its workers have to be trusted."""
    from distributed import Client

    try:
        client = Client(address, timeout=f"{CONNECT_SECONDS}s")  # type: ignore[no-untyped-call]
    except (OSError, ValueError) as problem:
        reason = " ".join(str(problem).split())
        raise ParameterError(
            f"scheduler = {shown(address)} cannot be reached: {reason}; allowed: the address of one that runs"
        ) from None
    with client:
        yield DaskPool(client)


def isolated(job: Job) -> Any:
    """Run a job in a worker process that is kept from call to call; what it raises is raised here."""
    if not _KEPT:
        multiprocessing.current_process()._config["daemon"] = False  # type: ignore[attr-defined]  # dask's has children
        _KEPT.append(LocalPool(1))
    pool, end = _KEPT[0], time.monotonic() + job[2] + GRACE
    future = pool.submit(job)
    while not wait([future], timeout=LOOK_SECONDS).done:
        if time.monotonic() > end or pool.is_lost(job[3]):
            pool.give_up(job[3])
            raise BrokenExecutor
    return future.result()


_KEPT: list[LocalPool] = []
"""The pool of a worker of dask."""
