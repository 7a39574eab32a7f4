"""Output files: checked before any work, and complete or as they were, written beside and then renamed."""

import io
import os
import tempfile
import uuid
from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING

from reference_lcp.errors import ParameterError, RunError, checked_path

if TYPE_CHECKING:
    from matplotlib.figure import Figure

INSTALLED = Path(__file__).resolve().parents[1]
"""Where the packages of the suite lie."""

DATABASE = b"SQLite format 3\0"
"""What every SQLite file begins with, so every store."""

PROBED = 4096
"""Bytes that are written to find out whether a folder can be: a block of most file systems."""


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


def shown_in_notebooks(figure: "Figure") -> "Figure":
    """Let a notebook show a figure: it knows those of pyplot alone, which a script would have to close."""

    def png() -> bytes:
        picture = io.BytesIO()
        figure.savefig(picture, format="png", dpi=120)
        return picture.getvalue()

    figure._repr_png_ = png  # type: ignore[attr-defined]
    return figure


def write_whole(file: Path, content: str | bytes) -> None:
    """Write bytes, or a text as UTF-8; see `replacing`."""
    with replacing(file) as part:
        part.write_bytes(content.encode() if isinstance(content, str) else content)


def checked_output_file(name: str, file: Path, inputs: Iterable[Path | None] = ()) -> Path:
    """Give `file` if it can be written and nothing is lost by that, nor one of `inputs`; its folder must exist."""
    checked_path(name, file)
    _refuse_package(name, file)
    for other in inputs:
        if other is None:
            continue
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
    _probe(name, file.resolve().parent)
    return file


def checked_output_folder(name: str, folder: Path) -> Path:
    """Give `folder`, made if it is missing, if files can be written into it, and it lies in no Python package."""
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


def _is_database(file: Path) -> bool:
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
