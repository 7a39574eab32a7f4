"""Questions to answers: from the store where they are known, from worker processes where not."""

from collections import defaultdict
from collections.abc import Callable, Iterable, Iterator, Sequence
from functools import cache

from engines.interface.registry import engine
from engines.interface.variant import Variant
from scenarios.execution.closing import Closing
from scenarios.execution.local_processes import Executor
from scenarios.execution.store import ResultStore
from scenarios.tasks.result import Result, ResultSummary
from scenarios.tasks.task import Task

Progress = Callable[[Variant, int], None]
"""Told how many answers a variant has just got: computed ones, or such as need no computation."""


def _no_progress(_variant: Variant, _count: int) -> None:
    return


class Evaluator(Closing):
    """Answers questions in parallel, and keeps every answer the moment it is there.

    Parameters
    ----------
    store
        Where answers are looked up and kept.
    executor
        Who computes; it goes when the evaluator does.

    Attributes
    ----------
    progress, recalled
        Told of answers that have been computed, and of those that needed no computation.
    """

    def __init__(self, store: ResultStore, executor: Executor):
        self._store = store
        self._executor = executor
        self._answered: dict[Task, Result] = {}
        self.progress: Progress = _no_progress
        self.recalled: Progress = _no_progress

    def evaluate(self, questions: Sequence[Task]) -> list[Result]:
        """Answer all questions, in order; one that comes again is answered from memory, blocked or not."""
        missing = []
        for question in self.unanswered(questions):
            known = self._known(question)
            if known is None:
                missing.append(question)
            else:
                self._answered[question] = known
                self.recalled(question.variant, 1)
        for batch, found in self._executor.answers(list(_batches(missing))):
            self._store.keep(zip(batch, found, strict=True))
            self._answered.update(zip(batch, found, strict=True))
            self.progress(batch[0].variant, len(batch))
        return [self._answered[question] for question in questions]

    def complete(self, questions: Iterable[Task]) -> Iterator[tuple[Task, ResultSummary]]:
        """Answer whatever the store does not know, and forget it once it is kept; gives how each question ended.

        However many questions there are, their answers are never in memory together.
        """
        missing = []
        why = cache(unavailable_reason)  # asked once a variant: the answer for 100,000 points takes no time
        for question, kept in self._store.outcomes(questions):
            reason = None if kept else _skip_reason(question, why(question.variant))
            known = kept if reason is None else ResultSummary.of(Result.blocked(reason))
            if known is None:
                missing.append(question)
            else:
                self.recalled(question.variant, 1)
                yield question, known
        for batch, found in self._executor.answers(list(_batches(missing))):
            self._store.keep(zip(batch, found, strict=True))
            self.progress(batch[0].variant, len(batch))
            yield from ((question, ResultSummary.of(answer)) for question, answer in zip(batch, found, strict=True))

    def unanswered(self, questions: Sequence[Task]) -> list[Task]:
        """Give the questions that this evaluator has not answered so far, each once."""
        return [question for question in dict.fromkeys(questions) if question not in self._answered]

    def close(self) -> None:
        """End the worker processes; what they have not begun is left undone."""
        self._executor.close()

    def _known(self, question: Task) -> Result | None:
        """Give the answer that needs no computation: a kept one, or why there cannot be one."""
        reason = _skip_reason(question, unavailable_reason(question.variant))
        return self._store.find(question) if reason is None else Result.blocked(reason)


class StoredResults(Evaluator):
    """What a store knows: nothing is computed, and what it does not know is missing.

    Parameters
    ----------
    store
        Where answers are looked up.
    """

    def __init__(self, store: ResultStore):
        self._store = store
        self._answered: dict[Task, Result] = {}
        self.progress = self.recalled = _no_progress
        self._missing = cache(unavailable_reason)

    def evaluate(self, questions: Sequence[Task]) -> list[Result]:
        """Look all questions up, in order; those that the store does not know have the status ``missing``."""
        lookup = []
        for question in self.unanswered(questions):
            reason = _skip_reason(question, self._missing(question.variant))
            if reason is None:
                lookup.append(question)
            else:
                self._answered[question] = Result.blocked(reason)
        for question, known in zip(lookup, self._store.answers(lookup), strict=True):
            self._answered[question] = known or Result.missing()
        return [self._answered[question] for question in questions]

    def complete(self, questions: Iterable[Task]) -> Iterator[tuple[Task, ResultSummary]]:
        """Give how each question ended, in order: as `Evaluator.complete`, with nothing asked."""
        for question, kept in self._store.outcomes(questions):
            reason = None if kept else _skip_reason(question, self._missing(question.variant))
            unknown = Result.missing() if reason is None else Result.blocked(reason)
            self.recalled(question.variant, 1)
            yield question, kept or ResultSummary.of(unknown)

    def close(self) -> None:
        """Leave the store open: it is its owner's."""


def unavailable_reason(variant: Variant) -> str | None:
    """Say why a variant's engine cannot be used here; ``None`` if it can."""
    return engine(variant.engine).unavailable_reason()


def _skip_reason(question: Task, missing: str | None) -> str | None:
    """Say why a question need not be asked: the engine is `missing`, or cannot represent the case."""
    if missing is not None:
        return f"not installed: {missing}"
    reason = question.unsupported_reason()
    return None if reason is None else f"cannot be represented: {reason}"


def _batches(questions: list[Task]) -> Iterator[list[Task]]:
    """Group questions that one simulation can answer, in pieces that the engine takes at once."""
    groups: dict[tuple[type[Task], Variant, int], list[Task]] = defaultdict(list)
    for question in questions:
        groups[type(question), question.variant, question.ratios.cells].append(question)
    for (_, variant, _), group in groups.items():
        size = engine(variant.engine).capabilities.batch_lanes
        for first in range(0, len(group), size):
            yield group[first : first + size]
