"""Figures that the last report in a folder has drawn: the same are not drawn again.

The folder of the figures holds an index: of each figure the digest of its description, with everything that draws it,
and the digest of each of its files. A file that is not what the index says, or not there, is drawn anew.
"""

import hashlib
import json
from collections.abc import Mapping, Sequence
from dataclasses import fields, is_dataclass
from functools import cache
from importlib.metadata import version
from pathlib import Path
from typing import Any, Protocol

import numpy as np

from reports.drawing.figure import Figure

INDEX = "drawn.json"
"""File of the index."""

DRAWN_BY = ("matplotlib_backend.py", "style.py")
"""Our own part of what draws: files beside this one."""


class _Hash(Protocol):
    def update(self, data: bytes, /) -> None: ...


def described(figure: Figure) -> str:
    """Give the digest of a figure's description and of what draws it."""
    digest = hashlib.sha256(_backend())
    _add(figure, digest)
    return digest.hexdigest()


@cache
def _backend() -> bytes:
    """Give the versions of what draws, and our part of it."""
    sources = [(Path(__file__).with_name(name)).read_text() for name in DRAWN_BY]
    return "\0".join([version("matplotlib"), version("pillow"), *sources]).encode()


def _add(value: Any, digest: _Hash) -> None:
    """Add a value to a digest, such that different values are different bytes."""
    if is_dataclass(value):
        for field in fields(value):
            _add(getattr(value, field.name), digest)
    elif isinstance(value, np.ndarray):
        digest.update(f"{value.dtype}{value.shape}".encode())
        digest.update(np.ascontiguousarray(value).tobytes())
    elif isinstance(value, Mapping):
        _add([*value.items()], digest)
    elif isinstance(value, Sequence) and not isinstance(value, str):
        digest.update(f"{len(value)} values\0".encode())
        for item in value:
            _add(item, digest)
    else:
        digest.update(f"{value!r}\0".encode())


class DrawnFigures:
    """The files of figures in a folder.

    Parameters
    ----------
    folder
        Where an earlier report may have written them.
    """

    def __init__(self, folder: Path):
        self._folder = folder
        try:
            self._index: Any = json.loads((folder / INDEX).read_text())
        except (OSError, ValueError):
            self._index = {}

    def files(self, figure: Figure) -> dict[str, bytes] | None:
        """Give the files of a figure by their endings; ``None`` where one is not there, or not what was drawn."""
        try:
            entry = self._index[figure.name]
            if entry["described"] != described(figure):
                return None
            files = {ending: (self._folder / f"{figure.name}.{ending}").read_bytes() for ending in entry["files"]}
        except (OSError, LookupError, TypeError):
            return None
        intact = all(_digest(content) == entry["files"][ending] for ending, content in files.items())
        return files if files and intact else None


def index_of(drawn: Sequence[tuple[Figure, Mapping[str, bytes]]]) -> bytes:
    """Give the content of the index for figures and their files by ending."""
    entries = {
        figure.name: {
            "described": described(figure),
            "files": {ending: _digest(content) for ending, content in files.items()},
        }
        for figure, files in drawn
    }
    return json.dumps(entries, indent=1).encode()


def _digest(content: bytes) -> str:
    return hashlib.sha256(content).hexdigest()
