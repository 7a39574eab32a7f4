"""From floating point to a proof: candidates, repairs, precision, and reading what is proven."""

import math
import time
from dataclasses import replace
from decimal import Decimal

from flint import arb, ctx

from reference_lcp.errors import NotProven
from reference_lcp.exact.event_driven import EventsAccumulate
from reference_lcp.exact.event_driven_system import AmbiguousModes
from reference_lcp.exact.proof.candidate import Candidate, candidate
from reference_lcp.exact.proof.coulomb import OutOfOrder, Violation, observe
from reference_lcp.exact.proof.dynamics import Dynamics
from reference_lcp.exact.proof.exact_chain import ExactChain
from reference_lcp.exact.proof.krawczyk import Solution, boundaries, solve
from reference_lcp.exact.proof.multipliers import contracts
from reference_lcp.exact.proof.prove import Enclosure, ProvenSteadyState, ProvenTransition, Uniqueness
from reference_lcp.exact.proof.repair import repaired, without_shortest
from reference_lcp.observables.stick_slip import MODE_OF_SIGN
from reference_lcp.watching import tell

SPARE_BITS = 62
"""Bits beyond the digits that are asked for: for the growth of balls, and for motions far below the drive's."""

PRECISIONS = (1, 2, 4)
"""Working precision over that of the first try."""

MOST_REPAIRS = 12
"""Most orders of events that are tried after the first."""


def attempted(exact: ExactChain, digits: int) -> ProvenSteadyState:
    """Prove a steady state, with more and more precision; raises `NotProven`."""
    began = time.monotonic()
    try:
        guess = candidate(exact)
    except (EventsAccumulate, AmbiguousModes) as problem:
        raise NotProven(f"floating point finds no motion to begin with: {problem}") from problem
    for factor in PRECISIONS:
        with ctx.workprec(factor * (int(3.33 * digits) + SPARE_BITS)):
            try:
                dynamics = Dynamics(exact)
                solution, integrals, repairs = proven_or_repaired(dynamics, guess)
                proven = _read(dynamics, solution, integrals, repairs, digits)
                return replace(proven, seconds=time.monotonic() - began)
            except NotProven as problem:
                reason = problem
                tell()
    raise reason


def proven_or_repaired(dynamics: Dynamics, guess: Candidate) -> tuple[Solution, tuple[arb, arb], int]:
    """Prove a candidate, or others that follow from what refutes it; gives `observe` too, and the number of repairs."""
    end = guess.start + float(dynamics.length)
    refuted: NotProven
    for repairs in range(MOST_REPAIRS + 1):
        try:
            solution = solve(dynamics, guess)
        except NotProven as problem:
            tell()
            shorter, refuted = without_shortest(guess, float(dynamics.length)), problem
            if shorter is None:
                raise
            guess = shorter
            continue
        try:
            return solution, observe(dynamics, solution), repairs
        except (Violation, OutOfOrder) as problem:
            refuted = problem
            guess = repaired(solution.candidate, problem, end)
    raise refuted


def _read(
    dynamics: Dynamics, solution: Solution, integrals: tuple[arb, arb], repairs: int, digits: int
) -> ProvenSteadyState:
    """Read everything from a proven solution."""
    real, imaginary = (2 * part / dynamics.length for part in integrals)
    amplitude = (real**2 + imaginary**2).nonnegative_part().sqrt()
    if not amplitude > 0:
        raise NotProven(f"the last mass stands still to {float(amplitude.upper()):.1g} of the drive: it has no level")
    level = 20 * amplitude.log() / arb(10).log()
    phase = arb.pi() + (imaginary / real).atan() if real < 0 and imaginary.contains(0) else arb.atan2(imaginary, real)
    transitions = _transitions(dynamics, solution)
    times = [change for _, change, _ in transitions]
    if not all(float(number.rad()) < 10.0**-digits for number in (level, phase, *times)):
        raise NotProven(f"the precision does not suffice for {digits} digits")
    unique = Uniqueness.DAMPING
    if not dynamics.exact.damped:
        unique = Uniqueness.CONTRACTION if contracts(dynamics, solution) else Uniqueness.NOT_SHOWN

    def enclosed(number: arb) -> Enclosure:
        return _rounded(number, digits + 10)

    return ProvenSteadyState(
        transmittance_db=enclosed(level),
        transmittance=enclosed(amplitude),
        phase=enclosed(phase),
        transitions=[ProvenTransition(cell, enclosed(when), MODE_OF_SIGN[mode]) for cell, when, mode in transitions],
        stuck_fraction=[enclosed(_stuck(dynamics, solution, cell)) for cell in range(dynamics.cells)],
        unique_by=unique,
        repairs=repairs,
        seconds=math.nan,
    )


def _rounded(number: arb, digits: int) -> Enclosure:
    """Round a ball to so many digits, outwards."""
    middle, radius, exponent = (int(part) for part in number.mid_rad_10exp(digits))
    return Enclosure(*(Decimal(f"{part}E{exponent}") for part in (middle, radius)))


def _transitions(dynamics: Dynamics, solution: Solution) -> list[tuple[int, arb, int]]:
    """Give cells from 1, times over the drive's period and new modes of a whole cycle."""
    period, cycle = 2 * arb.pi() / dynamics.omega, dynamics.exact.cycle
    changes = []
    for when, (cell, new) in zip(
        boundaries(dynamics, solution.candidate)[1:-1], solution.candidate.events, strict=True
    ):
        for shift, sign in ((0, 1), (dynamics.length, -1))[: 2 if dynamics.exact.half else 1]:
            part = (when + shift) / period
            changes.append((cell + 1, part - cycle * (float(part.mid()) // cycle), sign * new))
    return sorted(changes, key=lambda change: (change[0], float(change[1].mid())))


def _stuck(dynamics: Dynamics, solution: Solution, cell: int) -> arb:
    """Part of the time that a contact sticks."""
    times, events = boundaries(dynamics, solution.candidate)[1:-1], solution.candidate.events
    if cell in solution.candidate.always_stuck:
        return arb(1)
    own = [place for place, (other, _) in enumerate(events) if other == cell]
    total = arb(0)
    for place, after in zip(own, [*own[1:], *own[:1]], strict=True):
        if events[place][1] == 0:  # the next event may be one of the next map
            total += (times[after] - times[place]) / dynamics.length + (after <= place)
    return total
