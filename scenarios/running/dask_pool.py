"""The workers of a dask cluster, each of which runs what it gets in processes of its own machine."""

import importlib.util
import logging
import multiprocessing
import time
from collections.abc import Iterator
from concurrent.futures import BrokenExecutor, Future, wait
from contextlib import contextmanager, suppress
from typing import Any

from multibody_xval.scenarios.output_files import RunError
from multibody_xval.scenarios.running.processes import GRACE, LOOK_SECONDS, Job, LocalPool
from reference_lcp.errors import ParameterError, shown

CONNECT_SECONDS = 15
"""How long a scheduler may take to answer."""

AWAY_SECONDS = 30.0
"""How long a cluster may be without workers, such as one that a nanny starts again."""

CLOSE_SECONDS = 2
"""How long a lost cluster may take to be left."""


class DaskPool:
    """The workers of a dask cluster."""

    def __init__(self, address: str, client: Any):
        self._address, self._client = address, client
        self._executor = client.get_executor(pure=False, retries=0)
        self._seen = time.monotonic()
        self.slots = max(1, len(client.scheduler_info()["workers"]))

    def submit(self, job: Job) -> "Future[Any]":
        """Start a job on any worker."""
        future: Future[Any] = self._executor.submit(isolated, job)
        return future

    def is_lost(self, serves: str) -> bool:
        """Whether the scheduler is gone, or all of its workers are."""
        if self._client.status != "running":
            return True
        if self._client.scheduler_info()["workers"]:
            self._seen = time.monotonic()
        return time.monotonic() - self._seen > AWAY_SECONDS

    def give_up(self, serves: str) -> None:
        """Leave what passes its limit to workers, which end it; without them nothing is computed any more.

        Raises
        ------
        RunError
            If the cluster is lost.
        """
        if self.is_lost(serves):
            raise RunError(f"the cluster of scheduler = {shown(self._address)} is lost; what is stored stays")


@contextmanager
def dask(address: str) -> Iterator[DaskPool]:
    """Give the workers of a dask cluster that runs already; it and its workers have to be trusted."""
    if importlib.util.find_spec("distributed") is None:
        raise ParameterError(
            f"scheduler = {shown(address)} needs the package distributed, which is not installed; "
            "pip install 'multibody-xval[cluster]'"
        )
    from distributed import Client, default_client

    for name in ("distributed", "distributed.client"):  # which print tracebacks of a cluster that is lost
        logging.getLogger(name).setLevel(logging.CRITICAL)
    try:
        client = Client(address, timeout=f"{CONNECT_SECONDS}s")  # type: ignore[no-untyped-call]
    except (OSError, ValueError) as problem:
        with suppress(Exception):
            stale = default_client()  # type: ignore[no-untyped-call]  # else files that are written ask it
            if stale.status != "running":
                stale.close(timeout=CLOSE_SECONDS)
        reason = " ".join(str(problem).split())
        raise ParameterError(
            f"scheduler = {shown(address)} cannot be reached: {reason}; allowed: the address of one that runs"
        ) from None
    try:
        yield DaskPool(address, client)
    finally:
        with suppress(Exception):  # of a cluster that is lost
            client.close(timeout=CLOSE_SECONDS)  # type: ignore[no-untyped-call]


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
