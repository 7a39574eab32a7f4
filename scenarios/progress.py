"""Progress bars: one a variant, each question counted once."""

from collections import Counter
from collections.abc import Sequence
from types import TracebackType
from typing import Self

from rich.console import Console
from rich.progress import BarColumn, MofNCompleteColumn, Progress, TaskID, TextColumn, TimeElapsedColumn

from engines.variant import Variant
from scenarios.evaluation import Evaluator
from scenarios.isolation import Crew
from scenarios.questions import Answer, Asked
from scenarios.store import ResultStore


class Bars:
    """A bar for each variant of a question, on standard error.

    Parameters
    ----------
    variants
        In the order of the bars.
    """

    def __init__(self, variants: Sequence[Variant]):
        self._bars = Progress(
            TextColumn("{task.description}"),
            BarColumn(),
            MofNCompleteColumn(),
            TextColumn("points"),
            TimeElapsedColumn(),
            console=Console(stderr=True),
        )
        self._tasks: dict[Variant, TaskID] = {v: self._bars.add_task(v.title, total=0) for v in variants}

    def expect(self, variant: Variant, count: int) -> None:
        """Add to what a variant has to answer."""
        task = self._tasks[variant]
        self._bars.update(task, total=(self._bars.tasks[task].total or 0) + count)

    def advance(self, variant: Variant, count: int) -> None:
        """Add to what a variant has answered."""
        self._bars.advance(self._tasks[variant], count)

    def __enter__(self) -> Self:
        self._bars.start()
        return self

    def __exit__(
        self, kind: type[BaseException] | None, problem: BaseException | None, trace: TracebackType | None
    ) -> None:
        self._bars.stop()


class CountingEvaluator(Evaluator):
    """An evaluator that shows how far it is: a bar's total is what is known to be asked, each question once.

    What is expected is known from the start. Points that are added where a curve needs them, and those that
    refine an edge, are added to the total when they are asked.

    Parameters
    ----------
    store, crew
        As for every evaluator.
    expected
        What will be asked in any case.
    bars
        Where progress is shown.
    """

    def __init__(self, store: ResultStore, crew: Crew, expected: Sequence[Asked], bars: Bars):
        super().__init__(store, crew)
        self._bars = bars
        self._expected: set[Asked] = set()
        self.progress = bars.advance
        self._expect(expected)

    def evaluate(self, questions: Sequence[Asked]) -> list[Answer]:
        """Answer all questions, in order."""
        self._expect(self.unanswered(questions))
        return super().evaluate(questions)

    def _expect(self, questions: Sequence[Asked]) -> None:
        """Raise the totals by the questions that were not expected so far."""
        extra = [question for question in questions if question not in self._expected]
        self._expected.update(extra)
        for variant, count in Counter(question.variant for question in extra).items():
            self._bars.expect(variant, count)
