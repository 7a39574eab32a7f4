"""Every mutant by its name, and the family of engines that they are."""

from collections.abc import Mapping
from types import MappingProxyType

from engines.interface.engine import Engine
from engines.mutants.constants import CONSTANTS
from engines.mutants.drives import DRIVES
from engines.mutants.mutant import FAMILY, Mutant, MutantEngine
from engines.mutants.parameters import PARAMETERS
from engines.mutants.records import RECORDS
from engines.mutants.steps import STEPS
from reference_lcp.refusal import ParameterError, checked_choice
from reference_lcp.validation import checked_scalar

MUTANTS: Mapping[str, Mutant] = MappingProxyType(
    {mutant.name: mutant for mutant in (*DRIVES, *PARAMETERS, *STEPS, *RECORDS, *CONSTANTS)}
)
"""Every mutant by its name."""


def mutant_engine(text: str) -> Engine:
    """Give the engine that is called ``mutant@NAME@SIZE``, of ``NAME@SIZE``.

    Raises
    ------
    ParameterError
        If there is no mutant of this name, or the size is no number >= 0.
    """
    name, _, size = text.partition("@")
    checked_choice("mutant", name, list(MUTANTS))
    try:
        number = float(size)
    except ValueError:
        raise ParameterError(f"engine = {f'{FAMILY}@{text}'!r}; allowed: {FAMILY}@NAME@SIZE, a number") from None
    return MutantEngine(MUTANTS[name], checked_scalar("size", number, ">= 0"))
