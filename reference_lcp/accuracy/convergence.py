"""How the Euler scheme converges to the exact motion when the time step is halved again and again."""

from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from reference_lcp.accuracy.error_bar import euler_orbit
from reference_lcp.chain.harmonic import PeriodicDrive
from reference_lcp.chain.mass_in_mass import Chain
from reference_lcp.chain.simulation import steps_per_period_for
from reference_lcp.exact.steady import exact_orbit
from reference_lcp.observables.stick_slip import transitions
from reference_lcp.observables.transition_matching import match_transitions
from reference_lcp.observables.transmittance import decibel, transmittance
from reference_lcp.output import replacing
from reference_lcp.validation import FloatArray, checked_count

HALVINGS = 6

STICK_SLIP_POINTS = ((0.1, 0.6), (0.3, 0.6), (0.3, 0.9), (0.6, 0.9), (0.6, 1.3), (1.0, 0.9))
"""Friction and frequency ratios at which contacts of the canonical chain stick and slip."""


@dataclass(frozen=True)
class Convergence:
    """Errors of the scheme against the event-driven solver, by the number of steps a period.

    Parameters
    ----------
    steps_per_period
        Shape (halvings + 1,), each twice the one before.
    transmittance_error_db
        |Euler − exact| [dB].
    transition_error
        Mean |time error| of the transitions that match, over the period; NaN without any.
    unmatched
        Transitions that only one of the two has.
    """

    steps_per_period: tuple[int, ...]
    transmittance_error_db: FloatArray
    transition_error: FloatArray
    unmatched: tuple[int, ...]

    @property
    def transmittance_order(self) -> float:
        """Order of the transmittance: slope of a straight line through all steps, both axes logarithmic."""
        return self._order(self.transmittance_error_db)

    @property
    def transition_order(self) -> float:
        """Order of the transition times, fitted alike."""
        return self._order(self.transition_error)

    def as_dict(self) -> dict[str, Any]:
        """Give the numbers, ready for JSON; errors of transition times are ``None`` where nothing matches."""
        return {
            "steps_per_period": list(self.steps_per_period),
            "transmittance_error_db": self.transmittance_error_db.tolist(),
            "transition_error": [None if np.isnan(error) else float(error) for error in self.transition_error],
            "unmatched_transitions": list(self.unmatched),
            "transmittance_order": self.transmittance_order,
            "transition_order": self.transition_order,
        }

    def _order(self, errors: FloatArray) -> float:
        slope = np.polyfit(np.log(self.steps_per_period), np.log(errors), 1)[0]
        return float(-slope)


def convergence(chain: Chain, drive: PeriodicDrive, *, coarsest: int = 400, halvings: int = HALVINGS) -> Convergence:
    """Halve the time step `halvings` times and compare each steady state with the exact one.

    Parameters
    ----------
    chain, drive
        What moves, and what moves it.
    coarsest
        Steps a period to begin with.
    halvings
        How often the step is halved, at least 2.

    Raises
    ------
    ParameterError
        If an argument is outside its range.
    """
    steps = tuple(
        checked_count("coarsest", coarsest, 3) * 2**k for k in range(checked_count("halvings", halvings, 2) + 1)
    )
    exact = exact_orbit(chain, drive)[1]
    orbits = [euler_orbit(chain, drive, steps_per_period_for(chain, drive, count)) for count in steps]
    expected = [change.timed for change in exact.transitions]
    matches = [
        match_transitions([change.timed for change in transitions(orbit)], expected, drive.period) for orbit in orbits
    ]
    errors_db = [decibel(transmittance(orbit)) - decibel(exact.transmittance) for orbit in orbits]
    return Convergence(
        steps,
        np.abs(errors_db),
        np.array([np.mean(np.abs(match.time_errors)) if match.pairs else np.nan for match in matches]),
        tuple(len(match.missed) + len(match.spurious) for match in matches),
    )


def plot_convergence(studies: dict[str, Convergence], file: Path) -> None:
    """Draw the errors of several studies over the step, with a line of first order.

    Parameters
    ----------
    studies
        By the name that the legend shows.
    file
        Picture to write; its ending gives the format.
    """
    from matplotlib.figure import Figure

    figure = Figure(figsize=(10, 4.2), layout="constrained")
    axes = figure.subplots(1, 2)
    for marker, (name, study) in zip("osD^vP*X", studies.items(), strict=False):
        step = 1 / np.array(study.steps_per_period)
        label = f"{name}: order {study.transmittance_order:.2f}"
        axes[0].loglog(step, study.transmittance_error_db, marker=marker, label=label)
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
