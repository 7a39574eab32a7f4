"""A worker process: runs the batches that come through its connection, and gives their results."""

import faulthandler
import math
import os
import pickle
import signal
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from multiprocessing.connection import Connection
from typing import IO, Any, NamedTuple

from multibody_xval.engines.interface.engine import Engine, sample_lane
from multibody_xval.engines.interface.registry import engine, law_of
from multibody_xval.engines.interface.variant import Variant
from multibody_xval.scenarios.runs.executor import run_batch
from multibody_xval.scenarios.runs.failures import WORKER_MARK, reason_of
from multibody_xval.scenarios.runs.result import Result
from multibody_xval.scenarios.runs.sources import sources_of
from reference_lcp.chain.trajectory import State
from reference_lcp.errors import ParameterError, text_of


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
    sources = f"suite {suite}, sources {sources_of(adapter)}"
    return f"{variant} {adapter.version()} ({options}), Python {adapter.python()}, {sources}".replace(" ()", "")


LAW_LIMIT = 300.0
"""Seconds in which a law is compiled: Exudyn's takes 8 s of a processor, and ten times as much where it is busy."""


class Begun(NamedTuple):
    """Message of a worker that begins with a batch, or to prepare its engine: from then on a time limit counts."""

    preparation: str = ""
    """What the engine does, such as ``MuJoCo Warp compiles its kernels``; empty of a batch."""
    limit: float = math.nan
    """Seconds that a preparation may take; a batch has the limit that it came with."""


def serve(connection: int, crash_log: int) -> None:
    """Run batches that come through a connection until it is closed; a crash or the time limit is written into the log.

    A message is a batch, the identity of its variant (`identity_of`) and the time limit [s], pickled. `Begun` goes back
    for each, and for what its engine does before it; then the results, or the reason why there are none.
    """
    os.environ[WORKER_MARK] = "1"
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    with os.fdopen(crash_log, "w") as file, suppress(EOFError, OSError):  # the client has gone
        faulthandler.enable(file, all_threads=False)
        Worker(Connection(connection), file).run()


class Worker:
    """The worker's end of the connection."""

    def __init__(self, connection: Connection, crash_log: IO[str]):
        self._connection, self._crash_log = connection, crash_log
        self._process = os.getpid()
        self._prepared: dict[tuple[Variant, int], str | None] = {}

    def run(self) -> None:
        """Reply to one batch after the other."""
        while True:
            message = self._connection.recv_bytes()
            self._send(Begun())
            self._send(self._reply(message))

    def _send(self, message: Any) -> None:
        if os.getpid() != self._process:  # an engine has forked, and this is the copy
            os._exit(0)
        self._connection.send(message)

    def _reply(self, message: bytes) -> list[Result] | str:
        try:
            batch, identity, limit = pickle.loads(message)
            with self._ended_after(limit):
                here = identity_of(batch[0].variant)
        except BaseException as problem:  # such as a drive whose class this process cannot import, or is ended by
            return f"the task cannot be read in a worker process: {type(problem).__name__}: {text_of(problem)}"
        if here != identity:
            return f"not the same in the worker: {here}; expected: {identity}"
        reason = self.preparation_problem(batch[0].variant, batch[0].cells)
        if reason is not None:
            return reason
        self._send(Begun())
        with self._ended_after(limit):
            return run_batch(batch)

    def preparation_problem(self, variant: Variant, cells: int) -> str | None:
        """Prepare a variant for chains of this length, unless that was done; gives the reason if it fails.

        One that is not there needs none, and neither does a scene, which has no cells. Where its law cannot take a
        step, its tasks fail too, with their reasons.
        """
        adapter = engine(variant.engine)
        if cells and adapter.unavailable_reason() is None and (variant, cells) not in self._prepared:
            self._prepared[variant, cells] = self._prepare(adapter, variant, cells)
            law = law_of(variant.preset)
            if law is not None:
                beginning = Begun(f"the law of {adapter.capabilities.title} is compiled", LAW_LIMIT)
                rest, lanes = State.at_rest(1, cells), [sample_lane(cells)]
                self._attempt(beginning, lambda: law.build(lanes).advance(rest, 0, 1))
        return self._prepared.get((variant, cells))

    def _prepare(self, adapter: Engine, variant: Variant, cells: int) -> str | None:
        """Do what the engine names; gives the reason if it fails."""
        if adapter.preparation is None:
            return None
        beginning = Begun(f"{adapter.capabilities.title} {adapter.preparation.what}", adapter.preparation.limit)
        return self._attempt(beginning, lambda: adapter.prepare(cells, variant.formulation, variant.preset_name))

    def _attempt(self, beginning: Begun, prepare: Callable[[], object]) -> str | None:
        try:
            self._send(beginning)
            with self._ended_after(beginning.limit):
                prepare()
        except BaseException as problem:  # an engine may raise anything, and end the program
            return f"{beginning.preparation}: {reason_of(problem)}"
        return None

    @contextmanager
    def _ended_after(self, limit: float) -> Iterator[None]:
        """End the process after `limit` seconds, and write down where it was.

        The limit holds inside compiled code too, whether or not it lets other threads of Python run.
        """
        faulthandler.dump_traceback_later(limit, exit=True, file=self._crash_log)
        try:
            yield
        finally:
            faulthandler.cancel_dump_traceback_later()
