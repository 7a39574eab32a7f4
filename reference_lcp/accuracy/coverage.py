"""Coverage: how often the exact motion of random chains lies within them, and how much too wide they are."""

import dataclasses
import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from reference_lcp.accuracy.error_bar import REFINEMENTS, ErrorBar, error_bar, euler_orbit
from reference_lcp.accuracy.richardson import SAFETY
from reference_lcp.chain.harmonic import HarmonicBase
from reference_lcp.chain.mass_in_mass import Chain
from reference_lcp.chain.simulation import steps_per_period_for
from reference_lcp.exact.event_driven import EventsAccumulate
from reference_lcp.exact.exact_orbit import ExactPeriod
from reference_lcp.exact.steady import exact_orbit
from reference_lcp.observables.stick_slip import stuck_fraction, transitions
from reference_lcp.observables.transition_matching import match_transitions
from reference_lcp.observables.transmittance import decibel, transmittance
from reference_lcp.steady.orbits import PeriodicOrbit
from reference_lcp.validation import checked_count

MOST_RANDOM_CHAINS = 100_000
"""Most chains of a study: some seven hours."""

DEEP_DB = -100.0
"""Transmittance [dB] below which residuals matter: those of 1e-8 are −160 dB, and resonances amplify them."""

QUANTITIES = (
    "transmittance",
    "transmittance by two steps",
    "transmittance below −100 dB",
    "floor of transmittance",
    "stuck fraction",
    "transition time",
)
"""What has a bar. A floor stands where the transmittance is below what can be resolved; the two steps are the judged
one and one twice as large."""


@dataclass(frozen=True)
class Coverage:
    """How well the bars of one quantity at one number of steps cover the exact values.

    Parameters
    ----------
    quantity
        One of `QUANTITIES`.
    refinement
        Number of steps over the fewest, one of `REFINEMENTS`.
    margins
        Bar over true error of everything that has a bar, shape (compared,): at least one where the bar covers. Of a
        floor, floor over exact amplitude. Zero for a transition that is missed or spurious without being flagged.
    undecided
        Transitions that the bar flags as undecided.
    """

    quantity: str
    refinement: int
    margins: tuple[float, ...]
    undecided: int = 0

    def covered(self, smaller: float = 1.0) -> float:
        """Part of the exact values that bars divided by `smaller` cover; NaN without any."""
        return float(np.mean(np.array(self.margins) >= smaller)) if self.margins else math.nan

    @property
    def median_margin(self) -> float:
        """Median of bar over true error; NaN without any."""
        return float(np.median(self.margins)) if self.margins else math.nan

    def as_dict(self) -> dict[str, Any]:
        """Give the numbers, ready for JSON; what is not known is ``None``."""
        numbers = {
            "covered": self.covered(),
            "covered_without_safety": self.covered(SAFETY),
            "median_bar_over_error": self.median_margin,
        }
        known = {name: number if math.isfinite(number) else None for name, number in numbers.items()}
        compared = {"compared": len(self.margins), "undecided": self.undecided}
        return {"quantity": self.quantity, "refinement": self.refinement, **compared, **known}


@dataclass(frozen=True)
class CoverageStudy:
    """Coverage of all quantities over random chains.

    Parameters
    ----------
    chains
        Random chains.
    uncertified
        Of these, chains without a certified steady state by one of the two, which are left out.
    rows
        By quantity and number of steps.
    """

    chains: int
    uncertified: int
    rows: tuple[Coverage, ...]

    def as_dict(self) -> dict[str, Any]:
        """Give the numbers, ready for JSON."""
        return {"chains": self.chains, "uncertified": self.uncertified, "rows": [row.as_dict() for row in self.rows]}


def coverage(chains: int, seed: int, track: Any = iter) -> CoverageStudy:
    """Hold the error bars of random chains against their exact motion.

    Parameters
    ----------
    chains
        How many, in 1…100,000.
    seed
        Seed of the chains, >= 0; the first chains are the same however many there are.
    track
        Called with the range of the chains, gives them one by one: for a bar of progress.

    Raises
    ------
    ParameterError
        If an argument is outside its range.
    """
    checked_count("chains", chains, 1, MOST_RANDOM_CHAINS)
    checked_count("seed", seed, 0)
    margins = [compared_with_exact(*random_setting(seed, number)) for number in track(range(chains))]
    certified = [chain for chain in margins if chain is not None]
    return CoverageStudy(chains, chains - len(certified), tuple(_rows(certified)))


def random_setting(seed: int, number: int) -> tuple[Chain, HarmonicBase]:
    """Give one random chain and its drive: 1…10 cells, ratios over a decade each, the range of figure 3.

    Mass and stiffness ratios lie in 0.3…3, damping ratios in 0.003…0.03 and friction ratios in 0.01…5, uniform on a
    logarithmic scale; frequency ratios in 0.1…3, uniform.
    """
    rng = np.random.default_rng([seed, number])

    def between(low: float, high: float) -> float:
        return float(np.exp(rng.uniform(np.log(low), np.log(high))))

    chain = Chain.from_ratios(
        cells=int(rng.integers(1, 11)),
        mass_ratio=between(0.3, 3),
        stiffness_ratio=between(0.3, 3),
        damping_ratio=between(0.003, 0.03),
        friction_ratio=between(0.01, 5),
    )
    return chain, HarmonicBase.from_ratio(chain, float(rng.uniform(0.1, 3)))


def compared_with_exact(chain: Chain, drive: HarmonicBase) -> list[Coverage] | None:
    """Hold the bars of one chain, at each of its three steps, against the exact motion; ``None`` if uncertified."""
    fewest = steps_per_period_for(chain, drive)
    orbits = [euler_orbit(chain, drive, fewest * factor) for factor in REFINEMENTS]
    try:
        exact_state, exact = exact_orbit(chain, drive)
    except EventsAccumulate:
        return None
    if not all(orbit.converged for orbit in (*orbits, exact_state)):
        return None
    return [row for place in range(len(orbits)) for row in _compared(orbits, place, exact)]


def _compared(orbits: Sequence[PeriodicOrbit], place: int, exact: ExactPeriod) -> list[Coverage]:
    """Hold the bars of one of several orbits against the exact motion."""
    orbit, refinement = orbits[place], REFINEMENTS[place]
    bar = error_bar(orbits, place)
    level = _transmittance_margin(orbit, bar, exact)
    deep = decibel(exact.transmittance) < DEEP_DB
    two_steps = () if place == 0 or not bar.resolved else (_by_two_steps(orbits[place - 1 : place + 1], exact),)
    times, undecided = _transition_margins(orbit, bar, exact)
    margins = (
        (level,) if bar.resolved else (),
        two_steps,
        (level,) if deep else (),
        () if bar.resolved else (level,),
        _stuck_margins(orbit, bar, exact),
        times,
    )
    rows = [Coverage(name, refinement, values) for name, values in zip(QUANTITIES, margins, strict=True)]
    return [*rows[:-1], dataclasses.replace(rows[-1], undecided=undecided)]


def _by_two_steps(orbits: Sequence[PeriodicOrbit], exact: ExactPeriod) -> float:
    """Of the finer of two orbits, with a bar from these two alone."""
    return _transmittance_margin(orbits[1], error_bar(orbits, 1), exact)


def _transmittance_margin(orbit: PeriodicOrbit, bar: ErrorBar, exact: ExactPeriod) -> float:
    if not bar.resolved:
        return _ratio(10 ** (bar.floor_db / 20), exact.transmittance)
    return _ratio(bar.transmittance_db, abs(decibel(transmittance(orbit)) - decibel(exact.transmittance)))


def _stuck_margins(orbit: PeriodicOrbit, bar: ErrorBar, exact: ExactPeriod) -> tuple[float, ...]:
    """Of the contacts that stick for a part of the period in either motion: the others have no error to cover."""
    values, expected = stuck_fraction(orbit), exact.stuck_fraction
    partly = ((values > 0) & (values < 1)) | ((expected > 0) & (expected < 1))
    return tuple(map(_ratio, bar.stuck_fraction[partly], np.abs(values - expected)[partly]))


def _transition_margins(orbit: PeriodicOrbit, bar: ErrorBar, exact: ExactPeriod) -> tuple[tuple[float, ...], int]:
    """Of the transitions that are not flagged as undecided, and how many are."""
    period, expected = exact.period, [change.timed for change in exact.transitions]
    observed = [change.timed for change in transitions(orbit)]
    bars = dict(zip(observed, bar.transition_time, strict=True))
    match = match_transitions(observed, expected, period)
    margins = [
        _ratio(bars[pair[0]], abs(error) * period)
        for pair, error in zip(match.pairs, match.time_errors, strict=True)
        if not math.isnan(bars[pair[0]])
    ]
    spurious = [transition for transition in match.spurious if not math.isnan(bars[transition])]
    missed = match_transitions([change.timed for change in bar.missing_transitions], match.missed, period).missed
    undecided = int(np.sum(np.isnan(bar.transition_time))) + len(bar.missing_transitions)
    return (*margins, *(0.0 for _ in (*spurious, *missed))), undecided


def _ratio(bar: float, error: float) -> float:
    return math.inf if error == 0 else float(bar / error)


def _rows(chains: Sequence[Sequence[Coverage]]) -> Iterable[Coverage]:
    """Join what came of all chains, by quantity and number of steps."""
    for quantity in QUANTITIES:
        for refinement in REFINEMENTS:
            parts = [row for rows in chains for row in rows if (row.quantity, row.refinement) == (quantity, refinement)]
            margins = tuple(margin for part in parts for margin in part.margins)
            if margins or quantity in ("transmittance", "stuck fraction", "transition time"):
                yield Coverage(quantity, refinement, margins, sum(part.undecided for part in parts))
