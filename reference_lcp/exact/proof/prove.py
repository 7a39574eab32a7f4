"""Prove a steady state: one call."""

from dataclasses import dataclass
from decimal import Decimal
from enum import StrEnum
from typing import Any

from flint import arb, ctx

from reference_lcp.chain.drives import PeriodicDrive
from reference_lcp.chain.mass_in_mass import Chain
from reference_lcp.chain.preload import Preload
from reference_lcp.exact.proof.candidate import Candidate, candidate
from reference_lcp.exact.proof.coulomb import Observed, OutOfOrder, Violation, boundaries, observe
from reference_lcp.exact.proof.dynamics import Dynamics
from reference_lcp.exact.proof.exact_chain import ExactChain
from reference_lcp.exact.proof.krawczyk import Solution, solve
from reference_lcp.exact.proof.multipliers import multiplier_bound
from reference_lcp.exact.proof.outcome import Deadline, NotProven
from reference_lcp.exact.proof.repair import repaired
from reference_lcp.observables.stick_slip import MODE_OF_SIGN, Mode
from reference_lcp.validation import LONGEST_TIME_LIMIT, checked_count, checked_scalar

MOST_PROVEN_DIGITS = 200
"""Most digits that can be asked for."""

SPARE_BITS = 62
"""Bits beyond the digits that are asked for: for the growth of balls, and for levels of motions far below the drive's."""

PRECISIONS = (1, 2, 4)
"""Working precision over that of the first try."""

MOST_REPAIRS = 12
"""Most orders of events that are tried after the first."""

PROOF_TIME_LIMIT = 60.0
"""Time limit of a proof [s]."""


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

    @classmethod
    def of(cls, number: arb, digits: int) -> "Enclosure":
        """Round a ball to so many digits, outwards."""
        middle, radius, exponent = (int(part) for part in number.mid_rad_10exp(digits))
        return cls(*(Decimal(f"{part}E{exponent}") for part in (middle, radius)))

    def contains(self, value: float | Decimal) -> bool:
        """Whether a number is in it."""
        return abs(Decimal(value) - self.value) <= self.radius

    def as_dict(self) -> dict[str, str]:
        """Give both as decimal strings, ready for JSON."""
        return {"value": str(self.value), "radius": str(self.radius)}


@dataclass(frozen=True)
class ProvenTransition:
    """A change of the mode of one contact."""

    cell: int
    """From 1."""
    time: Enclosure
    """When the new mode begins, over the drive's period, from its phase zero."""
    kind: Mode
    """The new mode."""

    def as_dict(self) -> dict[str, Any]:
        """Give it ready for JSON."""
        return {"cell": self.cell, "kind": str(self.kind), "time_over_period": self.time.as_dict()}


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
    largest_slip: Enclosure
    """Largest distance that a contact slips at a time, over the displacement scale."""
    margin: float
    """Smallest distance of a sticking force from its bound, over the bound, where it is not about to leave it; ∞ if
    nothing sticks."""
    multipliers_bound: float
    """Upper bound of all multipliers of a period, but for offsets of contacts that always stick."""
    unique_by: Uniqueness
    inequalities: int
    """Number of inequalities of Coulomb's law that have been proven on intervals."""
    repairs: int
    """How often the order of events has been corrected."""
    seconds: float

    def as_dict(self) -> dict[str, Any]:
        """Give it ready for JSON."""
        return {
            "status": "proven",
            "reason": None,
            "transmittance_db": self.transmittance_db.as_dict(),
            "transmittance": self.transmittance.as_dict(),
            "phase": self.phase.as_dict(),
            "transitions": [change.as_dict() for change in self.transitions],
            "stuck_fraction": [fraction.as_dict() for fraction in self.stuck_fraction],
            "largest_slip": self.largest_slip.as_dict(),
            "margin": self.margin if self.margin < float("inf") else None,
            "multipliers_bound": self.multipliers_bound,
            "unique_by": str(self.unique_by),
            "inequalities": self.inequalities,
            "repairs": self.repairs,
            "seconds": self.seconds,
        }


def prove_steady_state(
    chain: Chain,
    drive: PeriodicDrive,
    preload: Preload | None = None,
    *,
    digits: int = 20,
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


def prove(exact: ExactChain, *, digits: int = 20, time_limit: float = PROOF_TIME_LIMIT) -> ProvenSteadyState:
    """Prove the steady state of a chain in exact numbers; arguments and errors as of `prove_steady_state`."""
    checked_count("digits", digits, 1, MOST_PROVEN_DIGITS)
    deadline = Deadline(checked_scalar("time_limit", time_limit, "> 0", LONGEST_TIME_LIMIT))
    guess = candidate(exact)
    for factor in PRECISIONS:
        with ctx.workprec(factor * (int(3.33 * digits) + SPARE_BITS)):
            try:
                dynamics = Dynamics(exact)
                solution, observed, repairs = _proven(dynamics, guess, deadline)
                return _read(dynamics, solution, observed, repairs, digits, deadline)
            except NotProven as problem:
                reason = problem
                deadline.check()
    raise reason


def _proven(dynamics: Dynamics, guess: Candidate, deadline: Deadline) -> tuple[Solution, Observed, int]:
    """Prove a candidate, or others that follow from what refutes it."""
    end = guess.start + float(dynamics.length)
    for repairs in range(MOST_REPAIRS + 1):
        solution = solve(dynamics, guess, deadline)
        try:
            return solution, observe(dynamics, solution, deadline), repairs
        except (Violation, OutOfOrder) as problem:
            refuted = problem
            guess = repaired(solution.candidate, problem, end)
    raise refuted


def _read(
    dynamics: Dynamics, solution: Solution, observed: Observed, repairs: int, digits: int, deadline: Deadline
) -> ProvenSteadyState:
    """Read everything from a proven solution."""
    real, imaginary = (2 * part / dynamics.length for part in (observed.sine, observed.cosine))
    amplitude = (real**2 + imaginary**2).nonnegative_part().sqrt()
    if not amplitude > 0:
        raise NotProven(f"the last mass stands still to {float(amplitude.upper()):.1g} of the drive: it has no level")
    level = 20 * amplitude.log() / arb(10).log()
    phase = arb.pi() + (imaginary / real).atan() if real < 0 and imaginary.contains(0) else arb.atan2(imaginary, real)
    transitions = _transitions(dynamics, solution)
    times = [change for _, change, _ in transitions]
    if not all(float(number.rad()) < 10.0**-digits for number in (level, phase, *times)):
        raise NotProven(f"the precision does not suffice for {digits} digits")
    bound, contracts = multiplier_bound(dynamics, solution, deadline)
    unique = Uniqueness.CONTRACTION if contracts else Uniqueness.NOT_SHOWN

    def enclosed(number: arb) -> Enclosure:
        return Enclosure.of(number, digits + 10)

    return ProvenSteadyState(
        transmittance_db=enclosed(level),
        transmittance=enclosed(amplitude),
        phase=enclosed(phase),
        transitions=[ProvenTransition(cell, enclosed(when), MODE_OF_SIGN[mode]) for cell, when, mode in transitions],
        stuck_fraction=[enclosed(_stuck(dynamics, solution, cell)) for cell in range(dynamics.cells)],
        largest_slip=enclosed(_largest_slip(dynamics, solution)),
        margin=observed.margin,
        multipliers_bound=bound,
        unique_by=Uniqueness.DAMPING if dynamics.exact.damped else unique,
        inequalities=observed.inequalities,
        repairs=repairs,
        seconds=deadline.elapsed,
    )


def _transitions(dynamics: Dynamics, solution: Solution) -> list[tuple[int, arb, int]]:
    """Give cells from 1, times over the drive's period and new modes of a whole cycle."""
    period, cycle = 2 * arb.pi() / dynamics.omega, dynamics.exact.cycle
    changes = []
    for when, (cell, new) in zip(boundaries(dynamics, solution)[1:-1], solution.candidate.events, strict=True):
        for shift, sign in ((0, 1), (dynamics.length, -1))[: 2 if dynamics.exact.half else 1]:
            part = (when + shift) / period
            changes.append((cell + 1, part - cycle * (float(part.mid()) // cycle), sign * new))
    return sorted(changes, key=lambda change: (change[0], float(change[1].mid())))


def _phases(dynamics: Dynamics, solution: Solution, cell: int) -> list[tuple[int, int, int]]:
    """Give events of a cell from zero, what follows, and whether the next event is one of the next map."""
    own = [place for place, (other, _) in enumerate(solution.candidate.events) if other == cell]
    following = [*own[1:], *own[:1]]
    return [(place, after, int(after <= place)) for place, after in zip(own, following, strict=True)]


def _stuck(dynamics: Dynamics, solution: Solution, cell: int) -> arb:
    """Part of the time that a contact sticks."""
    times, events = boundaries(dynamics, solution)[1:-1], solution.candidate.events
    if cell in solution.candidate.always_stuck:
        return arb(1)
    total = arb(0)
    for place, after, wraps in _phases(dynamics, solution, cell):
        if events[place][1] == 0:
            total += (times[after] - times[place]) / dynamics.length + wraps
    return total


def _largest_slip(dynamics: Dynamics, solution: Solution) -> arb:
    """Largest distance that a contact with friction slips between two of its events."""
    longest = arb(0)
    for cell in dynamics.rubbing:
        for place, after, wraps in _phases(dynamics, solution, cell):
            if solution.candidate.events[place][1]:
                here, there = (solution.ends[end][dynamics.cells + cell][0] for end in (place, after))
                longest = arb.max(longest, abs((dynamics.sign if wraps else 1) * there - here))
    return longest
