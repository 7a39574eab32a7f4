"""How every command of the suite ends: with an exit code of one table, and one clear line where it is not 0."""

import io
import os
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

import typer

from reference_lcp.errors import SHOWN, ExitCode, ParameterError, RunError
from reference_lcp.process import announce_interrupt, closing_on_interrupt, end_interrupted, interrupt_pending
from reference_lcp.terminal import visible

LONGEST_MESSAGE = 1000
"""Characters of an error that are printed; of a longer one, beginning and end."""

UsageError: Any = typer.BadParameter.__base__
"""What an unknown option, a missing one or a value of the wrong type raises; typer exports only a subclass of it."""


def run_command(app: typer.Typer, arguments: list[str] | None = None) -> int:
    """Run a command line and give its `ExitCode`.

    Wrong options, `ParameterError`, `RunError` and Ctrl-C become one line on standard error.
    """
    _prepare()
    with closing_on_interrupt():
        try:
            code = _exit_code(app, sys.argv[1:] if arguments is None else arguments)
        except KeyboardInterrupt:
            code = ExitCode.INTERRUPTED
        except Exception:
            if not interrupt_pending():
                raise
            code = ExitCode.INTERRUPTED  # a module that was being imported may turn Ctrl-C into an error of its own
        if code == ExitCode.INTERRUPTED:
            announce_interrupt("error: interrupted")
            end_interrupted()
        return code


def _exit_code(app: typer.Typer, arguments: list[str]) -> int:
    try:
        with _standard_output():
            result = typer.main.get_command(app).main(arguments, prog_name=app.info.name, standalone_mode=False)
    except typer.Abort:
        return ExitCode.INTERRUPTED
    except UsageError as problem:
        return _ended(ExitCode.WRONG_INPUT, _message(problem, arguments))
    except ParameterError as problem:
        return _ended(ExitCode.WRONG_INPUT, str(problem))
    except RunError as problem:
        return _ended(ExitCode.RUN_FAILED, str(problem))
    return result if isinstance(result, int) else ExitCode.DONE


def _ended(code: ExitCode, message: str) -> ExitCode:
    """Say why a command ends early."""
    print_error(message)
    return code


@contextmanager
def _standard_output() -> Iterator[None]:
    """Make sure at the end that all that was printed has arrived: it may go into a file on a full disk."""
    try:
        yield
        sys.stdout.flush()
    except (OSError, SystemExit) as problem:  # click ends the program where a pipe is closed, and after a completion
        if getattr(problem, "filename", None) is not None or getattr(problem, "code", None) == 0:
            raise
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())  # Python writes what is left at its end
        reason = getattr(problem, "strerror", "closed pipe")
        raise RunError(f"standard output cannot be written: {reason}") from None


def _prepare() -> None:
    """Let no setting of the terminal or of matplotlib end a command."""
    for stream in (sys.stdout, sys.stderr):
        if isinstance(stream, io.TextIOWrapper):
            stream.reconfigure(errors="backslashreplace")  # an output in ASCII has no μ
    os.environ["MPLBACKEND"] = "agg"  # commands draw into files; a backend that there is not ends matplotlib


def print_error(text: str) -> None:
    """Print an error as one line that any terminal shows, whatever somebody has written into a name."""
    line = visible(" ".join(text.split()))
    if len(line) > LONGEST_MESSAGE:
        half = LONGEST_MESSAGE // 2
        line = f"{line[:half]} … {line[-half:]}"
    print(f"error: {line}", file=sys.stderr)


def _message(problem: Any, arguments: list[str]) -> str:
    """Say in one line what is wrong, with the value that was given for an option."""
    message = " ".join(problem.format_message().split())
    names = getattr(getattr(problem, "param", None), "opts", [])
    for name, value in zip(arguments, [*arguments[1:], None], strict=True):
        if name in names and value is not None:
            return f"{message} (given: {value[:SHOWN]})"
        if name.partition("=")[0] in names:
            return f"{message} (given: {name.partition('=')[2][:SHOWN]})"
    return message
