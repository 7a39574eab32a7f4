"""What a scenario is: a physical question with a known kind of answer, that is put to every variant."""

from abc import ABC, abstractmethod
from collections.abc import Sequence
from dataclasses import dataclass
from typing import ClassVar

from engines.interface.variant import Variant
from scenarios.execution.evaluator import Evaluator
from scenarios.verdicts.verdict import Comparison


@dataclass(frozen=True)
class Metric:
    """A number that is compared.

    Parameters
    ----------
    name
        As tables print it.
    unit
        Of its values; empty for a pure number.
    meaning
        What it is, in a sentence.
    """

    name: str
    unit: str
    meaning: str


@dataclass(frozen=True)
class Finding:
    """One number of one variant, and whether it is what it should be.

    Parameters
    ----------
    variant
        Whose number it is.
    case
        The parameters that tell this case from the others of the scenario, as tables print them.
    metric
        What was compared.
    value, expected
        The variant's number, and what it is compared with; NaN where there is none.
    comparison
        The verdict with its reason.
    """

    variant: Variant
    case: str
    metric: Metric
    value: float
    expected: float
    comparison: Comparison


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
