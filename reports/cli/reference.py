"""``multibody-xval reference``: the steady state of one chain, and studies of the reference itself."""

from __future__ import annotations

import json
import math
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer
from rich.console import Console

from reference_lcp import defaults
from reference_lcp.defaults import (
    DEFAULT_PERIODS,
    DEFAULT_RESIDUAL,
    EXACT_RESIDUAL,
    FEWEST_STEPS_PER_PERIOD,
    LARGEST_PHASE_STEP,
    MINIMUM_STEPS_PER_PERIOD,
)
from reference_lcp.errors import ExitCode, ParameterError
from reference_lcp.terminal import print_table

if TYPE_CHECKING:
    from reference_lcp.observables.stick_slip import Transition
    from reference_lcp.one_call import SteadyState
    from reference_lcp.steady.error_bar import ErrorBar
    from reference_lcp.studies.against_exact import Convergence, CoverageStudy

app = typer.Typer(name="multibody-xval reference", add_completion=False, pretty_exceptions_enable=False)

DampingRatio = Annotated[float, typer.Option(help="Damping ratio of the chain, c_c / (2 √(k_c m_o)).")]
InnerDampingRatio = Annotated[float, typer.Option(help="Damping ratio inside the cells, c_i / (2 √(k_i m_i)).")]
BaseAmplitude = Annotated[float, typer.Option(help="Amplitude U0 of the base, in metres.")]
WithErrorBar = Annotated[
    bool, typer.Option("--error-bar", help="Also estimate the error of the step, with finer steps.")
]
StepsPerPeriod = Annotated[
    int,
    typer.Option(
        help=f"Fewest steps a period, >= {FEWEST_STEPS_PER_PERIOD}; more are taken if "
        f"dt ω_max <= {LARGEST_PHASE_STEP} requires it."
    ),
]
Tolerance = Annotated[
    float | None,
    typer.Option(
        help=f"Residual to reach; without it, {DEFAULT_RESIDUAL:g}, or {EXACT_RESIDUAL:g} with --solver exact."
    ),
]


@app.callback(invoke_without_command=True)
def run(
    context: typer.Context,
    friction_ratio: Annotated[float, typer.Option(help="Friction ratio μλ_N / (k_c U0).")] = 0.3,
    frequency_ratio: Annotated[float, typer.Option(help="Frequency ratio ω / ω_r.")] = 0.9,
    mass_ratio: Annotated[float, typer.Option(help="Mass ratio m_i / m_o.")] = defaults.MASS_RATIO,
    stiffness_ratio: Annotated[float, typer.Option(help="Stiffness ratio k_i / k_c.")] = defaults.STIFFNESS_RATIO,
    damping_ratio: DampingRatio = defaults.DAMPING_RATIO,
    inner_damping_ratio: InnerDampingRatio = 0.0,
    cells: Annotated[int, typer.Option(help="Number of cells.")] = defaults.CELLS,
    base_amplitude: BaseAmplitude = defaults.BASE_AMPLITUDE,
    steps_per_period: StepsPerPeriod = MINIMUM_STEPS_PER_PERIOD,
    solver: Annotated[str, typer.Option(help="Solver: compiled, lemke or exact.")] = "compiled",
    tolerance: Tolerance = None,
    max_periods: Annotated[int, typer.Option(help="Largest number of periods of the search.")] = DEFAULT_PERIODS,
    error_bar: WithErrorBar = False,
    exact_value: Annotated[bool, typer.Option("--exact-value", help="Also compute the exact transmittance.")] = False,
    as_json: Annotated[bool, typer.Option("--json", help="Print JSON.")] = False,
    plot: Annotated[Path | None, typer.Option(help="Draw one period into this file.")] = None,
) -> None:
    """Find the steady state of a frictional mass-in-mass chain on a base that moves as U0 sin ωt.

    The scheme is Euler's discretisation, with a linear complementarity problem in every step. The solver "exact" is
    event-driven instead: it has no time step.
    Exit code 0: converged; 1: no steady state within the periods; 2: wrong input; 3: --plot could not be written at
    the end; 130: interrupted.

    Example: multibody-xval reference --friction-ratio 0.6 --frequency-ratio 1.3 --plot period.png
    """
    if context.invoked_subcommand is not None:
        return
    from reference_lcp.chain.drives import HarmonicBase
    from reference_lcp.chain.mass_in_mass import Chain
    from reference_lcp.one_call import steady_state
    from reference_lcp.terminal import announce_compilation

    announce_compilation()
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
    _check_picture(plot)
    state = steady_state(
        chain, drive, steps_per_period=steps_per_period, solver=solver, tolerance=tolerance, max_periods=max_periods,
        with_error_bar=error_bar, with_exact_value=exact_value,
    )  # fmt: skip
    _show(state, steps_per_period, plot, as_json=as_json)
    raise typer.Exit(ExitCode.DONE if state.orbit.converged else ExitCode.FAILED)


def _check_picture(plot: Path | None) -> None:
    """Refuse a file that cannot be written, or whose ending names no format."""
    from reference_lcp.output import checked_output_file
    from reference_lcp.studies.plot import checked_picture_format

    if plot is not None:
        checked_picture_format(checked_output_file("plot file", plot))


def _show(state: SteadyState, requested: int, plot: Path | None, *, as_json: bool) -> None:
    """Print a steady state, with the reason for more steps than were requested, and draw it into a file, if any."""
    reason = _why_more_steps(state, requested)
    if as_json:
        steps = {"steps_per_period_requested": requested, "why_more_steps": reason}
        print(json.dumps(state.as_dict() | steps, indent=2))
    else:
        _print(state, reason)
    if plot is not None:
        from reference_lcp.studies.plot import plot_period

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


@app.command("bench")
def print_bench(
    cells: Annotated[bool, typer.Option("--cells", help="Measure chains of 7 to 100,000 cells.")] = False,
    points: Annotated[
        bool, typer.Option("--points", help="Measure cost and error of a point by four methods.")
    ] = False,
    as_json: Annotated[bool, typer.Option("--json", help="Print JSON.")] = False,
) -> None:
    """Measure the speed of the reference on this machine.

    Exit code 0: measured; 2: wrong input; 130: interrupted.

    Example: multibody-xval reference bench --cells
    """
    if cells and points:
        raise ParameterError("--cells and --points; allowed: one of them")
    from reference_lcp.studies.bench import bench, bench_cells, bench_points
    from reference_lcp.terminal import announce_compilation

    announce_compilation()
    if points:
        methods = bench_points()
        print(json.dumps(methods, indent=2)) if as_json else _print_methods(methods)
    elif cells:
        lengths = bench_cells()
        print(json.dumps(lengths, indent=2)) if as_json else _print_lengths(lengths)
    else:
        numbers = bench()
        lines = [f"{name}: {number:.4g}" for name, number in numbers.items()]
        print(json.dumps(numbers, indent=2) if as_json else "\n".join(lines))


@app.command("convergence")
def print_convergence(
    as_json: Annotated[bool, typer.Option("--json", help="Print JSON.")] = False,
    plot: Annotated[Path | None, typer.Option(help="Draw the errors over the time step into this file.")] = None,
) -> None:
    """Halve the time step six times from 400 steps a period, and compare with the exact solver.

    The chain is the canonical one, at the stick-slip points (friction ratio, frequency ratio) of the test suite.
    Exit code 0: compared, whatever the orders; 2: wrong input; 3: --plot could not be written at the end; 130:
    interrupted.

    Example: multibody-xval reference convergence --plot convergence.png
    """
    from reference_lcp.chain.drives import HarmonicBase
    from reference_lcp.chain.mass_in_mass import Chain
    from reference_lcp.studies.against_exact import STICK_SLIP_POINTS, convergence, plot_convergence
    from reference_lcp.terminal import announce_compilation

    _check_picture(plot)
    announce_compilation()
    studies = {}
    for friction, frequency in STICK_SLIP_POINTS:
        chain = Chain.from_ratios(friction_ratio=friction)
        study = convergence(chain, HarmonicBase.from_ratio(chain, frequency))
        studies[f"({friction:g}, {frequency:g})"] = study
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
    """Compare the error bars of random chains with the exact motion: how many cover it, and how wide they are.

    The chains have 1 to 10 cells, ratios over a decade each, and friction and frequency over the range of figure 3.
    Each takes a fifth of a second.
    Exit code 0: compared, whatever the coverage; 2: wrong input; 130: interrupted.

    Example: multibody-xval reference coverage --chains 40
    """
    from reference_lcp.studies.against_exact import coverage
    from reference_lcp.terminal import announce_compilation, tracked

    announce_compilation()
    study = coverage(chains, seed, partial(tracked, unit="chains"))
    if as_json:
        print(json.dumps(study.as_dict(), indent=2))
    else:
        _print_coverage(study)


def _print_studies(studies: dict[str, Convergence]) -> None:
    rows = [
        (
            name,
            f"{each.transmittance_order:.2f}",
            f"{each.transition_order:.2f}",
            f"{each.transmittance_error_db[0]:.4f}",
        )
        for name, each in studies.items()
    ]
    print_table(("friction, frequency", "order: transmittance", "transition times", "error at 400 steps (dB)"), rows)


def _print_lengths(lengths: list[dict[str, float]]) -> None:
    rows = [
        (
            f"{row['cells']:,}",
            f"{1e9 * row['seconds_per_cell_step']:.2f}",
            f"{row['bytes']:,}",
            f"{row['bytes'] / row['cells']:.0f}",
        )
        for row in lengths
    ]
    print_table(("cells", "ns per cell-step", "bytes", "bytes per cell"), rows)


def _print_methods(methods: list[dict[str, Any]]) -> None:
    rows = []
    for row in methods:
        bar = row["median_bar_db"], row["covered"]
        columns = [
            row["method"],
            f"{1e3 * row['seconds_per_point']:.3g}",
            str(row["failed"]),
            *(f"{row[name]:.2g}" for name in ("median_error_db", "largest_error_db")),
            *(("", "") if None in bar else (f"{bar[0]:.2g}", f"{100 * bar[1]:.0f}")),
        ]
        rows.append(columns)
    errors = "median error (dB)", "largest (dB)"
    print_table(("method", "ms a point", "failed", *errors, "median bar (dB)", "covered (%)"), rows)


def _print_coverage(study: CoverageStudy) -> None:
    """Print a line for each quantity, with the numbers of the three steps, the coarsest first, in every column."""
    from reference_lcp.steady.richardson import SAFETY
    from reference_lcp.studies.against_exact import QUANTITIES

    lines = []
    for quantity in QUANTITIES:
        rows = [row for row in study.rows if row.quantity == quantity]
        columns = (
            [str(len(row.margins)) for row in rows],
            [f"{100 * row.covered():.1f}" for row in rows],
            [f"{100 * row.covered(SAFETY):.1f}" for row in rows],
            [f"{row.median_margin:.1f}" for row in rows],
            [str(row.undecided) for row in rows],
        )
        lines.append((quantity, *("\n".join(column) for column in columns)))
    headings = ("quantity", "compared", "covered (%)", f"by bar / {SAFETY:g} (%)", "bar / error", "undecided")
    print_table(headings, lines)
    print(f"{study.chains} chains, {study.uncertified} of them without a certified steady state; for each quantity the")
    print("fewest steps, twice and four times as many (by two steps: the last two); bar / error is the median")
