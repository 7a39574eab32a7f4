"""How a command begins and ends: with an exit code of one table, and one clear line where it is not 0.

Ctrl-C ends a command within two seconds, also while its modules are imported: it calls `heed_interrupts` before it
imports anything else, so that this module imports the standard library only.
"""

import atexit
import io
import itertools
import os
import select
import shutil
import signal
import socket
import sys
import tempfile
import time
import traceback
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from threading import Thread
from typing import TYPE_CHECKING, Any

from reference_lcp.errors import SHOWN, ExitCode, ParameterError, RunError, shortened, text_of

if TYPE_CHECKING:
    import typer

CLOSE_SECONDS = 1.5
"""What a command has to close what it holds; then it ends as it is. Stores and outputs bear that."""

LONGEST_MESSAGE = 1000
"""Characters of an error that are printed; of a longer one, beginning and end."""

CACHE_VARIABLE = "NUMBA_CACHE_DIR"
"""Variable of the environment that names where numba keeps compiled kernels."""

ROOT = Path(__file__).resolve().parents[1]


KINDS = {"valid number": "a number", "valid integer": "a whole number"}
"""What typer's message about a word that cannot be read as an option's value contains, and what it means."""


class _State:
    """What Ctrl-C does in this process."""

    watched = False
    seconds = 0.0
    pending = False
    announced = False


def heed_interrupts() -> None:
    """Let Ctrl-C end this process at once, and in `closing_on_interrupt` after a moment to close."""
    if _State.watched or signal.getsignal(signal.SIGINT) is not signal.default_int_handler:
        return
    _State.watched = True
    reader, writer = socket.socketpair()  # Windows waits for sockets only
    writer.setblocking(False)
    signal.set_wakeup_fd(writer.detach(), warn_on_full_buffer=False)
    signal.signal(signal.SIGINT, _pass)
    Thread(target=_end_process, args=(reader,), daemon=True).start()


@contextmanager
def closing_on_interrupt() -> Iterator[None]:
    """Let Ctrl-C raise `KeyboardInterrupt` here; a second one, or the end of `CLOSE_SECONDS`, ends the process."""
    _State.announced = False
    if not _State.watched:
        yield
        return
    _State.seconds = CLOSE_SECONDS
    signal.signal(signal.SIGINT, _raise)
    try:
        yield
    finally:
        signal.signal(signal.SIGINT, _pass)
        if not _State.pending:
            _State.seconds = 0.0


def interrupt_pending() -> bool:
    """Whether Ctrl-C was raised in `closing_on_interrupt`, whatever has become of the exception."""
    return _State.pending


def announce_interrupt(message: str) -> None:
    """Tell the user in one line that the command is interrupted; once."""
    if not _State.announced:
        _State.announced = True
        print(message, file=sys.stderr, flush=True)


def end_interrupted() -> None:
    """End an interrupted command that has closed what it holds, without Python's own end, which takes seconds."""
    if _State.watched:
        sys.stdout.flush()
        sys.stderr.flush()
        os._exit(ExitCode.INTERRUPTED)


def _pass(_signal: int, _frame: object) -> None:
    """Leave the signal to the thread."""


def _raise(_signal: int, _frame: object) -> None:
    _State.pending = True
    signal.signal(signal.SIGINT, _pass)  # the second one is for the thread
    raise KeyboardInterrupt


def _end_process(reader: socket.socket) -> None:
    """End this process at the first Ctrl-C, or so long after it, or at the second one."""
    _wait_for_interrupt(reader, None)
    _wait_for_interrupt(reader, _State.seconds)
    if not _State.announced:
        os.write(2, b"error: interrupted\n")
    os._exit(ExitCode.INTERRUPTED)


def _wait_for_interrupt(reader: socket.socket, seconds: float | None) -> None:
    """Return at the next Ctrl-C, or after so many seconds; other signals are passed over."""
    end = None if seconds is None else time.monotonic() + seconds
    while select.select([reader], [], [], None if end is None else max(0.0, end - time.monotonic()))[0]:
        if signal.SIGINT in reader.recv(1):
            return


def ensure_kernel_cache() -> None:
    """Let kernels be kept in a private folder while this process lives, where numba has no place for them."""
    if CACHE_VARIABLE in os.environ:
        return
    cache = Path(os.environ.get("XDG_CACHE_HOME") or os.path.expanduser("~/.cache"), "numba")  # noqa: PTH111 - "~" stays
    if _writable(ROOT / "reference_lcp" / "chain" / "__pycache__") or (cache.is_absolute() and _writable(cache)):
        return
    folder, maker = tempfile.mkdtemp(prefix="mbxv-kernels-"), os.getpid()
    os.environ[CACHE_VARIABLE] = folder
    atexit.register(lambda: shutil.rmtree(folder, ignore_errors=True) if os.getpid() == maker else None)
    where = f"neither {ROOT} nor {cache} can be written"
    print(f"{where}: compiled solvers are kept until the end only; {CACHE_VARIABLE} names a folder", file=sys.stderr)


def _writable(folder: Path) -> bool:
    """Tell whether files can be made in a folder, which is made if it can be, as numba does.

    `os.access` says yes where a sandbox (Landlock) forbids it; a file without a name costs 0.1 ms and leaves no trace.
    """
    try:
        folder.mkdir(parents=True, exist_ok=True)
        tempfile.TemporaryFile(dir=folder).close()
    except OSError:
        return False
    return True


ONE_THREAD = dict.fromkeys(("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS"), "1")
"""Environment of commands, which time one core, and of worker processes. The suite runs these side by side, one a
processor, where threads of linear algebra slow each other down; and a process that workers are forked from must have no
other thread."""


def run_command(app: "typer.Typer", arguments: list[str] | None = None) -> int:
    """Run a command line and give its `ExitCode`."""
    for stream in (sys.stdout, sys.stderr):
        if isinstance(stream, io.TextIOWrapper):
            stream.reconfigure(errors="backslashreplace")  # an output in ASCII has no μ
    for name, count in ONE_THREAD.items():
        os.environ.setdefault(name, count)
    os.environ["MPLBACKEND"] = "agg"  # commands draw into files; a backend that there is not ends matplotlib
    with closing_on_interrupt():
        try:
            code = _exit_code(app, sys.argv[1:] if arguments is None else arguments)
        except KeyboardInterrupt:
            code = ExitCode.INTERRUPTED
        except BaseException as problem:  # a panic of an engine in Rust is no `Exception`
            if isinstance(problem, SystemExit) and _raised_by_typer(problem):  # after a completion
                raise
            # a module that was being imported may turn Ctrl-C into an error of its own
            code = ExitCode.INTERRUPTED if interrupt_pending() else _report_fault(problem)
        if code == ExitCode.INTERRUPTED:
            announce_interrupt("error: interrupted")
            end_interrupted()
        return code


def _report_fault(problem: BaseException) -> ExitCode:
    """Say in one line what has gone wrong with the suite itself, and where the details are."""
    details, where = "".join(traceback.format_exception(problem)), "which cannot be written"
    with suppress(OSError), tempfile.NamedTemporaryFile("wb", prefix="multibody-xval-", delete=False) as file:
        file.write(details.encode(errors="backslashreplace"))
        where = file.name
    text = shortened(text_of(problem), LONGEST_MESSAGE // 2)
    _print_error(f"a fault of the suite, {type(problem).__name__}: {text}; details, for a report of it: {where}")
    return ExitCode.UNEXPECTED


def _exit_code(app: "typer.Typer", arguments: list[str]) -> int:
    import typer

    usage_error: Any = typer.BadParameter.__base__  # of wrong options too; typer exports only this subclass
    try:
        _check_words(arguments)
        with _standard_output():
            result = typer.main.get_command(app).main(arguments, prog_name=app.info.name, standalone_mode=False)
    except typer.Abort:
        return ExitCode.INTERRUPTED
    except _ReaderGoneError:
        return ExitCode.READER_GONE
    except usage_error as problem:
        _print_error(_message(problem, arguments))
    except ParameterError as problem:
        _print_error(str(problem))
    except RunError as problem:
        _print_error(str(problem))
        return ExitCode.RUN_FAILED
    else:
        return result if isinstance(result, int) else ExitCode.DONE
    return ExitCode.WRONG_INPUT


def _check_words(words: list[str]) -> None:
    """Refuse an empty word, as of a variable that is not set: as a path it would be the folder one is in."""
    for before, word in itertools.pairwise(["", *words]):
        name, equals, value = word.partition("=") if word.startswith("--") else (before, "=", word)
        if equals and not value.strip():
            where = name if name.startswith("-") else "an argument"
            raise ParameterError(f"{where} = {value!r} is empty; allowed: a name, a number or a path")


class _ReaderGoneError(Exception):
    """What reads the output of a command has closed it, as ``head`` does."""


@contextmanager
def _standard_output() -> Iterator[None]:
    """Make sure at the end that all that was printed has arrived: it may go into a file on a full disk."""
    try:
        yield
        sys.stdout.flush()
    except (OSError, SystemExit) as problem:
        of_click = isinstance(problem, OSError) or isinstance(problem.__context__, OSError)  # where a pipe is closed
        if not of_click or getattr(problem, "filename", None) is not None:
            raise
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())  # Python writes what is left at its end
        if isinstance(problem, SystemExit | BrokenPipeError):
            raise _ReaderGoneError from None
        raise RunError(f"standard output cannot be written: {problem.strerror}") from None


def _raised_by_typer(problem: BaseException) -> bool:
    """Tell whether typer, or click within, ends the program, and not an engine."""
    *_, (frame, _) = traceback.walk_tb(problem.__traceback__)
    return str(frame.f_globals.get("__name__")).partition(".")[0] in ("typer", "click")


def _print_error(text: str) -> None:
    """Print an error as one line that any terminal shows, whatever somebody has written into a name."""
    from reference_lcp.terminal import visible

    line = visible(" ".join(text.split()))
    if len(line) > LONGEST_MESSAGE:
        half = LONGEST_MESSAGE // 2
        line = f"{line[:half]} … {line[-half:]}"
    print(f"error: {line}", file=sys.stderr)


def _message(problem: Any, arguments: list[str]) -> str:
    """Say in one line what is wrong, with the value that was given for an option."""
    message = " ".join(problem.format_message().split())
    names = getattr(getattr(problem, "param", None), "opts", [])
    for word, following in itertools.zip_longest(arguments, arguments[1:]):
        name, equals, joined = word.partition("=")
        value = joined if equals else following
        if name in names and value is not None:
            kind = next((own for words, own in KINDS.items() if words in message), None)
            if kind is not None:
                return f"{name} = {value[:SHOWN]!r} is not {kind}; allowed: {kind}"
            return f"{message} (given: {value[:SHOWN]})"
    return message
