"""Texts, paths and numbers of others: shown in one line that no terminal obeys, and checked before they are used."""

import os
from pathlib import Path

from reference_lcp.errors import ParameterError, shown

LARGEST_TEXT = 100_000_000
"""Characters of a user's file at most: millions of rows of a table."""


def visible(text: str) -> str:
    r"""Give a text in one line that no terminal obeys: an escape character becomes the letters ``\x1b``."""
    return "".join(own if own.isprintable() else own.encode("unicode_escape").decode() for own in text)


def text_of(problem: BaseException) -> str:
    """Give the message of an exception, also of one whose own ``__str__`` fails."""
    try:
        return str(problem)
    except BaseException as failure:  # an engine's own class
        return f"its message cannot be read ({type(failure).__name__})"


def shortened(text: str, length: int) -> str:
    """Give a text, its end left out if it has more than so many characters, and how many."""
    return text if len(text) <= length else f"{text[:length]}… ({len(text) - length} characters more)"


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


def text_of_file(name: str, file: Path, *, encoding: str = "utf-8") -> str:
    """Read a user's file whole, unless it has no end, as a device, which would fill the memory.

    Raises
    ------
    ParameterError
        If it has more than `LARGEST_TEXT` characters.
    OSError, UnicodeDecodeError
        If it cannot be read.
    """
    with checked_path(name, file).open(newline="", encoding=encoding) as opened:
        text = opened.read(LARGEST_TEXT + 1)
    if len(text) > LARGEST_TEXT:
        raise ParameterError(f"{name} {file} has more than {LARGEST_TEXT} characters; allowed: up to so many")
    return text


def is_number(text: str) -> bool:
    """Tell whether a text, as of a table, is a number: finite or not."""
    try:
        float(text)
    except ValueError:
        return False
    return True
