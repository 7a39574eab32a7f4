"""How every command of the suite ends: with an exit code of one table, and one clear line where it is not 0."""

import io
import os
import sys
import tempfile
from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import typer

from reference_lcp.exit_code import ExitCode
from reference_lcp.interrupt import announce_interrupt, closing_on_interrupt, end_interrupted, interrupt_pending
from reference_lcp.refusal import SHOWN, ParameterError, RunError, checked_path
from reference_lcp.visible import visible

INSTALLED = Path(__file__).resolve().parents[1]
"""Where the packages of the suite lie."""

DATABASE = b"SQLite format 3\0"
"""What every SQLite file begins with, so every store."""

PROBED = 4096
"""Bytes that are written to find out whether a folder can be: a block of most file systems."""

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


def checked_output_file(name: str, file: Path, inputs: Iterable[Path | None] = ()) -> Path:
    """Give `file` if it can be written and nothing is lost by that; its folder must exist.

    Parameters
    ----------
    name
        What the user calls it.
    file
        The file.
    inputs
        Files that the command reads or keeps, there or not; ``None`` is skipped.

    Raises
    ------
    ParameterError
        If the folder is missing or not writable, or `file` is a folder, one of `inputs`, a database, or lies in a
        Python package.
    """
    checked_path(name, file)
    _refuse_package(name, file)
    for other in inputs:
        if other is not None and _same_file(file, other):
            raise ParameterError(f"{name} = {file} would overwrite {other}, which the command uses; allowed: another")
    if file.is_dir():
        raise ParameterError(f"{name} = {file} is a folder; allowed: a file")
    if not file.parent.is_dir():
        raise ParameterError(f"{name} = {file}: the folder {file.parent} does not exist")
    if _is_database(file):
        raise ParameterError(f"{name} = {file} is a store or another SQLite file; allowed: a file without results")
    _probe(name, file.resolve().parent)
    return file


def checked_output_folder(name: str, folder: Path) -> Path:
    """Give `folder`, made if it is missing, if files can be written into it.

    Raises
    ------
    ParameterError
        If it cannot be made or written, is a file, or lies in a Python package.
    """
    checked_path(name, folder)
    _refuse_package(name, folder)
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except OSError as problem:
        raise ParameterError(f"{name} = {folder} cannot be made: {problem.strerror}") from None
    _probe(name, folder)
    return folder


def _refuse_package(name: str, path: Path) -> None:
    """Refuse a path in a Python package beside this one: that is code, of the suite or of another."""
    resolved = path.resolve()
    if not resolved.is_relative_to(INSTALLED) or resolved == INSTALLED:
        return
    package = INSTALLED / resolved.relative_to(INSTALLED).parts[0]
    if (package / "__init__.py").is_file():
        raise ParameterError(f"{name} = {path} lies in the Python package {package}; allowed: outside of it")


def _same_file(file: Path, other: Path) -> bool:
    """Tell whether two names lead to one file, through links too; neither has to be there."""
    if file.exists() and other.exists():
        return file.samefile(other)
    return file.resolve() == other.resolve()


def _is_database(file: Path) -> bool:
    """Tell by its first bytes whether a file is an SQLite database."""
    if not file.is_file():
        return False
    try:
        with file.open("rb") as opened:
            return opened.read(len(DATABASE)) == DATABASE
    except OSError:
        return False


def _probe(name: str, folder: Path) -> None:
    """Write and remove a file: permissions alone do not decide on every file system."""
    try:
        with tempfile.TemporaryFile(dir=folder) as probe:
            probe.write(bytes(PROBED))  # a full disk lets an empty file be made
            probe.flush()
            os.fsync(probe.fileno())
    except OSError as problem:
        raise ParameterError(f"{name}: the folder {folder} cannot be written: {problem.strerror}") from None
