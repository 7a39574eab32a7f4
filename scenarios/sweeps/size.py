"""How large a sweep is: said before it runs, and asked about above a limit."""

from typing import TYPE_CHECKING

from reference_lcp.refusal import ParameterError

if TYPE_CHECKING:
    from scenarios.sweeps.sweep import Sweep

UNCONFIRMED_POINTS = 1_000_000
"""Most points of a sweep that runs without a yes: about a quarter of an hour, and 2 GB in its store."""

FASTEST_SECONDS = 1e-3
"""Time that one point takes one worker at least [s]: the reference, the fastest engine, on the canonical chain."""


def check_size(sweep: "Sweep", *, yes: bool = False, how: str = "") -> None:
    """Raise a `ParameterError` if a sweep has more than `UNCONFIRMED_POINTS`, unless somebody has said yes.

    Parameters
    ----------
    sweep
        The sweep.
    yes
        Whether somebody has.
    how
        How that is said; where it cannot be, no larger sweep is allowed.
    """
    if sweep.points > UNCONFIRMED_POINTS and not yes:
        more = f", or more with {how}" if how else ""
        raise ParameterError(f"{size_text(sweep)}; allowed: <= {UNCONFIRMED_POINTS:,} points{more}")


def size_text(sweep: "Sweep") -> str:
    """Say how many points a sweep has, and for how long they keep a worker busy at least."""
    least = "" if sweep.frequencies is None else "at least "
    seconds = sweep.points * FASTEST_SECONDS
    duration = f"{seconds:.2g} s" if seconds < 60 else f"{seconds / 3600:,.3g} h"
    return f"the sweep has {least}{sweep.points:,} points, {duration} of one worker's time or more"
