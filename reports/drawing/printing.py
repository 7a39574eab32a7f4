"""Figures drawn for print, as many at a time as there are processors; those that are drawn already are taken."""

import hashlib
import json
import multiprocessing
import os
from collections.abc import Iterable, Mapping, Sequence
from concurrent.futures import Future, ProcessPoolExecutor
from dataclasses import is_dataclass
from functools import cache
from importlib.metadata import version
from pathlib import Path
from types import TracebackType
from typing import Any, Self

import numpy as np

from reports.drawing.figure import Figure

INDEX = "drawn.json"
"""File of the index."""

DRAWN_BY = ("matplotlib_backend.py", "style.py")
"""Our own part of what draws: files beside this one."""


def described(figure: Figure) -> str:
    """Give the digest of a figure's description and of what draws it."""
    return _digest(_backend() + json.dumps(figure, default=_plain).encode())


def _plain(value: object) -> object:
    """Give a part of a figure, or an array, as JSON has it."""
    return vars(value) if is_dataclass(value) else np.asarray(value).tolist()


@cache
def _backend() -> bytes:
    """Give the versions of what draws, and our part of it."""
    sources = [(Path(__file__).with_name(name)).read_text() for name in DRAWN_BY]
    return "\0".join([version("matplotlib"), version("pillow"), *sources]).encode()


class DrawnFigures:
    """The files of figures in a folder."""

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


FEWEST = 4
"""Figures for which another process is begun: drawing one takes a third of a second."""


class Printer:
    """Files of figures, see `matplotlib_backend.print_files`; drawn in forked processes where the system has them."""

    def __init__(self, figures: Iterable[Figure], drawn: DrawnFigures | None = None):
        every = list(figures)
        self._drawn = {} if drawn is None else {id(figure): drawn.files(figure) for figure in every}
        self._pool: ProcessPoolExecutor | None = None
        self._files: dict[int, Future[dict[str, bytes]]] = {}
        self._begin([figure for figure in every if not self._drawn.get(id(figure))])

    def _begin(self, expected: Sequence[Figure]) -> None:
        """Draw figures in processes, if there are enough of them."""
        processes = min(os.cpu_count() or 1, len(expected) // FEWEST)
        if processes > 1 and "fork" in multiprocessing.get_all_start_methods():
            from reports.drawing.matplotlib_backend import print_files  # imported once, before processes are forked

            self._pool = ProcessPoolExecutor(processes, multiprocessing.get_context("fork"))
            self._files = {id(figure): self._pool.submit(print_files, figure) for figure in expected}

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, problem: BaseException | None, trace: TracebackType | None
    ) -> None:
        if self._pool is not None:
            self._pool.shutdown(cancel_futures=True)

    def files(self, figure: Figure) -> dict[str, bytes]:
        """Give the files of a figure, by ending."""
        if files := self._drawn.get(id(figure)):
            return files
        if id(figure) in self._files:
            return self._files[id(figure)].result()
        from reports.drawing.matplotlib_backend import print_files

        return print_files(figure)
