"""``python -m reference_lcp``: a steady state as people and programs read it."""

import json
import math
from pathlib import Path

from rich.console import Console

from reference_lcp.accuracy.error_bar import ErrorBar
from reference_lcp.accuracy.plot import plot_period
from reference_lcp.chain.step_limits import LARGEST_PHASE_STEP
from reference_lcp.observables.stick_slip import Transition
from reference_lcp.one_call import SteadyState
from reference_lcp.terminal_table import print_table


def show_steady_state(state: SteadyState, requested: int, plot: Path | None, *, as_json: bool) -> None:
    """Print a steady state, with the reason for more steps than were requested, and draw it into a file, if any."""
    reason = _why_more_steps(state, requested)
    if as_json:
        steps = {"steps_per_period_requested": requested, "why_more_steps": reason}
        print(json.dumps(state.as_dict() | steps, indent=2))
    else:
        _print(state, reason)
    if plot is not None:
        plot_period(state.orbit, plot)


def _print(state: SteadyState, why_more_steps: str | None) -> None:
    """Print a steady state for people; with the reason for more steps than requested, if there is one."""
    console = Console()
    orbit = state.orbit
    console.print(f"transmittance         {state.transmittance_db:.4f} dB")
    if state.error_bar is not None:
        _print_error_bar(console, state.error_bar)
    if state.exact_db is not None:
        console.print(f"exact                 {state.exact_db:.4f} dB")
    console.print(f"periodicity residual  {orbit.residual:.2e} ({orbit.status} after {orbit.periods} periods)")
    console.print(f"steps per period      {orbit.trajectory.steps} (dt = {orbit.lane.time_step:.6g} s)")
    if why_more_steps is not None:
        console.print(f"                      {why_more_steps}")
    rows = [
        (str(cell), _stuck_fraction(state, cell, fraction), _transitions_of(state, cell))
        for cell, fraction in enumerate(state.stuck_fraction.tolist(), start=1)
    ]
    print_table(("cell", "stuck fraction", "transitions: time (s) and new mode"), rows, console=console)


def _why_more_steps(state: SteadyState, requested: int) -> str | None:
    """Reason for more steps a period than were requested; ``None`` if there are not more."""
    if state.orbit.trajectory.steps == requested:
        return None
    bound = f"dt ω_max <= {LARGEST_PHASE_STEP}"
    return f"{requested} requested; more keep {bound} at the chain's highest natural frequency ω_max"


def _print_error_bar(console: Console, bar: ErrorBar) -> None:
    if not bar.resolved:
        console.print(f"error bar             below what can be resolved: at most {bar.floor_db:.1f} dB")
        return
    console.print(f"error bar             ±{bar.transmittance_db:.2g} dB (measured order {bar.order:.2f})")
    console.print(f"extrapolated          {bar.extrapolated_db:.4f} dB")


def _stuck_fraction(state: SteadyState, cell: int, fraction: float) -> str:
    if state.error_bar is None:
        return f"{fraction:.4f}"
    return f"{fraction:.4f} ± {state.error_bar.stuck_fraction[cell - 1]:.2g}"


def _transitions_of(state: SteadyState, cell: int) -> str:
    """Transitions of a cell with the error bars of their times; those that the step does not decide are said to be."""
    bar = state.error_bar
    errors = [None] * len(state.transitions) if bar is None else bar.transition_time.tolist()
    lines = [
        _timed(change, error) for change, error in zip(state.transitions, errors, strict=True) if change.cell == cell
    ]
    missing = [] if bar is None else [change for change in bar.missing_transitions if change.cell == cell]
    lines += [f"{change.time:.5f} {change.kind} (with other steps only)" for change in missing]
    return ", ".join(lines) or "none"


def _timed(change: Transition, error: float | None) -> str:
    if error is None:
        return f"{change.time:.5f} {change.kind}"
    if math.isnan(error):
        return f"{change.time:.5f} {change.kind} (undecided: not with every step)"
    return f"{change.time:.5f} ± {error:.1g} {change.kind}"
