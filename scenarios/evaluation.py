"""Questions to answers: from the store where they are known, from worker processes where not."""

import multiprocessing
import os
from collections import defaultdict
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import Future, ProcessPoolExecutor, as_completed
from concurrent.futures.process import BrokenProcessPool
from types import TracebackType
from typing import Self

from engines.registry import engine
from engines.variant import Variant
from reference_lcp.validation import checked_count
from scenarios.answering import answer_batch
from scenarios.questions import Answer, Question
from scenarios.store import ResultStore

Progress = Callable[[Variant, int], None]
"""Told how many answers a variant has just got."""


def _no_progress(_variant: Variant, _count: int) -> None:
    return


class Evaluator:
    """Answers questions in parallel, and keeps every answer the moment it is there.

    Parameters
    ----------
    store
        Where answers are looked up and kept.
    workers
        Worker processes; as many as there are processors without it.

    Raises
    ------
    ParameterError
        If `workers` is below 1.
    """

    def __init__(self, store: ResultStore, workers: int | None = None):
        self._store = store
        self._workers = checked_count("workers", workers if workers is not None else (os.cpu_count() or 1))
        self._pool: ProcessPoolExecutor | None = None
        self._answered: dict[Question, Answer] = {}
        self.progress: Progress = _no_progress

    def evaluate(self, questions: Sequence[Question]) -> list[Answer]:
        """Answer all questions, in order; one that comes again is answered from memory, blocked or not."""
        missing = []
        for question in self.unanswered(questions):
            known = self._known(question)
            if known is None:
                missing.append(question)
            else:
                self._answered[question] = known
                self.progress(question.variant, 1)
        for batch, found in self._answers(list(_batches(missing))):
            self._store.keep(zip(batch, found, strict=True))
            self._answered.update(zip(batch, found, strict=True))
            self.progress(batch[0].variant, len(batch))
        return [self._answered[question] for question in questions]

    def unanswered(self, questions: Sequence[Question]) -> list[Question]:
        """Give the questions that this evaluator has not answered so far, each once."""
        return [question for question in dict.fromkeys(questions) if question not in self._answered]

    def close(self) -> None:
        """End the worker processes; what they have not begun is left undone."""
        if self._pool is not None:
            self._pool.shutdown(cancel_futures=True)
            self._pool = None

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, problem: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.close()

    def _known(self, question: Question) -> Answer | None:
        """Give the answer that needs no computation: a kept one, or that the engine is missing."""
        missing = engine(question.variant.engine).why_not_installed()
        return self._store.find(question) if missing is None else Answer.blocked(f"not installed: {missing}")

    def _answers(self, batches: list[list[Question]]) -> Iterator[tuple[list[Question], list[Answer]]]:
        """Answer batches in workers, as they come; batches of a broken pool are tried again alone."""
        suspects = []
        waiting = {self._submit(batch): batch for batch in batches}
        for future in as_completed(waiting):
            try:
                yield waiting[future], future.result()
            except BrokenProcessPool:
                suspects.append(waiting[future])
        for batch in suspects:
            yield batch, self._answers_alone(batch)

    def _answers_alone(self, batch: list[Question]) -> list[Answer]:
        """Answer one batch with nothing else in the pool: then a crash is its own."""
        self.close()
        try:
            return self._submit(batch).result()
        except BrokenProcessPool:
            self.close()
            return [Answer.blocked("the worker process crashed")] * len(batch)

    def _submit(self, batch: list[Question]) -> Future[list[Answer]]:
        if self._pool is None:
            # spawn: engines hold threads and locks that a forked child would find in an undefined state
            self._pool = ProcessPoolExecutor(self._workers, mp_context=multiprocessing.get_context("spawn"))
        try:
            return self._pool.submit(answer_batch, batch)
        except BrokenProcessPool as broken:
            failed: Future[list[Answer]] = Future()
            failed.set_exception(broken)
            return failed


def _batches(questions: list[Question]) -> Iterator[list[Question]]:
    """Group questions that one simulation can answer, in pieces that the engine takes at once."""
    groups: dict[tuple[Variant, int], list[Question]] = defaultdict(list)
    for question in questions:
        groups[question.variant, question.ratios.cells].append(question)
    for (variant, _), group in groups.items():
        size = engine(variant.engine).capabilities.batch_lanes
        for first in range(0, len(group), size):
            yield group[first : first + size]
