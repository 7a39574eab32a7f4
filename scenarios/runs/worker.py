"""A worker process: runs the batches that come through its connection, and gives their results."""

import faulthandler
import os
import pickle
import re
import signal
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from multiprocessing.connection import Connection
from pathlib import Path
from typing import IO, Any, NamedTuple

from engines.interface.engine import Engine, sample_lane
from engines.interface.registry import engine, law_of
from engines.interface.variant import Variant
from engines.isolated.process import FATAL, place_of_crash
from reference_lcp.chain.trajectory import State
from reference_lcp.errors import ParameterError
from scenarios.runs.executor import run_batch
from scenarios.runs.failures import WORKER_MARK, reason_of, text_of
from scenarios.runs.result import Result


def identity_of(variant: Variant) -> str:
    """Give versions of engine, Python and suite, and the preset's options, here; or why there is no engine."""
    try:
        adapter, preset = engine(variant.engine), variant.preset
    except ParameterError as problem:
        return text_of(problem)
    missing = adapter.unavailable_reason()
    if missing is not None:
        return f"{variant}, not installed: {missing}"
    options = ", ".join(f"{name} = {option.value!r}" for name, option in sorted(preset.options.items()))
    suite = engine("reference").version()
    return f"{variant} {adapter.version()} ({options}), Python {adapter.python()}, suite {suite}".replace(" ()", "")


KEPT_SECONDS = 5.0
"""What an engine has to load what it has kept, without a word to the user: MuJoCo Warp takes 2 s."""


LAW_LIMIT = 300.0
"""Seconds in which a law is compiled: Exudyn's takes 8 s of a processor, and ten times as much where it is busy."""


class Preparing(NamedTuple):
    """Message of a worker that begins to prepare an engine: from then on its limit counts."""

    what: str
    """What the engine does, such as ``MuJoCo Warp compiles its kernels``."""
    limit: float
    """Seconds that it may take."""

    @property
    def notice(self) -> str:
        """What the user is told where it takes longer than `KEPT_SECONDS`."""
        return f"{self.what}: at most {self.limit:g} s; what is made is kept for later runs"


class Preparations:
    """The engines that this process has prepared, and why others could not be; `within` keeps the limit of each."""

    def __init__(self, within: Callable[[Preparing, Callable[[], object]], None]):
        self._within = within
        self._ended: dict[tuple[Variant, int], str | None] = {}

    def problem(self, variant: Variant, cells: int) -> str | None:
        """Prepare a variant for chains of this length, unless that was done; gives the reason if it fails.

        One that is not there needs none.
        """
        adapter = engine(variant.engine)
        if adapter.unavailable_reason() is not None:
            return None
        if (variant, cells) not in self._ended:
            self._ended[variant, cells] = self._prepared(adapter, variant, cells)
            self._compile_law(adapter, variant, cells)
        return self._ended[variant, cells]

    def _prepared(self, adapter: Engine, variant: Variant, cells: int) -> str | None:
        """Do what the engine names; gives the reason if it fails."""
        if adapter.preparation is None:
            return None
        beginning = Preparing(f"{adapter.capabilities.title} {adapter.preparation.what}", adapter.preparation.limit)
        return self._attempt(beginning, lambda: adapter.prepare(cells, variant.formulation, variant.preset_name))

    def _compile_law(self, adapter: Engine, variant: Variant, cells: int) -> None:
        """Let the model of a law take a step; what fails here fails in its tasks too, with their reasons."""
        law = law_of(variant.preset)
        if law is not None:
            lane = sample_lane(cells)
            beginning = Preparing(f"the law of {adapter.capabilities.title} is compiled", LAW_LIMIT)
            self._attempt(beginning, lambda: law.build([lane]).advance(State.at_rest(1, cells), 0, 1))

    def _attempt(self, beginning: Preparing, prepare: Callable[[], object]) -> str | None:
        try:
            self._within(beginning, prepare)
        except BaseException as problem:  # an engine may raise anything, and end the program
            return f"{beginning.what}: {reason_of(problem)}"
        return None


BEGUN = "begun"
"""Message of a worker that begins with a batch: from then on the time limit counts."""


def serve(descriptor: int, crash_log: str) -> None:
    """Run batches that come through a connection until it is closed; a crash or the time limit is written into the log.

    A message is a batch, the identity of its variant (`identity_of`) and the time limit [s], pickled. `BEGUN` goes back
    for each; `Preparing`, and `BEGUN` again, where its engine is prepared first; then the results, or the reason why
    there are none.
    """
    os.environ[WORKER_MARK] = "1"
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    connection = Connection(descriptor)
    with Path(crash_log).open("w") as file, suppress(EOFError, OSError):  # the client has gone
        faulthandler.enable(file, all_threads=False)
        _Server(connection, file).run()


class _Server:
    """The worker's end of the connection."""

    def __init__(self, connection: Connection, crash_log: IO[str]):
        self._connection, self._crash_log = connection, crash_log
        self._process = os.getpid()
        self._preparations = Preparations(self._prepare)

    def run(self) -> None:
        """Reply to one batch after the other."""
        while True:
            message = self._connection.recv_bytes()
            self._send(BEGUN)
            self._send(self._reply(message))

    def _send(self, message: Any) -> None:
        if os.getpid() != self._process:  # an engine has forked, and this is the copy
            os._exit(0)
        self._connection.send(message)

    def _reply(self, message: bytes) -> list[Result] | str:
        try:
            batch, identity, limit = pickle.loads(message)
        except Exception as problem:  # such as a drive whose class this process cannot import
            return f"the task cannot be read in a worker process: {type(problem).__name__}: {problem}"
        with _ended_after(limit, self._crash_log):
            here = identity_of(batch[0].variant)
        if here != identity:
            return f"not the same in the worker: {here}; expected: {identity}"
        reason = self._preparations.problem(batch[0].variant, batch[0].ratios.cells)
        if reason is not None:
            return reason
        self._send(BEGUN)
        with _ended_after(limit, self._crash_log):
            return run_batch(batch)

    def _prepare(self, preparing: Preparing, prepare: Callable[[], object]) -> None:
        self._send(preparing)
        with _ended_after(preparing.limit, self._crash_log):
            prepare()


@contextmanager
def _ended_after(limit: float, crash_log: IO[str]) -> Iterator[None]:
    """End the process after `limit` seconds, and write down where it was.

    The limit holds inside compiled code too, whether or not it lets other threads of Python run.
    """
    faulthandler.dump_traceback_later(limit, exit=True, file=crash_log)
    try:
        yield
    finally:
        faulthandler.cancel_dump_traceback_later()


def reason_of_death(crash_log: str, limit: float) -> str | None:
    """Read from its crash log why a worker has ended; ``None`` if it has left nothing."""
    where = place_of_crash(crash_log)
    if crash_log.startswith("Timeout"):
        return f"{limit_reached(limit)}{where}"
    fault = re.search(rf"{FATAL}(.+)", crash_log)
    return f"the worker process crashed: {fault[1]}{where}" if fault else None


def limit_reached(limit: float) -> str:
    """Give the reason of a batch that took too long."""
    return f"stopped at the time limit of {limit:g} s"
