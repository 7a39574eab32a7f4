"""Templates of workers that tests share, since each start takes a second of a processor."""

import os
import resource
import sys
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager
from pathlib import Path
from unittest.mock import patch

from multibody_xval.scenarios.runs import local_processes
from multibody_xval.scenarios.runs.worker_template import WorkerTemplate


@contextmanager
def kept_templates() -> Iterator[None]:
    """Let executors of this process take a template that an earlier one has started alike; all end with this."""
    started: dict[str, WorkerTemplate] = {}

    class Kept:
        """What an executor takes for a template of its own."""

        def fork(self):
            alike = inherited()
            if alike not in started:
                started[alike] = opened.enter_context(WorkerTemplate())
            return started[alike].fork()

        def start(self) -> None:
            """Start with the first worker."""

        def close(self) -> None:
            """Leave it to the next executor."""

    with ExitStack() as opened, patch.object(local_processes, "WorkerTemplate", Kept):
        yield


def inherited() -> str:
    """Say what a template takes over from this process when it starts; pytest's note of the test is none of it."""
    environment = {name: value for name, value in os.environ.items() if name != "PYTEST_CURRENT_TEST"}
    printed, largest = Path("/proc/self/fd/2").readlink(), resource.getrlimit(resource.RLIMIT_FSIZE)
    return repr((sorted(environment.items()), Path.cwd(), sys.path, printed, largest))
