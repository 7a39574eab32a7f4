"""A pool of processes that answers in this one: nothing has to be started."""

from collections.abc import Sequence
from concurrent.futures import Future

from scenarios.execution.steady import answer_batch
from scenarios.tasks.result import Result
from scenarios.tasks.task import SteadyStateTask


class Here:
    """Takes the place of `ProcessPoolExecutor` in `scenarios.execution.local_processes`."""

    def __init__(self, *_arguments: object, **_options: object) -> None: ...

    def submit(self, _function: object, batch: Sequence[SteadyStateTask], *_rest: object) -> Future[list[Result]]:
        done: Future[list[Result]] = Future()
        done.set_result(answer_batch(batch))
        return done

    def shutdown(self, **_options: object) -> None: ...
