"""Prove a steady state: one call."""

import time
from dataclasses import dataclass
from decimal import Decimal
from enum import StrEnum
from importlib.util import find_spec

from reference_lcp.chain.drives import PeriodicDrive
from reference_lcp.chain.mass_in_mass import Chain
from reference_lcp.chain.preload import Preload
from reference_lcp.defaults import PROOF_TIME_LIMIT, PROVEN_DIGITS
from reference_lcp.errors import NotProven, ParameterError
from reference_lcp.exact.proof.exact_chain import ExactChain
from reference_lcp.observables.stick_slip import Mode
from reference_lcp.validation import LONGEST_TIME_LIMIT, checked_count, checked_scalar
from reference_lcp.watching import watched

MOST_PROVEN_DIGITS = 200
"""Most digits that can be asked for."""


class Uniqueness(StrEnum):
    """Why a steady state is the only one, and is reached."""

    DAMPING = "damping"
    """Every cell has a chain dashpot: all steady states have this transmittance, and every motion tends to one."""
    CONTRACTION = "contraction"
    """All multipliers are inside the unit circle; friction being monotone, every motion tends to this one."""
    NOT_SHOWN = "not shown"
    """It is a steady state, and no other is near."""


@dataclass(frozen=True)
class Enclosure:
    """A number that is proven to be within a radius of a decimal."""

    value: Decimal
    radius: Decimal

    def contains(self, value: float | Decimal) -> bool:
        """Whether a number is in it."""
        return abs(Decimal(value) - self.value) <= self.radius


@dataclass(frozen=True)
class ProvenTransition:
    """A change of the mode of one contact."""

    cell: int
    """From 1."""
    time_over_period: Enclosure
    """When the new mode begins, over the drive's period, from its phase zero."""
    kind: Mode
    """The new mode."""


@dataclass(frozen=True)
class ProvenSteadyState:
    """A steady state that is proven to exist, and enclosures of what is read from it."""

    transmittance_db: Enclosure
    """20 log10 of the last outer mass's fundamental amplitude over the displacement scale."""
    transmittance: Enclosure
    """That amplitude over that scale."""
    phase: Enclosure
    """By which the fundamental is ahead of the drive's sine [rad]."""
    transitions: list[ProvenTransition]
    """All changes between stick and slip, by cell and then by time."""
    stuck_fraction: list[Enclosure]
    """Part of the period that each contact sticks; zero without friction."""
    unique_by: Uniqueness
    repairs: int
    """How often the order of events has been corrected."""
    seconds: float


def prove_steady_state(
    chain: Chain,
    drive: PeriodicDrive,
    preload: Preload | None = None,
    *,
    digits: int = PROVEN_DIGITS,
    time_limit: float = PROOF_TIME_LIMIT,
) -> ProvenSteadyState:
    """Prove the steady state of `chain` under `drive`: that it exists, is the only one near, and what it gives.

    All doubles of chain and drive are taken as the exact numbers that they are.

    Parameters
    ----------
    chain, drive
        What moves, and what moves it; up to 100 cells.
    preload
        How normal forces change in time, with contacts that stay closed; constant without it.
    digits
        The radius of the transmittance [dB], of phase and times is at most 10 to the minus this.
    time_limit
        Seconds after which the proof is given up.

    Raises
    ------
    NotProven
        With the step that fails, the time limit or the precision; nothing is claimed then.
    ParameterError
        If an argument is outside its range, or the drive does not repeat together with the normal force.
    """
    return prove(ExactChain.of(chain, drive, preload), digits=digits, time_limit=time_limit)


def prove(exact: ExactChain, *, digits: int = PROVEN_DIGITS, time_limit: float = PROOF_TIME_LIMIT) -> ProvenSteadyState:
    """Prove the steady state of a chain in exact numbers; arguments and errors as of `prove_steady_state`."""
    check_request(digits, time_limit)
    end = time.monotonic() + time_limit
    from reference_lcp.exact.proof.attempt import attempted

    def limited(*_told: object) -> None:
        if time.monotonic() > end:
            raise NotProven(f"the time limit of {time_limit:g} s is over")

    with watched(limited):
        return attempted(exact, digits)


def check_request(digits: int, time_limit: float) -> None:
    """Raise a `ParameterError` if a number is outside its range, or the package of ball arithmetic is missing."""
    checked_count("digits", digits, 1, MOST_PROVEN_DIGITS)
    checked_scalar("time_limit", time_limit, "> 0", LONGEST_TIME_LIMIT)
    if find_spec("flint") is None:
        raise ParameterError("a proof needs python-flint, which is not installed; pip install 'multibody-xval[proof]'")
