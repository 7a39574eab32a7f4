"""A worker process with an engine in another Python, and what it has built; its loss is an error here, and no more."""

import contextlib
import itertools
import os
import re
import signal
import subprocess
import sys
import tempfile
import threading
import weakref
from collections import deque
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any, BinaryIO

from multibody_xval.engines.isolated.worker import Message, NotAMessage, read_message, write_message
from reference_lcp.environment import ONE_THREAD
from reference_lcp.terminal import visible

FATAL = "Fatal Python error: "
"""How it begins."""


def place_of_crash(crash_log: str) -> str:
    """Give the innermost frame, as the end of a message; empty without one."""
    # of several threads, the one that began first, and does the work, comes last
    frame = re.search(r'File "([^"]+)", line (\d+) in (\S+)', crash_log.rsplit("Thread 0x", 1)[-1])
    return f", in {frame[3]} ({Path(frame[1]).name}:{frame[2]})" if frame else ""


WORKER = Path(__file__).with_name("worker.py")

GRACE = 5.0
"""Seconds after the limit at which a worker ends by itself, should its parent be gone."""

ABORT_SECONDS = 1.0
"""Seconds that a worker which is killed has to say where it is; one that has been stopped says nothing."""

LAST_LINES = 5
"""Lines of a crashed worker's error stream that its message quotes."""

LONGEST_LINE = 200
"""Characters of a line that it quotes."""


class EngineProcessError(RuntimeError):
    """The worker crashed, took too long, or replied with an error; the message names the engine and the cause."""


class EngineProcess:
    """An engine in a worker process, which is started on first use and anew after it was lost.

    Requests of several threads wait for each other. After a fork, the new process starts a worker of its own.
    """

    def __init__(self, engine: str, interpreter: str, server: Path):
        self.engine = engine
        self._command = [interpreter, "-I", str(WORKER), str(server)]
        self._lock = threading.Lock()
        self._worker: _WorkerProcess | None = None
        self._numbers = itertools.count()
        self._released: deque[int] = deque()
        self.generation = 0
        """Number of workers so far: lanes that were built in an earlier one are gone."""

    def new_number(self) -> int:
        """Give a number for a lane; no other one has it."""
        return next(self._numbers)

    def release(self, number: int) -> None:
        """Let the worker drop a lane, with the next request; safe in a finaliser."""
        self._released.append(number)

    def alive(self) -> bool:
        """Say whether the worker that was started last would take another request."""
        return self._worker is not None and self._worker.usable()

    @property
    def pid(self) -> int:
        """Number of the worker that was started last; 0 before the first request, and after a loss."""
        return 0 if self._worker is None else self._worker.pid

    def request(self, request: str, limit: float, /, **values: Any) -> Message:
        """Send a request and wait for the reply, `limit` seconds at most: then the worker is killed.

        An `EngineProcessError` says that it crashed, took longer or replied with an error.
        """
        with self._lock:
            worker = self._usable_worker()
            release = [self._released.popleft() for _ in range(len(self._released))]
            message = {**values, "request": request, "limit": limit + GRACE, "release": release}
            try:
                reply = self._exchange(worker, message, limit)
            except BaseException:
                # Also when the user interrupts the wait: the reply would be taken for that of the next request.
                self._lose()
                raise
        if "error" in reply:
            text = visible(" ".join(str(reply["error"]).split()))
            failure = EngineProcessError(f"{self.engine} in {self._command[0]}: {reply['kind']}: {text}")
            failure.add_note(str(reply["traceback"]))
            raise failure
        return reply

    def close(self) -> None:
        """End the worker; the next request starts another."""
        with self._lock:
            self._lose()

    def _usable_worker(self) -> "_WorkerProcess":
        if not self.alive():
            self._lose()
            reason = unavailable_reason()
            if reason is not None:
                raise EngineProcessError(f"{self.engine}: {reason}")
            try:
                self._worker = _WorkerProcess(self._command)
            except OSError as problem:
                raise EngineProcessError(f"{self.engine}: {self._command[0]} does not start: {problem}") from problem
            self.generation += 1
        assert self._worker is not None
        return self._worker

    def _exchange(self, worker: "_WorkerProcess", message: Message, limit: float) -> Message:
        """Give the reply, or raise with one line on what became of the worker."""
        worker.truncate_errors()
        with worker.killed_after(limit) as expired:
            try:
                write_message(worker.requests, message)
                return read_message(worker.replies)
            except NotAMessage as problem:
                raise EngineProcessError(f"{self.engine} sent something other than a reply: {problem}") from problem
            except (EOFError, OSError) as problem:
                how, where, printed = worker.how_it_ended()
                request = repr(message["request"])
                what = f"{how} during {request}{where}{printed}"
                if expired.is_set():
                    what = f"did not finish {request} within {limit:g} s and was killed{where}"
                raise EngineProcessError(f"{self.engine} {what}") from problem

    def _lose(self) -> None:
        if self._worker is not None:
            self._worker.end()
            self._worker = None


class _WorkerProcess:
    """One process, its pipes and its error stream."""

    def __init__(self, command: list[str]):
        with contextlib.ExitStack() as undone:
            self._errors = undone.enter_context(tempfile.TemporaryFile())
            _append(self._errors)
            self._process: subprocess.Popen[bytes] = subprocess.Popen(
                command,
                stdin=subprocess.PIPE,
                stdout=subprocess.PIPE,
                stderr=self._errors,
                # Nothing else of this environment: paths and libraries of this Python would be the wrong ones there.
                env={"PATH": os.defpath, "LC_ALL": "C.UTF-8", **ONE_THREAD},
                cwd=tempfile.gettempdir(),
                start_new_session=True,
            )
            undone.pop_all()
        assert self._process.stdin is not None
        assert self._process.stdout is not None
        self.requests: BinaryIO = self._process.stdin  # type: ignore[assignment]
        self.replies: BinaryIO = self._process.stdout  # type: ignore[assignment]
        self._owner = os.getpid()
        self.end = weakref.finalize(self, _end, self._process, self._errors, self._owner)

    @property
    def pid(self) -> int:
        """Number of the process."""
        return self._process.pid

    def usable(self) -> bool:
        """Say whether it runs, and belongs to this process rather than to the one that this was forked from."""
        return self._owner == os.getpid() and self._process.poll() is None

    def truncate_errors(self) -> None:
        """Drop what was printed so far: an engine may warn in every step."""
        self._errors.truncate(0)

    def how_it_ended(self) -> tuple[str, str, str]:
        """Give the signal or the code, where it was, and a quotation of what was printed last."""
        self._process.wait()
        code = self._process.returncode
        name = signal.Signals(-code).name if -code in set(signal.Signals) else "unknown"
        how = f"crashed with signal {-code} ({name})" if code < 0 else f"ended with code {code}"
        self._errors.seek(0)
        printed, _, crash_log = self._errors.read().decode(errors="replace").partition(FATAL)
        quoted = " | ".join(line[:LONGEST_LINE] for line in printed.strip().splitlines()[-LAST_LINES:])
        return how, place_of_crash(crash_log), f"; it printed last: {quoted}" if quoted else ""

    @contextlib.contextmanager
    def killed_after(self, limit: float) -> Iterator[threading.Event]:
        """Kill the process after `limit` seconds; gives an event that says whether that happened."""
        expired = threading.Event()

        def expire() -> None:
            expired.set()
            self._process.send_signal(signal.SIGABRT)  # it says where it is
            with contextlib.suppress(subprocess.TimeoutExpired):
                self._process.wait(ABORT_SECONDS)
            self._process.kill()

        timer = threading.Timer(limit, expire)
        timer.daemon = True
        timer.start()
        try:
            yield expired
        finally:
            timer.cancel()
            timer.join()
            if expired.is_set():
                self._process.wait()


def unavailable_reason() -> str | None:
    """Give the reason why no engine can run in another Python here; ``None`` where they can."""
    try:
        import fcntl  # noqa: F401 - every POSIX system has it
    except ImportError:
        return f"engines in another Python need a POSIX system, and this is {sys.platform}"
    return None


def _append(file: Any) -> None:
    """Let a process go on writing at the end of a file, wherever that is after a truncation."""
    import fcntl

    fcntl.fcntl(file, fcntl.F_SETFL, fcntl.fcntl(file, fcntl.F_GETFL) | os.O_APPEND)


def _end(process: subprocess.Popen[bytes], errors: Any, owner: int) -> None:
    """End a process for good and free its pipes; in a fork of its owner, only free them."""
    streams: tuple[Any, ...] = (process.stdin, process.stdout, errors)
    for stream in streams:
        with contextlib.suppress(OSError):
            stream.close()
    if process.returncode is None and os.getpid() == owner:
        process.kill()
        process.wait()


REQUEST_LIMIT = 60.0
"""Seconds that any request may take, on a machine that is busy."""

STEP_LIMIT = 0.02
"""Seconds that a step of a lane may take beside; a hundred times what one of the slowest engine here does."""


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
        """Send a request that concerns it; see `EngineProcess.request`."""
        self._ensure_built()
        return self._process.request(request, limit, number=self.number, **values)

    def close(self) -> None:
        """Let the worker drop it; another use builds it again."""
        self._release()
        self._generation = 0

    def _ensure_built(self) -> None:
        """Build it unless the worker that runs has it."""
        if self._generation == self._process.generation and self._process.alive():
            return
        self._release()
        self.number = self._process.new_number()
        self._process.request("build", REQUEST_LIMIT, number=self.number, **self._parameters)
        self._generation = self._process.generation
        self._release = weakref.finalize(self, self._process.release, self.number)
