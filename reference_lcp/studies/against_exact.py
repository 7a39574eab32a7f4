"""The scheme and its error bars against the exact motion: how errors fall with the step, and which bars cover them."""

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from reference_lcp.chain.drives import HarmonicBase, PeriodicDrive
from reference_lcp.chain.mass_in_mass import Chain
from reference_lcp.chain.simulation import PeriodicOrbit, steps_per_period_for
from reference_lcp.exact.event_driven import EventsAccumulate
from reference_lcp.exact.exact_orbit import ExactPeriod, exact_orbit
from reference_lcp.observables.stick_slip import TimedTransition, match_transitions, stuck_fraction, transitions
from reference_lcp.observables.transmittance import complex_transmittance, decibel, transmittance
from reference_lcp.output import replacing
from reference_lcp.steady.error_bar import REFINEMENTS, ErrorBar, error_bar, euler_orbit
from reference_lcp.steady.richardson import SAFETY
from reference_lcp.validation import FloatArray, checked_count

HALVINGS = 6

STICK_SLIP_POINTS = ((0.1, 0.6), (0.3, 0.6), (0.3, 0.9), (0.6, 0.9), (0.6, 1.3), (1.0, 0.9))
"""Friction and frequency ratios at which contacts of the canonical chain stick and slip."""

MOST_RANDOM_CHAINS = 100_000
"""Most chains of a study: some seven hours."""

DEEP_DB = -100.0
"""Transmittance [dB] below which residuals matter: those of 1e-8 are −160 dB, and resonances amplify them."""

QUANTITIES = (
    "transmittance",
    "transmittance by two steps",
    "transmittance below −100 dB",
    "floor of transmittance",
    "phase",
    "stuck fraction",
    "transition time",
)
"""What has a bar; a floor stands where the transmittance is not resolved, the two steps are its own and its double."""


@dataclass(frozen=True)
class Convergence:
    """Errors of the scheme against the event-driven solver, by the number of steps a period."""

    steps_per_period: tuple[int, ...]
    """Shape (halvings + 1,), each twice the one before."""
    error_db: FloatArray
    """|Euler − exact| [dB]."""
    transition_error: FloatArray
    """Mean |time error| of the transitions that match, over the period; NaN without any."""
    unmatched: tuple[int, ...]
    """Transitions that only one of the two has."""

    @property
    def transmittance_order(self) -> float:
        """Order of the transmittance: slope of a straight line through all steps, both axes logarithmic."""
        return -float(np.polyfit(np.log(self.steps_per_period), np.log(self.error_db), 1)[0])

    @property
    def transition_order(self) -> float:
        """Order of the transition times, fitted alike."""
        return -float(np.polyfit(np.log(self.steps_per_period), np.log(self.transition_error), 1)[0])

    def as_dict(self) -> dict[str, Any]:
        """Give the numbers, ready for JSON; errors of transition times are ``None`` where nothing matches."""
        return {
            "steps_per_period": list(self.steps_per_period),
            "error_db": self.error_db.tolist(),
            "transition_error": [None if np.isnan(error) else float(error) for error in self.transition_error],
            "unmatched_transitions": list(self.unmatched),
            "transmittance_order": self.transmittance_order,
            "transition_order": self.transition_order,
        }


def convergence(chain: Chain, drive: PeriodicDrive, *, coarsest: int = 400, halvings: int = HALVINGS) -> Convergence:
    """Halve the time step `halvings` times, at least twice, and compare each steady state with the exact one."""
    steps = tuple(
        checked_count("coarsest", coarsest, 3) * 2**k for k in range(checked_count("halvings", halvings, 2) + 1)
    )
    exact = exact_orbit(chain, drive)[1]
    orbits = [euler_orbit(chain, drive, steps_per_period_for(chain, drive, count)) for count in steps]
    matches = [match_transitions(transitions(orbit), exact.transitions, drive.period) for orbit in orbits]
    errors_db = [decibel(transmittance(orbit)) - decibel(exact.transmittance) for orbit in orbits]
    return Convergence(
        steps,
        np.abs(errors_db),
        np.array([np.mean(np.abs(match.time_errors)) if match.pairs else np.nan for match in matches]),
        tuple(len(match.missed) + len(match.spurious) for match in matches),
    )


def plot_convergence(studies: dict[str, Convergence], file: Path) -> None:
    """Draw the errors of several studies, by name, over the step, with a line of first order."""
    from matplotlib.figure import Figure

    figure = Figure(figsize=(10, 4.2), layout="constrained")
    axes = figure.subplots(1, 2)
    for marker, (name, study) in zip("osD^vP*X", studies.items(), strict=False):
        step = 1 / np.array(study.steps_per_period)
        label = f"{name}: order {study.transmittance_order:.2f}"
        axes[0].loglog(step, study.error_db, marker=marker, label=label)
        axes[1].loglog(step, study.transition_error, marker=marker, label=f"{name}: order {study.transition_order:.2f}")
    for axis, title in zip(
        axes, ("error of the transmittance [dB]", "mean error of transition times / period [-]"), strict=True
    ):
        ends = np.array(axis.get_xlim())
        axis.loglog(ends, axis.get_ylim()[1] * ends / ends[1], "k--", linewidth=0.8, label="first order")
        axis.set_xlabel("time step / period [-]")
        axis.set_ylabel(title)
        axis.grid(alpha=0.3, which="both")
        axis.legend(fontsize=8, title="(friction ratio, η_r)", title_fontsize=8)
    with replacing(file) as part:
        figure.savefig(part, dpi=150)


@dataclass(frozen=True)
class Coverage:
    """How well the bars of one quantity at one number of steps cover the exact values."""

    quantity: str
    """One of `QUANTITIES`."""
    refinement: int
    """Number of steps over the fewest, one of `REFINEMENTS`."""
    margins: tuple[float, ...]
    """Bar over true error of each, shape (compared,): zero for a transition that is missed or spurious and not flagged.

    Of a floor, floor over exact amplitude.
    """
    inconclusive: int = 0
    """Transitions that the bar flags as inconclusive."""

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
        compared = {"compared": len(self.margins), "inconclusive": self.inconclusive}
        return {"quantity": self.quantity, "refinement": self.refinement, **compared, **known}


@dataclass(frozen=True)
class CoverageStudy:
    """Coverage of all quantities over random chains."""

    chains: int
    uncertified: int
    """Chains without a certified steady state by one of the two, which are left out."""
    rows: tuple[Coverage, ...]
    """By quantity and number of steps."""

    def as_dict(self) -> dict[str, Any]:
        """Give the numbers, ready for JSON."""
        return {"chains": self.chains, "uncertified": self.uncertified, "rows": [row.as_dict() for row in self.rows]}


def coverage(chains: int, seed: int, track: Any = iter) -> CoverageStudy:
    """Hold the error bars of so many random chains against their exact motion; `track` may show the progress."""
    checked_count("chains", chains, 1, MOST_RANDOM_CHAINS)
    checked_count("seed", seed, 0)
    margins = [compared_with_exact(*random_setting(seed, number)) for number in track(range(chains))]
    certified = [chain for chain in margins if chain is not None]
    return CoverageStudy(chains, chains - len(certified), tuple(_rows(certified)))


def random_setting(seed: int, number: int) -> tuple[Chain, HarmonicBase]:
    """Give one random chain and its drive: 1…10 cells, ratios over a decade each, the range of figure 3."""
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
    orbit, refinement = orbits[place], REFINEMENTS[place]
    bar = error_bar(orbits, place)
    level = (_transmittance_margin(orbit, bar, exact),)
    two_steps: tuple[float, ...] = ()
    if place > 0 and bar.resolved:
        two_steps = (_transmittance_margin(orbit, error_bar(orbits[place - 1 : place + 1], 1), exact),)
    times, inconclusive = _transition_margins(orbit, bar, exact)
    margins = (
        level if bar.resolved else (),
        two_steps,
        level if decibel(exact.transmittance) < DEEP_DB else (),
        () if bar.resolved else level,
        (_phase_margin(orbit, bar, exact),) if bar.resolved else (),
        _stuck_margins(orbit, bar, exact),
    )
    rows = [Coverage(name, refinement, values) for name, values in zip(QUANTITIES, margins, strict=False)]
    return [*rows, Coverage(QUANTITIES[-1], refinement, times, inconclusive)]


def _transmittance_margin(orbit: PeriodicOrbit, bar: ErrorBar, exact: ExactPeriod) -> float:
    if not bar.resolved:
        return _ratio(10 ** (bar.floor_db / 20), exact.transmittance)
    return _ratio(bar.transmittance_db, abs(decibel(transmittance(orbit)) - decibel(exact.transmittance)))


def _phase_margin(orbit: PeriodicOrbit, bar: ErrorBar, exact: ExactPeriod) -> float:
    return _ratio(bar.phase, abs(float(np.angle(complex_transmittance(orbit) / exact.complex_transmittance))))


def _stuck_margins(orbit: PeriodicOrbit, bar: ErrorBar, exact: ExactPeriod) -> tuple[float, ...]:
    """Of the contacts that stick for a part of the period in either motion: the others have no error to cover."""
    values, expected = stuck_fraction(orbit), exact.stuck_fraction
    partly = ((values > 0) & (values < 1)) | ((expected > 0) & (expected < 1))
    return tuple(map(_ratio, bar.stuck_fraction[partly], np.abs(values - expected)[partly]))


def _transition_margins(orbit: PeriodicOrbit, bar: ErrorBar, exact: ExactPeriod) -> tuple[tuple[float, ...], int]:
    """Of the transitions that are not flagged as inconclusive, and how many are."""
    period, observed = exact.period, transitions(orbit)
    bars: dict[TimedTransition, float] = dict(zip(observed, bar.transition_time, strict=True))
    match = match_transitions(observed, exact.transitions, period)
    margins = [
        _ratio(bars[pair[0]], abs(error) * period)
        for pair, error in zip(match.pairs, match.time_errors, strict=True)
        if not math.isnan(bars[pair[0]])
    ]
    spurious = [transition for transition in match.spurious if not math.isnan(bars[transition])]
    missed = match_transitions(bar.missing_transitions, match.missed, period).missed
    inconclusive = int(np.sum(np.isnan(bar.transition_time))) + len(bar.missing_transitions)
    return (*margins, *(0.0 for _ in (*spurious, *missed))), inconclusive


def _ratio(bar: float, error: float) -> float:
    return math.inf if error == 0 else float(bar / error)


def _rows(chains: Sequence[Sequence[Coverage]]) -> Iterable[Coverage]:
    for quantity in QUANTITIES:
        for refinement in REFINEMENTS:
            parts = [row for rows in chains for row in rows if (row.quantity, row.refinement) == (quantity, refinement)]
            margins = tuple(margin for part in parts for margin in part.margins)
            if margins or quantity in ("transmittance", "phase", "stuck fraction", "transition time"):
                yield Coverage(quantity, refinement, margins, sum(part.inconclusive for part in parts))
