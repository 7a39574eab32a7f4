"""What a worker of a dask cluster does: each batch goes to a process of its own machine, which serves one engine."""

import threading

from scenarios.execution.computation.batch import Batch
from scenarios.execution.workers.local_processes import LocalExecutor
from scenarios.tasks.result import Result

_own = threading.local()
"""The processes of each thread of the worker."""


def run_on_cluster(batch: Batch, identity: str, limit: float) -> list[Result]:
    """Run a batch as on the client's machine; see `LocalExecutor.run_for_client`."""
    if not hasattr(_own, "executor"):
        _own.executor = LocalExecutor(1)
    executor: LocalExecutor = _own.executor
    return executor.run_for_client(batch, identity, limit)
