"""How a command ends: with an exit code of one table, and one clear line where it is not 0."""

import io
import itertools
import os
import sys
import tempfile
import traceback
from contextlib import suppress
from typing import Any

import typer

from multibody_xval.engines.interface.texts import shortened, text_of, visible
from multibody_xval.reports.cli.entry_point import interrupted
from multibody_xval.reports.cli.exit_code import ExitCode
from multibody_xval.scenarios.output_files import RunError
from reference_lcp.environment import ONE_THREAD
from reference_lcp.errors import ParameterError, shown

LONGEST_MESSAGE = 1000
"""Characters of an error that are printed."""

USAGE_ERROR: Any = typer.BadParameter.__base__
"""Of wrong options too; typer exports only this subclass."""

KINDS = {
    "valid integer": "a whole number",
    "valid number": "a number",
    "valid float": "a number",
    "valid string": "a text",
}
"""What typer's messages say of a value that is none."""


class Interrupted(Exception):
    """Ctrl-C was pressed; the message says what is kept."""


def run_command(app: typer.Typer, arguments: list[str] | None = None) -> int:
    """Run a command line and give its `ExitCode`."""
    for stream in (sys.stdout, sys.stderr):
        if isinstance(stream, io.TextIOWrapper):
            stream.reconfigure(errors="backslashreplace")  # an output in ASCII has no μ
    # commands draw into files; a backend that there is not ends matplotlib
    os.environ.update({**ONE_THREAD, **os.environ, "MPLBACKEND": "agg"})
    words = sys.argv[1:] if arguments is None else arguments
    try:
        _check_words(words)
        result = typer.main.get_command(app).main(words, prog_name=app.info.name, standalone_mode=False)
        sys.stdout.flush()  # it may go into a file on a full disk
    except BaseException as problem:  # a panic of an engine in Rust is no `Exception`
        if isinstance(problem, SystemExit) and _raised_by_typer(problem):  # after a completion
            raise
        return _ended(problem, words)
    if result == ExitCode.INTERRUPTED:  # typer's word for Ctrl-C
        _print("error: interrupted")
    return result if isinstance(result, int) else ExitCode.DONE


def _ended(problem: BaseException, words: list[str]) -> ExitCode:
    """Say in one line what has ended a command, and give its exit code."""
    if isinstance(problem, Interrupted):
        _print(str(problem))
        return ExitCode.INTERRUPTED
    if interrupted() or isinstance(problem, KeyboardInterrupt | typer.Abort):
        _print("error: interrupted")
        return ExitCode.INTERRUPTED
    if isinstance(problem, BrokenPipeError) or (
        isinstance(problem, SystemExit) and isinstance(problem.__context__, OSError)  # as click and rich end
    ):
        _discard_output()
        return ExitCode.READER_GONE
    if isinstance(problem, OSError) and problem.filename is None:
        _discard_output()
        problem = RunError(f"standard output cannot be written: {problem.strerror}")
    if isinstance(problem, USAGE_ERROR):
        problem = ParameterError(_usage(problem, words))
    if not isinstance(problem, ParameterError | RunError):
        return _report_fault(problem)
    _print(f"error: {problem}")
    return ExitCode.WRONG_INPUT if isinstance(problem, ParameterError) else ExitCode.RUN_FAILED


def _usage(problem: Any, words: list[str]) -> str:
    """Say what is wrong with the words of a command, with the value that was given for an option."""
    message, names = problem.format_message(), getattr(getattr(problem, "param", None), "opts", [])
    parts = [part for word in words for part in (word.split("=", 1) if word.startswith("--") else [word])]
    for name, value in itertools.pairwise(parts):
        if name in names:
            kind = next((own for word, own in KINDS.items() if word in message), None)
            if kind is None:
                return f"{message} (given: {shown(value)})"
            return f"{name} = {shown(value)} is not {kind}; allowed: {kind}"
    return message


def _raised_by_typer(problem: BaseException) -> bool:
    """Tell whether typer, or click within, ends the program, and not an engine; nor for a reader that is gone."""
    *_, (frame, _) = traceback.walk_tb(problem.__traceback__)
    module = str(frame.f_globals.get("__name__")).partition(".")[0]
    return module in ("typer", "click") and not isinstance(problem.__context__, OSError)


def _discard_output() -> None:
    """Let nothing of what is left be written: Python would try to at its end."""
    with suppress(OSError, ValueError):
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())


def _report_fault(problem: BaseException) -> ExitCode:
    """Say in one line what has gone wrong with the suite itself, and where the details are."""
    details, where = "".join(traceback.format_exception(problem)), "which cannot be written"
    with suppress(OSError), tempfile.NamedTemporaryFile("wb", prefix="multibody-xval-", delete=False) as file:
        file.write(details.encode(errors="backslashreplace"))
        where = file.name
    text = shortened(" ".join(text_of(problem).split()), LONGEST_MESSAGE // 2)
    _print(f"error: a fault of the suite, {type(problem).__name__}: {text}; details, for a report of it: {where}")
    return ExitCode.UNEXPECTED


def _check_words(words: list[str]) -> None:
    """Refuse an empty word, as of a variable that is not set: as a path it would be the folder one is in."""
    for before, word in itertools.pairwise(["", *words]):
        name, equals, value = word.partition("=") if word.startswith("--") else (before, "=", word)
        if equals and not value.strip():
            where = name if name.startswith("-") else "an argument"
            raise ParameterError(f"{where} = {value!r} is empty; allowed: a name, a number or a path")


def _print(text: str) -> None:
    """Print one line that any terminal shows, whatever somebody has written into a name."""
    with suppress(BrokenPipeError):
        print(shortened(visible(" ".join(text.split())), LONGEST_MESSAGE), file=sys.stderr)
