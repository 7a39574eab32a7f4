"""What a scenario is: a physical question with a known kind of answer, that is put to every variant."""

from abc import ABC, abstractmethod
from collections.abc import Sequence
from typing import ClassVar

from engines.interface.variant import Variant
from scenarios.execution.evaluator import Evaluator
from scenarios.verdicts.finding import Finding, Metric


class Scenario(ABC):
    """A named experiment; the catalogue holds one object of each."""

    name: ClassVar[str]
    """As the command line knows it: lower case, hyphens."""
    question: ClassVar[str]
    """What is asked, in one sentence."""
    source: ClassVar[str]
    """Where the case is from: paper, equation, book."""
    expects: ClassVar[str]
    """What an answer is compared with: closed form, event-driven solution, reference with its error bar."""
    metrics: ClassVar[tuple[Metric, ...]]
    """What is compared."""

    def parameters(self) -> list[str]:
        """Give what the cases are made of beyond their names (numbers cell by cell, say), in lines."""
        return []

    @abstractmethod
    def run(self, variants: Sequence[Variant], evaluator: Evaluator) -> list[Finding]:
        """Put the question to every variant.

        Parameters
        ----------
        variants
            Who is asked. One that cannot be asked gets findings with the verdict ``blocked`` and the reason.
        evaluator
            Who answers; everything that is known from the start goes to it at once.

        Returns
        -------
        list of Finding
            For every variant and case one a metric, in this order.
        """
