"""Every mutant by its name, and the engine whose versions they are."""

from collections.abc import Mapping
from types import MappingProxyType
from typing import ClassVar

from multibody_xval.engines.interface.engine import Engine
from multibody_xval.engines.reference import Reference
from reference_lcp.errors import ParameterError, checked_choice
from reference_lcp.validation import checked_scalar
from tests.mutations.abilities import ABILITIES
from tests.mutations.errors import CONSTANTS, DRIVES, PARAMETERS, RECORDS
from tests.mutations.mutant import FAMILY, Mutant, MutantEngine
from tests.mutations.ranges import RANGES
from tests.mutations.steps import STEPS

MUTANTS: Mapping[str, Mutant] = MappingProxyType(
    {mutant.name: mutant for mutant in (*DRIVES, *PARAMETERS, *STEPS, *RECORDS, *RANGES, *ABILITIES, *CONSTANTS)}
)
"""Every mutant by its name."""


def mutant_engine(text: str) -> Engine:
    """Give the engine that is called ``mutant@NAME@SIZE``, of ``NAME@SIZE``."""
    name, _, size = text.partition("@")
    checked_choice("mutant", name, list(MUTANTS))
    try:
        number = float(size)
    except ValueError:
        raise ParameterError(f"engine = {f'{FAMILY}@{text}'!r}; allowed: {FAMILY}@NAME@SIZE, a number") from None
    return MutantEngine(MUTANTS[name], checked_scalar("size", number, ">= 0"))


class Mutants(Reference):
    """The reference, whose versions are ``mutant@NAME@SIZE``."""

    name: ClassVar[str] = FAMILY

    def versioned(self, version: str) -> Engine:
        """Give a mutant."""
        return mutant_engine(version)
