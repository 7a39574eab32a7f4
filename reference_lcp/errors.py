"""What ends a command: refused input, a run that cannot go on, and exit codes; imports no NumPy."""

import difflib
import os
from collections.abc import Sequence
from enum import IntEnum
from pathlib import Path

SHOWN = 80
"""Characters of a value that a message shows."""


class ParameterError(ValueError):
    """A parameter outside its allowed range; the message is one line."""


class RunError(RuntimeError):
    """A run cannot go on, and what it has computed so far is kept; the message is one line."""


def text_of(problem: BaseException) -> str:
    """Give the message of an exception, also of one whose own ``__str__`` fails."""
    try:
        return str(problem)
    except BaseException as failure:  # an engine's own class
        return f"its message cannot be read ({type(failure).__name__})"


def shortened(text: str, length: int) -> str:
    """Give a text, its end left out if it has more than so many characters, and how many."""
    return text if len(text) <= length else f"{text[:length]}… ({len(text) - length} characters more)"


def shown(value: object) -> str:
    """Give a value as a message shows it: in one line, and the beginning of a long one."""
    try:
        text = repr(value)
    except ValueError:  # integers of more than 4300 digits have no text
        return "a number of more than 4300 digits"
    return text if len(text) <= SHOWN else f"{text[:SHOWN]}… ({len(text)} characters)"


def checked_path(name: str, path: str | os.PathLike[str]) -> Path:
    """Give a path that the system can name, whether or not something is there."""
    if isinstance(path, str) and not path.strip():
        raise ParameterError(f"{name} = {path!r} is empty; allowed: a path")
    try:
        checked = Path(path)
        checked.absolute().lstat()
    except (FileNotFoundError, NotADirectoryError, PermissionError):
        return checked
    except (OSError, ValueError, TypeError) as problem:
        reason = problem.strerror if isinstance(problem, OSError) else problem
        raise ParameterError(f"{name} = {shown(str(path))} is no path: {reason}; allowed: a path") from None
    return checked


def checked_choice(name: str, value: str, allowed: Sequence[str]) -> str:
    """Give `value` if it is one of `allowed`; else raise `ParameterError` with these."""
    if value in allowed:
        return value
    raise ParameterError(f"{name} = {shown(value)} is unknown; {choices(value, allowed)}")


def choices(value: object, allowed: Sequence[str]) -> str:
    """List the names that are allowed in place of `value`, and ask whether the one most like it was meant.

    Names with commas are quoted.
    """
    names = [repr(name) if "," in name else name for name in allowed]
    return f"allowed: {', '.join(names)}{meant(value, allowed)}"


def meant(value: object, allowed: Sequence[str]) -> str:
    """Ask whether the name most like a value was meant, or the first that begins with it; else give an empty text."""
    text = str(value)[:SHOWN]
    begun = [name for name in allowed if text and name.startswith(text)]
    near = difflib.get_close_matches(text, allowed, 1) or begun
    return f"; did you mean {near[0]}?" if near else ""


class ExitCode(IntEnum):
    """How a command ended."""

    DONE = 0
    """The command succeeded."""
    FAILED = 1
    """A comparison failed: a judged number deviates, too many numbers of a judged preset are missing, a named engine
    fails too often, something became worse, or there is no steady state."""
    WRONG_INPUT = 2
    """The input is refused: a value, a damaged store, an output that cannot be written, an engine that is missing."""
    RUN_FAILED = 3
    """The run could not go on, or its outputs could not be written: a full disk, a store that is gone or stays locked,
    a lost cluster."""
    UNEXPECTED = 4
    """A fault of the suite itself; the line names a file with the details, which belong into a report of it."""
    INTERRUPTED = 130
    """It was stopped by Ctrl-C; shells use this number too."""
    READER_GONE = 141
    """What read its output has closed it, as ``head`` does; shells use this number too."""
