"""A worker process with an engine in another Python, and what it has built; its loss is an error here, and no more."""

import itertools
import os
import re
import select
import shutil
import signal
import subprocess
import sys
import tempfile
import threading
import weakref
from collections import deque
from collections.abc import Callable
from contextlib import suppress
from pathlib import Path
from typing import Any, BinaryIO

from multibody_xval.engines.interface.texts import visible
from multibody_xval.engines.isolated.worker import Message, NotAMessage, read_message, write_message
from reference_lcp.environment import ONE_THREAD

WORKER = Path(__file__).with_name("worker.py")

REQUEST_LIMIT = 60.0
"""Seconds that any request may take, on a machine that is busy."""

STEP_LIMIT = 0.02
"""Seconds that a step of a lane may take beside; a hundred times what one of the slowest engine here does."""

GRACE = 5.0
"""Seconds after its limit at which a worker that has not ended itself is given up: it is no Python, or was stopped."""

LAST_LINES, LONGEST_LINE = 5, 200
"""Lines of a crashed worker's error stream that its message quotes, and characters of one."""

CRASHED_IN = re.compile(
    r'^(?:Fatal Python error: .*\s+)?.*\(most recent call first\):\n  File "([^"]+)", line (\d+) in (\S+)', re.MULTILINE
)
"""What Python prints as it is ended: the innermost frame comes first."""

NUMBERS = itertools.count()
"""By which workers know what they have built; no two have the same."""


class EngineProcessError(RuntimeError):
    """The worker crashed, took too long, or replied with an error; the message names the engine and the cause."""


class EngineProcess:
    """An engine in a worker process, which is started on first use and anew after it was lost.

    Requests of several threads wait for each other. After a fork, the new process starts a worker of its own.
    """

    def __init__(self, engine: str, interpreter: str, server: Path):
        self.engine, self._interpreter = engine, shutil.which(interpreter) or interpreter
        self._command = [self._interpreter, "-I", str(WORKER), str(server)]
        self._lock = threading.Lock()
        self._worker: _WorkerProcess | None = None
        self._released: deque[int] = deque()
        self.generation = 0
        """Number of workers so far: lanes that were built in an earlier one are gone."""

    def release(self, number: int) -> None:
        """Let the worker drop a lane, with the next request; safe in a finaliser."""
        self._released.append(number)

    def alive(self) -> bool:
        """Say whether the worker that was started last would take another request."""
        return self._worker is not None and self._worker.usable()

    def request(self, request: str, limit: float, /, **values: Any) -> Message:
        """Send a request and wait for the reply, `limit` seconds at most: then the worker ends.

        An `EngineProcessError` says that it crashed, took longer or replied with an error.
        """
        with self._lock:
            worker = self._usable_worker()
            release = [self._released.popleft() for _ in range(len(self._released))]
            try:
                reply = self._exchange(worker, {**values, "request": request, "limit": limit, "release": release})
            except BaseException:
                # Also when the user interrupts the wait: the reply would be taken for that of the next request.
                self._lose()
                raise
        if "error" in reply:
            text = visible(" ".join(str(reply["error"]).split()))
            failure = EngineProcessError(f"{self.engine} in {self._interpreter}: {reply['kind']}: {text}")
            failure.add_note(str(reply["traceback"]))
            raise failure
        return reply

    def close(self) -> None:
        """End the worker; the next request starts another."""
        with self._lock:
            self._lose()

    def _usable_worker(self) -> "_WorkerProcess":
        if self._worker is None or not self._worker.usable():
            self._lose()
            if sys.platform == "win32":
                raise EngineProcessError(
                    f"{self.engine}: another Python needs a POSIX system, and this is {sys.platform}"
                )
            try:
                self._worker = _WorkerProcess(self._command)
            except OSError as cause:
                raise EngineProcessError(f"{self.engine}: {self._interpreter} does not start: {cause}") from cause
            self.generation += 1
        return self._worker

    def _exchange(self, worker: "_WorkerProcess", message: Message) -> Message:
        """Give the reply, or raise with one line on what became of the worker."""
        request, limit = message["request"], message["limit"]
        worker.errors.truncate(0)  # an engine may warn in every step
        try:
            write_message(worker.requests, message)
            if not select.select([worker.replies], [], [], limit + GRACE)[0]:
                raise EngineProcessError(f"{self.engine} does not answer {request!r} within {limit:g} s")
            return read_message(worker.replies)
        except NotAMessage as problem:
            raise EngineProcessError(f"{self.engine} sent something other than a reply: {problem}") from problem
        except (EOFError, OSError) as problem:
            raise EngineProcessError(f"{self.engine} {worker.how_it_ended(request, limit)}") from problem

    def _lose(self) -> None:
        if self._worker is not None:
            self._worker.end()
            self._worker = None


class _WorkerProcess:
    """One process, its pipes and its error stream."""

    def __init__(self, command: list[str]):
        self.errors = tempfile.TemporaryFile()  # noqa: SIM115 - closed with the process
        _append(self.errors)
        try:
            self.process: subprocess.Popen[bytes] = subprocess.Popen(
                command,
                stdin=subprocess.PIPE,
                stdout=subprocess.PIPE,
                stderr=self.errors,
                # Nothing else of this environment: paths and libraries of this Python would be the wrong ones there.
                env={"PATH": os.defpath, "LC_ALL": "C.UTF-8", **ONE_THREAD},
                cwd=tempfile.gettempdir(),
                start_new_session=True,
            )
        except OSError:
            self.errors.close()
            raise
        assert self.process.stdin is not None
        assert self.process.stdout is not None
        self.requests: BinaryIO = self.process.stdin  # type: ignore[assignment]
        self.replies: BinaryIO = self.process.stdout  # type: ignore[assignment]
        self._owner = os.getpid()
        self.end = weakref.finalize(self, _end, self.process, self.errors, self._owner)

    def usable(self) -> bool:
        """Say whether it runs, and belongs to this process rather than to the one that this was forked from."""
        return self._owner == os.getpid() and self.process.poll() is None

    def how_it_ended(self, request: str, limit: float) -> str:
        """Give the signal or the code, where it was, and a quotation of what was printed last."""
        code = self.process.wait()
        self.errors.seek(0)
        printed = self.errors.read().decode(errors="replace")
        crash = CRASHED_IN.search(printed)
        lines = printed[: crash.start() if crash else None].strip().splitlines()
        quoted = " | ".join(line[:LONGEST_LINE] for line in lines[-LAST_LINES:])
        return (
            _ended(code, request, limit)
            + (f", in {crash[3]} ({Path(crash[1]).name}:{crash[2]})" if crash else "")
            + (f"; it printed last: {quoted}" if quoted else "")
        )


def _append(file: Any) -> None:
    """Let a process go on writing at the end of a file, wherever that is after a truncation."""
    import fcntl  # which other systems lack

    fcntl.fcntl(file, fcntl.F_SETFL, fcntl.fcntl(file, fcntl.F_GETFL) | os.O_APPEND)


def _ended(code: int, request: str, limit: float) -> str:
    if code == -signal.SIGALRM:
        return f"did not finish {request!r} within {limit:g} s and was killed"
    if code >= 0:
        return f"ended with code {code} during {request!r}"
    name = signal.Signals(-code).name if -code in set(signal.Signals) else "unknown"
    return f"crashed with signal {-code} ({name}) during {request!r}"


def _end(process: subprocess.Popen[bytes], errors: Any, owner: int) -> None:
    """End a process for good and free its pipes; in a fork of its owner, only free them."""
    streams: tuple[Any, ...] = (process.stdin, process.stdout, errors)
    for stream in streams:
        with suppress(OSError):
            stream.close()
    if process.returncode is None and os.getpid() == owner:
        process.kill()
        process.wait()


class Built:
    """A lane, or a scene, of a server."""

    def __init__(self, process: EngineProcess, parameters: Message):
        self._process = process
        self._parameters = parameters
        self._generation = 0
        self._release: Callable[[], object] = int
        self.number = -1
        """By which the worker knows it."""

    def request(self, request: str, limit: float, /, **values: Any) -> Message:
        """Send a request that concerns it, and build it first unless the worker that runs has it."""
        if self._generation != self._process.generation or not self._process.alive():
            self._release()
            self.number = next(NUMBERS)
            self._process.request("build", REQUEST_LIMIT, number=self.number, **self._parameters)
            self._generation = self._process.generation
            self._release = weakref.finalize(self, self._process.release, self.number)
        return self._process.request(request, limit, number=self.number, **values)

    def close(self) -> None:
        """Let the worker drop it; another use builds it again."""
        self._release()
        self._generation = 0
