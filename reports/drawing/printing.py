"""Figures drawn for print, as many at a time as there are processors."""

import multiprocessing
import os
from collections.abc import Iterable, Sequence
from concurrent.futures import Future, ProcessPoolExecutor
from types import TracebackType
from typing import Self

from reports.drawing.drawn import DrawnFigures
from reports.drawing.figure import Figure

FEWEST = 4
"""Figures for which another process is begun: drawing one takes a third of a second."""


class Printer:
    """Files of figures, see `matplotlib_backend.print_files`; drawn in forked processes where the system has them.

    Parameters
    ----------
    figures
        What will be asked for.
    drawn
        What need not be drawn again.
    """

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
        """Give the files of a figure, by ending.

        Raises
        ------
        Exception
            Whatever drawing it raises.
        """
        if files := self._drawn.get(id(figure)):
            return files
        if id(figure) in self._files:
            return self._files[id(figure)].result()
        from reports.drawing.matplotlib_backend import print_files

        return print_files(figure)
