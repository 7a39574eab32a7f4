"""``python -m reference_lcp``: the steady state of one chain, from the command line."""

if __name__ == "__main__":
    from reference_lcp.interrupt import heed_interrupts
    from reference_lcp.shadow import refuse_shadows

    heed_interrupts()
    refuse_shadows()

# isort: split
import sys
from pathlib import Path
from typing import Annotated

import typer

from reference_lcp.chain import canonical
from reference_lcp.chain.step_limits import FEWEST_STEPS_PER_PERIOD, LARGEST_PHASE_STEP, MINIMUM_STEPS_PER_PERIOD
from reference_lcp.console import run_command
from reference_lcp.exit_code import ExitCode
from reference_lcp.refusal import ParameterError
from reference_lcp.steady.limits import DEFAULT_PERIODS, DEFAULT_RESIDUAL, EXACT_RESIDUAL

app = typer.Typer(name="python -m reference_lcp", add_completion=False, pretty_exceptions_enable=False)

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
    mass_ratio: Annotated[float, typer.Option(help="Mass ratio m_i / m_o.")] = canonical.MASS_RATIO,
    stiffness_ratio: Annotated[float, typer.Option(help="Stiffness ratio k_i / k_c.")] = canonical.STIFFNESS_RATIO,
    damping_ratio: DampingRatio = canonical.DAMPING_RATIO,
    inner_damping_ratio: InnerDampingRatio = 0.0,
    cells: Annotated[int, typer.Option(help="Number of cells.")] = canonical.CELLS,
    base_amplitude: BaseAmplitude = canonical.BASE_AMPLITUDE,
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

    Example: python -m reference_lcp --friction-ratio 0.6 --frequency-ratio 1.3 --plot period.png
    """
    if context.invoked_subcommand is not None:
        return
    from reference_lcp.chain.harmonic import HarmonicBase
    from reference_lcp.chain.mass_in_mass import Chain
    from reference_lcp.cli.picture import check_picture
    from reference_lcp.cli.steady_state import show_steady_state
    from reference_lcp.compilation import announce_compilation
    from reference_lcp.one_call import steady_state

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
    check_picture(plot)
    state = steady_state(
        chain, drive, steps_per_period=steps_per_period, solver=solver, tolerance=tolerance, max_periods=max_periods,
        with_error_bar=error_bar, with_exact_value=exact_value,
    )  # fmt: skip
    show_steady_state(state, steps_per_period, plot, as_json=as_json)
    raise typer.Exit(ExitCode.DONE if state.orbit.converged else ExitCode.FAILED)


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

    Example: python -m reference_lcp bench --cells
    """
    if cells and points:
        raise ParameterError("--cells and --points; allowed: one of them")
    from reference_lcp.cli.studies import print_speed

    print_speed(cells=cells, points=points, as_json=as_json)


@app.command("convergence")
def print_convergence(
    as_json: Annotated[bool, typer.Option("--json", help="Print JSON.")] = False,
    plot: Annotated[Path | None, typer.Option(help="Draw the errors over the time step into this file.")] = None,
) -> None:
    """Halve the time step six times from 400 steps a period, and compare with the exact solver.

    The chain is the canonical one, at the stick-slip points (friction ratio, frequency ratio) of the test suite.
    Exit code 0: compared, whatever the orders; 2: wrong input; 3: --plot could not be written at the end; 130:
    interrupted.

    Example: python -m reference_lcp convergence --plot convergence.png
    """
    from reference_lcp.cli.picture import check_picture
    from reference_lcp.cli.studies import print_studies

    check_picture(plot)
    print_studies(plot, as_json=as_json)


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

    Example: python -m reference_lcp coverage --chains 40
    """
    from reference_lcp.cli.studies import print_covered

    print_covered(chains, seed, as_json=as_json)


if __name__ == "__main__":
    sys.exit(run_command(app))
