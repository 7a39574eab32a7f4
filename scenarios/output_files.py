"""Output files: checked before any work, and complete or as they were, written beside and then renamed."""

import os
import tempfile
import uuid
from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from pathlib import Path

from multibody_xval.engines.interface.texts import checked_path
from reference_lcp.errors import ParameterError


class RunError(RuntimeError):
    """A run cannot go on, and what it has computed so far is kept; the message is one line."""


DATABASE = b"SQLite format 3\0"
"""What every SQLite file begins with, so every store."""


@contextmanager
def replacing(file: Path) -> Iterator[Path]:
    """Give a path to write to, with the ending of `file`; what is written there takes its place at the end."""
    target = file.resolve()
    part = target.with_name(f".{uuid.uuid4().hex}.part{target.suffix}")
    try:
        yield part
        with part.open("r+b") as written:  # Windows writes out what is open for writing only
            os.fsync(written.fileno())
        part.replace(target)
    except OSError as problem:
        raise RunError(f"{file} cannot be written: {problem.strerror or problem}; it is as it was") from None
    finally:
        part.unlink(missing_ok=True)


def write_whole(file: Path, content: str | bytes) -> None:
    """Write bytes, or a text as UTF-8; see `replacing`."""
    with replacing(file) as part:
        part.write_bytes(content.encode() if isinstance(content, str) else content)


def checked_output_file(name: str, file: Path, inputs: Iterable[Path | None] = ()) -> Path:
    """Give `file` if it can be written and nothing is lost by that; its folder must exist."""
    checked_path(name, file)
    for other in filter(None, inputs):
        checked_path("input", other)
        there = file.exists() and other.exists()  # links too lead to one file
        if file.samefile(other) if there else file.resolve() == other.resolve():
            raise ParameterError(f"{name} = {file} would overwrite {other}, which the command uses; allowed: another")
    if file.is_dir():
        raise ParameterError(f"{name} = {file} is a folder; allowed: a file")
    if not file.parent.is_dir():
        raise ParameterError(f"{name} = {file}: the folder {file.parent} does not exist")
    if _is_database(file):
        raise ParameterError(f"{name} = {file} is a store or another SQLite file; allowed: a file without results")
    _check_writable(name, file.resolve().parent)
    return file


def checked_output_folder(name: str, folder: Path) -> Path:
    """Give `folder`, made if it is missing, if files can be written into it."""
    checked_path(name, folder)
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except OSError as problem:
        raise ParameterError(f"{name} = {folder} cannot be made: {problem.strerror}") from None
    _check_writable(name, folder)
    return folder


def _is_database(file: Path) -> bool:
    if not file.is_file():
        return False
    try:
        with file.open("rb") as opened:
            return opened.read(len(DATABASE)) == DATABASE
    except OSError:
        return False


def _check_writable(name: str, folder: Path) -> None:
    """Make and remove a file: permissions alone do not decide on every file system."""
    try:
        tempfile.TemporaryFile(dir=folder).close()
    except OSError as problem:
        where = f"{name}: the folder {folder} cannot be written: {problem.strerror}"
        raise ParameterError(f"{where}; allowed: another folder") from None
