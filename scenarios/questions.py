"""Questions that engines are asked, and their answers, as plain data."""

import dataclasses
import hashlib
import json
import math
from dataclasses import dataclass, field
from functools import cache
from typing import Any, Self

from engines.registry import engine
from engines.variant import Variant
from reference_lcp.chain import Chain
from reference_lcp.drive import HarmonicBase
from reference_lcp.simulation import MINIMUM_STEPS_PER_PERIOD
from reference_lcp.stick_slip import STICK_MARGIN

ANSWER_FORMAT = 2
"""Raised when the meaning of an answer changes: answers of other formats are not taken from a store."""


Ratio = float | tuple[float, ...]
"""One number for all cells, or one a cell."""


@dataclass(frozen=True, kw_only=True)
class ChainRatios:
    """The chain but for its friction, non-dimensional; the defaults are the canonical case of figure 3.

    The parameters are those of `Chain.from_ratios`; every ratio is a number, or one a cell.
    """

    cells: int = 7
    mass_ratio: Ratio = 1.0
    stiffness_ratio: Ratio = 1.0
    damping_ratio: Ratio = 0.01
    inner_damping_ratio: Ratio = 0.0

    def chain(self, friction_ratio: Ratio) -> Chain:
        """Build the chain with this friction ratio μ λ_N / (k_c U0)."""
        return Chain.from_ratios(friction_ratio=friction_ratio, **dataclasses.asdict(self))


@dataclass(frozen=True, kw_only=True)
class Asked:
    """What every question says: who is asked, and about which chain.

    Parameters
    ----------
    variant
        Who is asked.
    ratios
        The chain but for its friction.
    friction_ratio
        μ λ_N / (k_c U0), a number or one a cell.
    """

    variant: Variant
    friction_ratio: Ratio
    ratios: ChainRatios = field(default_factory=ChainRatios)

    @property
    def chain(self) -> Chain:
        """Build the chain."""
        return self.ratios.chain(self.friction_ratio)

    def content(self) -> dict[str, Any]:
        """Everything that the answer depends on: the question, the engine's version and its options."""
        return {"format": ANSWER_FORMAT, "question": dataclasses.asdict(self), **_identity(self.variant)}

    def key(self) -> str:
        """Hash of the content: equal for equal questions to equal engines."""
        return hashlib.sha256(json.dumps(self.content(), sort_keys=True).encode()).hexdigest()


@dataclass(frozen=True, kw_only=True)
class Question(Asked):
    """The steady state of one chain under one harmonic base motion, by one variant.

    Parameters
    ----------
    variant, ratios, friction_ratio
        As for `Asked`.
    frequency_ratio
        ω / ω_r, with ω_r of the first cell.
    steps_per_period
        Fewest steps a period; more are taken where dt ω_max <= 0.4 asks for them.
    """

    frequency_ratio: float
    steps_per_period: int = MINIMUM_STEPS_PER_PERIOD

    def setting(self) -> tuple[Chain, HarmonicBase]:
        """Build the chain and its drive."""
        chain = self.chain
        return chain, HarmonicBase.from_ratio(chain, self.frequency_ratio)


@dataclass(frozen=True, kw_only=True)
class Answer:
    """What came of a question.

    Parameters
    ----------
    status
        ``converged``, ``period limit``, ``diverged``, ``blocked`` or ``missing`` (not asked so far).
    reason
        Why it is blocked or missing; empty otherwise.
    transmittance_db
        20 log10 |U_n| / U0; NaN where there is no number.
    residual
        Periodicity residual of the orbit; NaN where there is none.
    periods
        Periods simulated.
    steps_per_period
        Steps a period that were taken.
    period
        Period of the drive [s].
    stuck_fraction
        Part of the period that each contact sticks.
    transitions
        Changes of mode as (cell from 1, time [s], new mode).
    creep
        Largest |ġ_T| of each contact within a stick, over ω and the displacement scale.
    seconds
        Wall-clock time that the point took, an even share of its batch.
    """

    status: str
    reason: str = ""
    transmittance_db: float = math.nan
    residual: float = math.nan
    periods: int = 0
    steps_per_period: int = 0
    period: float = math.nan
    stuck_fraction: tuple[float, ...] = ()
    transitions: tuple[tuple[int, float, str], ...] = ()
    creep: tuple[float, ...] = ()
    seconds: float = math.nan

    @property
    def converged(self) -> bool:
        """Whether the numbers belong to a steady state."""
        return self.status == "converged"

    @classmethod
    def blocked(cls, reason: str) -> Self:
        """Say why there is no answer."""
        return cls(status="blocked", reason=" ".join(reason.split()))

    @classmethod
    def missing(cls) -> Self:
        """Stand for an answer that nobody has given so far."""
        return cls(status="missing", reason="not answered so far")

    def to_json(self) -> str:
        """Give the answer as JSON; NaN becomes null."""
        numbers = dataclasses.asdict(self)
        return json.dumps({name: None if _is_nan(value) else value for name, value in numbers.items()})

    @classmethod
    def from_json(cls, text: str) -> Self:
        """Read what `to_json` wrote."""
        numbers: dict[str, Any] = {
            name: math.nan if value is None else value for name, value in json.loads(text).items()
        }
        numbers["stuck_fraction"], numbers["creep"] = tuple(numbers["stuck_fraction"]), tuple(numbers["creep"])
        numbers["transitions"] = tuple((cell, time, kind) for cell, time, kind in numbers["transitions"])
        return cls(**numbers)


@cache
def _identity(variant: Variant) -> dict[str, Any]:
    """Version and options that a variant's answers depend on."""
    asked = engine(variant.engine)
    preset = asked.preset(variant.formulation, variant.preset)
    identity: dict[str, Any] = {
        "version": asked.version(),
        "options": {name: repr(option.value) for name, option in sorted(preset.options.items())},
    }
    return identity if preset.stick_margin == STICK_MARGIN else identity | {"stick_margin": preset.stick_margin}


def _is_nan(value: object) -> bool:
    return isinstance(value, float) and math.isnan(value)
