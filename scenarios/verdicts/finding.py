"""One number of one variant, and whether it is what it should be."""

from dataclasses import dataclass

from engines.interface.variant import Variant
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
