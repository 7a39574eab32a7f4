"""``python -m reference_lcp``: the steady state of one chain, from the command line."""

if __name__ == "__main__":
    from reference_lcp.interrupt import heed_interrupts

    heed_interrupts()

# isort: split
import json
import math
import sys
from functools import partial
from pathlib import Path
from typing import Annotated

import typer
from rich.console import Console
from rich.progress import track
from rich.table import Column, Table

from reference_lcp.accuracy.benchmark import bench, bench_cells
from reference_lcp.accuracy.convergence import STICK_SLIP_POINTS, Convergence, convergence, plot_convergence
from reference_lcp.accuracy.coverage import QUANTITIES, CoverageStudy, coverage
from reference_lcp.accuracy.error_bar import ErrorBar
from reference_lcp.accuracy.plot import checked_picture_format, plot_period
from reference_lcp.accuracy.richardson import SAFETY
from reference_lcp.chain import canonical
from reference_lcp.chain.harmonic import HarmonicBase
from reference_lcp.chain.mass_in_mass import Chain
from reference_lcp.chain.step_limits import FEWEST_STEPS_PER_PERIOD, LARGEST_PHASE_STEP, MINIMUM_STEPS_PER_PERIOD
from reference_lcp.console import checked_output_file, run_command
from reference_lcp.exit_code import ExitCode
from reference_lcp.observables.stick_slip import Transition
from reference_lcp.one_call import SOLVERS, SteadyState, steady_state
from reference_lcp.steady.limits import DEFAULT_PERIODS, DEFAULT_RESIDUAL, EXACT_RESIDUAL

app = typer.Typer(name="python -m reference_lcp", add_completion=False, pretty_exceptions_enable=False)

DampingRatio = Annotated[float, typer.Option(help="c_c / (2 √(k_c m_o)) between the cells.")]
StepsPerPeriod = Annotated[
    int,
    typer.Option(
        help=f"Fewest steps a period, >= {FEWEST_STEPS_PER_PERIOD}; more are taken where "
        f"dt ω_max <= {LARGEST_PHASE_STEP} requires them."
    ),
]
Tolerance = Annotated[
    float | None,
    typer.Option(help=f"Periodicity residual to reach; {DEFAULT_RESIDUAL:g}, or {EXACT_RESIDUAL:g} if exact."),
]


@app.callback(invoke_without_command=True)
def run(
    context: typer.Context,
    friction_ratio: Annotated[float, typer.Option(help="Friction bound over k_c U0.")] = 0.3,
    frequency_ratio: Annotated[float, typer.Option(help="Drive frequency over the resonator's, ω / ω_r.")] = 0.9,
    mass_ratio: Annotated[float, typer.Option(help="Inner over outer mass.")] = canonical.MASS_RATIO,
    stiffness_ratio: Annotated[float, typer.Option(help="Inner over chain stiffness.")] = canonical.STIFFNESS_RATIO,
    damping_ratio: DampingRatio = canonical.DAMPING_RATIO,
    inner_damping_ratio: Annotated[float, typer.Option(help="c_i / (2 √(k_i m_i)) inside the cells.")] = 0.0,
    cells: Annotated[int, typer.Option(help="Number of cells.")] = canonical.CELLS,
    base_amplitude: Annotated[float, typer.Option(help="U0 of the base, in metres.")] = canonical.BASE_AMPLITUDE,
    steps_per_period: StepsPerPeriod = MINIMUM_STEPS_PER_PERIOD,
    solver: Annotated[str, typer.Option(help=f"One of {', '.join(SOLVERS)}.")] = "compiled",
    tolerance: Tolerance = None,
    max_periods: Annotated[int, typer.Option(help="Periods after which the search gives up.")] = DEFAULT_PERIODS,
    error_bar: Annotated[bool, typer.Option("--error-bar", help="Measure the error too.")] = False,
    exact_value: Annotated[bool, typer.Option("--exact-value", help="Find the exact transmittance too.")] = False,
    as_json: Annotated[bool, typer.Option("--json", help="Print JSON.")] = False,
    plot: Annotated[Path | None, typer.Option(help="Draw one period into this file.")] = None,
) -> None:
    """Find the steady state of a frictional mass-in-mass chain on a base that moves as U0 sin ωt.

    The scheme is Euler's discretisation with a linear complementarity problem in every step; the
    solver "exact" goes from event to event instead, and has no error of a time step.
    Exit code 0: converged; 1: no steady state within the periods; 2: wrong input; 3: --plot could not be written at
    the end; 130: interrupted.

    Example: python -m reference_lcp --friction-ratio 0.6 --frequency-ratio 1.3 --plot period.png
    """
    if context.invoked_subcommand is not None:
        return
    chain = Chain.from_ratios(
        cells=cells,
        mass_ratio=mass_ratio,
        stiffness_ratio=stiffness_ratio,
        damping_ratio=damping_ratio,
        inner_damping_ratio=inner_damping_ratio,
        friction_ratio=friction_ratio,
        base_amplitude=base_amplitude,
    )
    drive = HarmonicBase.from_ratio(chain, frequency_ratio, base_amplitude)
    if plot is not None:
        checked_picture_format(checked_output_file("plot file", plot))
    state = steady_state(
        chain,
        drive,
        steps_per_period=steps_per_period,
        solver=solver,
        tolerance=tolerance,
        max_periods=max_periods,
        with_error_bar=error_bar,
        with_exact_value=exact_value,
    )
    reason = _why_more_steps(state, steps_per_period)
    if as_json:
        steps = {"steps_per_period_requested": steps_per_period, "why_more_steps": reason}
        print(json.dumps(state.as_dict() | steps, indent=2))
    else:
        _print(state, reason)
    if plot is not None:
        plot_period(state.orbit, plot)
    raise typer.Exit(ExitCode.DONE if state.orbit.converged else ExitCode.FAILED)


@app.command("bench")
def print_bench(
    cells: Annotated[bool, typer.Option("--cells", help="Cost of chains of 7 to 100,000 cells instead.")] = False,
    as_json: Annotated[bool, typer.Option("--json", help="Print JSON.")] = False,
) -> None:
    """Measure the speed of the reference on this machine.

    Exit code 0: measured; 2: wrong input; 130: interrupted.

    Example: python -m reference_lcp bench --cells
    """
    if cells:
        lengths = bench_cells()
        print(json.dumps(lengths, indent=2)) if as_json else _print_lengths(lengths)
        return
    numbers = bench()
    print(json.dumps(numbers, indent=2) if as_json else "\n".join(f"{name}: {n:.4g}" for name, n in numbers.items()))


@app.command("convergence")
def print_convergence(
    as_json: Annotated[bool, typer.Option("--json", help="Print JSON.")] = False,
    plot: Annotated[Path | None, typer.Option(help="Draw the errors over the time step into this file.")] = None,
) -> None:
    """Halve the time step six times from 400 steps a period, and compare with the exact solver.

    Canonical chain, at the stick-slip points (friction ratio, frequency ratio) of the test suite.
    Exit code 0: compared, whatever the orders; 2: wrong input; 3: --plot could not be written at the end; 130:
    interrupted.

    Example: python -m reference_lcp convergence --plot convergence.png
    """
    if plot is not None:
        checked_picture_format(checked_output_file("plot file", plot))
    studies = {
        f"({friction:g}, {frequency:g})": _study(friction, frequency) for friction, frequency in STICK_SLIP_POINTS
    }
    if as_json:
        print(json.dumps({name: study.as_dict() for name, study in studies.items()}, indent=2))
    else:
        _print_studies(studies)
    if plot is not None:
        plot_convergence(studies, plot)


@app.command("coverage")
def print_coverage(
    chains: Annotated[int, typer.Option(help="Number of random chains.")] = 500,
    seed: Annotated[int, typer.Option(help="Seed of the random chains.")] = 0,
    as_json: Annotated[bool, typer.Option("--json", help="Print JSON.")] = False,
) -> None:
    """Hold the error bars of random chains against the exact motion: how many cover it, and how wide they are.

    Chains of 1 to 10 cells, ratios over a decade each, friction and frequency over the range of figure 3; a fifth of a
    second each.
    Exit code 0: compared, whatever is covered; 2: wrong input; 130: interrupted.

    Example: python -m reference_lcp coverage --chains 40
    """
    study = coverage(chains, seed, partial(track, console=Console(stderr=True), transient=True))
    if as_json:
        print(json.dumps(study.as_dict(), indent=2))
        return
    _print_coverage(study)


def _print_coverage(study: CoverageStudy) -> None:
    """Print a line for each quantity, with the numbers of the three steps, the coarsest first, in every column."""
    name = Column("quantity", min_width=len("transmittance"))
    table = Table(name, "compared", "covered\n(%)", f"by bar\n/ {SAFETY:g} (%)", "bar / error", "undecided")
    for quantity in QUANTITIES:
        rows = [row for row in study.rows if row.quantity == quantity]
        columns = (
            [str(len(row.margins)) for row in rows],
            [f"{100 * row.covered():.1f}" for row in rows],
            [f"{100 * row.covered(SAFETY):.1f}" for row in rows],
            [f"{row.median_margin:.1f}" for row in rows],
            [str(row.undecided) for row in rows],
        )
        table.add_row(quantity, *("\n".join(column) for column in columns))
    Console().print(table)
    print(f"{study.chains} chains, {study.uncertified} of them without a certified steady state; for each quantity the")
    print("fewest steps, twice and four times as many (by two steps: the last two); bar / error is the median")


def _study(friction_ratio: float, frequency_ratio: float) -> Convergence:
    chain = Chain.from_ratios(friction_ratio=friction_ratio)
    return convergence(chain, HarmonicBase.from_ratio(chain, frequency_ratio))


def _print_studies(studies: dict[str, Convergence]) -> None:
    table = Table("friction, frequency", "order: transmittance", "transition times", "error at 400 steps (dB)")
    for name, study in studies.items():
        orders = f"{study.transmittance_order:.2f}", f"{study.transition_order:.2f}"
        table.add_row(name, *orders, f"{study.transmittance_error_db[0]:.4f}")
    Console().print(table)


def _print_lengths(lengths: list[dict[str, float]]) -> None:
    table = Table("cells", "ns per cell-step", "bytes", "bytes per cell")
    for row in lengths:
        nanoseconds, per_cell = 1e9 * row["seconds_per_cell_step"], row["bytes"] / row["cells"]
        table.add_row(f"{row['cells']:,}", f"{nanoseconds:.2f}", f"{row['bytes']:,}", f"{per_cell:.0f}")
    Console().print(table)


def _why_more_steps(state: SteadyState, requested: int) -> str | None:
    """Reason for more steps a period than were requested; ``None`` if there are not more."""
    if state.orbit.trajectory.steps == requested:
        return None
    bound = f"dt ω_max <= {LARGEST_PHASE_STEP}"
    return f"{requested} requested; more keep {bound} at the chain's highest natural frequency ω_max"


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
    table = Table("cell", "stuck fraction", "transitions: time (s) and new mode")
    for cell, fraction in enumerate(state.stuck_fraction.tolist(), start=1):
        table.add_row(str(cell), _stuck_fraction(state, cell, fraction), _transitions_of(state, cell))
    console.print(table)


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


if __name__ == "__main__":
    sys.exit(run_command(app))
