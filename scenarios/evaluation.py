"""Questions to answers: from the store where they are known, from worker processes where not."""

from collections import defaultdict
from collections.abc import Callable, Iterable, Iterator, Sequence
from functools import cache

from engines.registry import engine
from engines.variant import Variant
from scenarios.closing import Closing
from scenarios.isolation import Crew
from scenarios.questions import Answer, Question
from scenarios.store import ResultStore

Progress = Callable[[Variant, int], None]
"""Told how many answers a variant has just got."""


def _no_progress(_variant: Variant, _count: int) -> None:
    return


class Evaluator(Closing):
    """Answers questions in parallel, and keeps every answer the moment it is there.

    Parameters
    ----------
    store
        Where answers are looked up and kept.
    crew
        Who computes; it goes when the evaluator does.
    """

    def __init__(self, store: ResultStore, crew: Crew):
        self._store = store
        self._crew = crew
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
        for batch, found in self._crew.answers(list(_batches(missing))):
            self._store.keep(zip(batch, found, strict=True))
            self._answered.update(zip(batch, found, strict=True))
            self.progress(batch[0].variant, len(batch))
        return [self._answered[question] for question in questions]

    def complete(self, questions: Iterable[Question]) -> Iterator[tuple[Question, str]]:
        """Answer whatever the store does not know, and forget it once it is kept; gives each question's status.

        However many questions there are, their answers are never in memory together.
        """
        missing = []
        for question, status in self._store.statuses(questions):
            known = status or self._status_unasked(question)
            if known is None:
                missing.append(question)
            else:
                self.progress(question.variant, 1)
                yield question, known
        for batch, found in self._crew.answers(list(_batches(missing))):
            self._store.keep(zip(batch, found, strict=True))
            self.progress(batch[0].variant, len(batch))
            yield from ((question, answer.status) for question, answer in zip(batch, found, strict=True))

    def unanswered(self, questions: Sequence[Question]) -> list[Question]:
        """Give the questions that this evaluator has not answered so far, each once."""
        return [question for question in dict.fromkeys(questions) if question not in self._answered]

    def close(self) -> None:
        """End the worker processes; what they have not begun is left undone."""
        self._crew.close()

    def _status_unasked(self, question: Question) -> str | None:
        """Give the status that needs neither the store nor a computation."""
        return None if engine(question.variant.engine).why_not_installed() is None else "blocked"

    def _known(self, question: Question) -> Answer | None:
        """Give the answer that needs no computation: a kept one, or that the engine is missing."""
        missing = engine(question.variant.engine).why_not_installed()
        return self._store.find(question) if missing is None else Answer.blocked(f"not installed: {missing}")


class StoredAnswers(Evaluator):
    """What a store knows: nothing is computed, and what it does not know is missing.

    Parameters
    ----------
    store
        Where answers are looked up.
    """

    def __init__(self, store: ResultStore):
        self._store = store
        self._answered: dict[Question, Answer] = {}
        self._missing = cache(lambda name: engine(name).why_not_installed())

    def evaluate(self, questions: Sequence[Question]) -> list[Answer]:
        """Look all questions up, in order; those that the store does not know have the status ``missing``."""
        lookup = []
        for question in self.unanswered(questions):
            reason = self._missing(question.variant.engine)
            if reason is None:
                lookup.append(question)
            else:
                self._answered[question] = Answer.blocked(f"not installed: {reason}")
        for question, known in zip(lookup, self._store.answers(lookup), strict=True):
            self._answered[question] = known or Answer.missing()
        return [self._answered[question] for question in questions]

    def close(self) -> None:
        """Leave the store open: it is its owner's."""


def _batches(questions: list[Question]) -> Iterator[list[Question]]:
    """Group questions that one simulation can answer, in pieces that the engine takes at once."""
    groups: dict[tuple[Variant, int], list[Question]] = defaultdict(list)
    for question in questions:
        groups[question.variant, question.ratios.cells].append(question)
    for (variant, _), group in groups.items():
        size = engine(variant.engine).capabilities.batch_lanes
        for first in range(0, len(group), size):
            yield group[first : first + size]
