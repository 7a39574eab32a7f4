"""``multibody-xval reference``: the steady state of one chain."""

from __future__ import annotations

import json
import math
import sys
import time
from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, Self

import typer

from multibody_xval.reports.cli.compiling import announce_compilation
from multibody_xval.reports.cli.exit_code import ExitCode
from multibody_xval.reports.cli.options import AsJson, grouped
from multibody_xval.reports.cli.reference_numbers import numbers_of, numbers_of_proof
from multibody_xval.scenarios.terminal_table import print_table
from reference_lcp import defaults
from reference_lcp.defaults import FEWEST_STEPS_PER_PERIOD, LARGEST_PHASE_STEP
from reference_lcp.watching import Watcher, watched

if TYPE_CHECKING:
    from reference_lcp.exact.proof.exact_chain import ExactChain
    from reference_lcp.one_call import SteadyState

LINE_SECONDS = 10.0
"""Between two lines about a search that takes long."""

app = typer.Typer(
    name="multibody-xval reference", add_completion=False, rich_markup_mode=None, pretty_exceptions_enable=False
)


def typed_number(value: str | float) -> TypedNumber:
    """Read a number of the command line."""
    try:
        return TypedNumber(value)
    except ValueError:
        raise typer.BadParameter("not a valid number") from None


class TypedNumber(float):
    """A number that remembers how it was typed."""

    text: str

    def __new__(cls, value: str | float) -> Self:
        """Keep the text; of a default, its shortest decimal."""
        number = super().__new__(cls, value)
        number.text = str(value).strip()
        return number


Ratio = partial(typer.Option, parser=typed_number, metavar="<float>")


@dataclass(frozen=True)
class Parameters:
    """Of the chain, but for its friction, and of its base."""

    mass_ratio: Annotated[float, Ratio(help="m_i / m_o.")] = defaults.MASS_RATIO
    stiffness_ratio: Annotated[float, Ratio(help="k_i / k_c.")] = defaults.STIFFNESS_RATIO
    damping_ratio: Annotated[float, Ratio(help="c_c / (2 √(k_c m_o)).")] = defaults.DAMPING_RATIO
    inner_damping_ratio: Annotated[float, Ratio(help="c_i / (2 √(k_i m_i)).")] = 0.0
    cells: Annotated[int, typer.Option(help="Number of cells.")] = defaults.CELLS
    base_amplitude: Annotated[float, typer.Option(help="U0 of the base [m].")] = defaults.BASE_AMPLITUDE


@dataclass(frozen=True)
class Search:
    """How the steady state is searched for."""

    steps_per_period: Annotated[
        int,
        typer.Option(help=f"At least {FEWEST_STEPS_PER_PERIOD}; more are taken if dt ω_max > {LARGEST_PHASE_STEP}."),
    ] = defaults.MINIMUM_STEPS_PER_PERIOD
    solver: Annotated[str, typer.Option(help="compiled, lemke, exact.")] = "compiled"
    tolerance: Annotated[
        float | None,
        typer.Option(help=f"Residual; else {defaults.DEFAULT_RESIDUAL:g}, or {defaults.EXACT_RESIDUAL:g} if exact."),
    ] = None
    max_periods: Annotated[int, typer.Option(help="Most periods of the search.")] = defaults.DEFAULT_PERIODS


@dataclass(frozen=True)
class ProofOptions:
    """Whether and how the steady state is proven."""

    proof: Annotated[
        bool,
        typer.Option("--proof", help="Also prove the exact steady state in ball arithmetic."),
    ] = False
    digits: Annotated[int, typer.Option(help="Proven decimals.")] = defaults.PROVEN_DIGITS
    time_limit: Annotated[float, typer.Option(help="Seconds after which a proof is given up.")] = (
        defaults.PROOF_TIME_LIMIT
    )

    def question(self, ratios: dict[str, float]) -> ExactChain | None:
        """Give the chain that is proven, of these ratios as they were typed; ``None`` without a proof."""
        from reference_lcp.exact.proof.exact_chain import ExactChain
        from reference_lcp.exact.proof.prove import check_request

        if not self.proof:
            return None
        check_request(self.digits, self.time_limit)
        exact: dict[str, Any] = {name: getattr(ratio, "text", ratio) for name, ratio in ratios.items()}
        return ExactChain.from_ratios(**exact)

    def answer(self, question: ExactChain | None) -> dict[str, Any]:
        """Prove, and give the numbers under the key ``proof``, or the reason why there are none."""
        from reference_lcp.errors import NotProven
        from reference_lcp.exact.proof.prove import prove

        if question is None:
            return {}
        began = time.monotonic()
        try:
            proven = prove(question, digits=self.digits, time_limit=self.time_limit)
            return {"proof": numbers_of_proof(proven)}
        except NotProven as problem:
            missing = dict.fromkeys(("transmittance_db", "phase", "transitions", "unique_by"))
            seconds = time.monotonic() - began
            return {"proof": {"status": "not proven", "reason": str(problem), **missing, "seconds": seconds}}


@app.command("reference")
@grouped
def run(
    *,
    friction_ratio: Annotated[float, Ratio(help="μλ_N / (k_c U0).")] = 0.3,
    frequency_ratio: Annotated[float, Ratio(help="ω / ω_r.")] = 0.9,
    parameters: Parameters,
    search: Search,
    proof: ProofOptions,
    error_bar: Annotated[
        bool, typer.Option("--error-bar", help="Also estimate the error of the step, with finer steps.")
    ] = False,
    exact_value: Annotated[bool, typer.Option("--exact-value", help="Also compute the exact transmittance.")] = False,
    as_json: AsJson = False,
    plot: Annotated[
        list[Path] | None,
        typer.Option(metavar="FILE", help="Draw one period as .pdf, .svg, .png, .eps, .jpg or .tif; may be repeated."),
    ] = None,
) -> None:
    """Find the steady state of a frictional mass-in-mass chain on a base that moves as U0 sin ωt.

    The scheme is Euler's, with a linear complementarity problem in every step. The solver "exact" has no time step.

    Exit code 0: converged; 1: no steady state within the periods, or not proven with --proof.

    Example: multibody-xval reference --friction-ratio 0.6 --frequency-ratio 1.3 --plot period.png
    """
    from multibody_xval.reports.figures.motion import plot_motion
    from multibody_xval.reports.figures.picture_file import checked_picture, save_picture
    from reference_lcp.chain.drives import HarmonicBase
    from reference_lcp.chain.mass_in_mass import Chain
    from reference_lcp.one_call import exact_steady_state, steady_state

    for file in plot or ():
        checked_picture("--plot", file)
    announce_compilation()
    chain = Chain.from_ratios(friction_ratio=friction_ratio, **vars(parameters))
    drive = HarmonicBase.from_ratio(chain, frequency_ratio, parameters.base_amplitude)
    ratios = {name: ratio for name, ratio in vars(parameters).items() if name != "base_amplitude"}
    question = proof.question({"friction_ratio": friction_ratio, "frequency_ratio": frequency_ratio, **ratios})
    with watched(search_lines()):
        most = {"max_periods": search.max_periods}
        exact = {"exact_db": exact_steady_state(chain, drive, **most).transmittance_db} if exact_value else {}
        state = steady_state(chain, drive, **vars(search), with_error_bar=error_bar)
    reason = _why_more_steps(state, search.steps_per_period)
    told = {"steps_per_period_requested": search.steps_per_period, "why_more_steps": reason}
    proven = proof.answer(question)
    _show(as_json, numbers_of(state) | exact | told | proven, lambda: _print(state, reason, exact, proven))
    for file in plot or ():
        save_picture(plot_motion(state.orbit), file)
    done = state.orbit.converged and all(answer["status"] == "proven" for answer in proven.values())
    raise typer.Exit(ExitCode.DONE if done else ExitCode.FAILED)


def search_lines() -> Watcher:
    """Give what prints to standard error every `LINE_SECONDS` how far a search is."""
    printed = time.monotonic()

    def watch(what: str, done: int, most: int) -> None:
        nonlocal printed
        if what and time.monotonic() >= printed + LINE_SECONDS:
            printed = time.monotonic()
            print(f"{what}: {done:,} of at most {most:,} periods; Ctrl-C ends it", file=sys.stderr, flush=True)

    return watch


def _show(as_json: bool, content: object, show: Callable[[], None]) -> None:
    """Print numbers as JSON, or for people."""
    print(json.dumps(content, indent=2)) if as_json else show()


def _why_more_steps(state: SteadyState, requested: int) -> str | None:
    """Reason for more steps per period than were requested; ``None`` if there are not more."""
    if state.orbit.trajectory.steps == requested:
        return None
    bound = f"dt ω_max <= {LARGEST_PHASE_STEP}"
    return f"{requested} requested; more keep {bound} at the chain's highest natural frequency ω_max"


def _print(state: SteadyState, why_more_steps: str | None, exact: dict[str, float], proven: dict[str, Any]) -> None:
    """Print a steady state for people; with the reason for more steps than requested, if there is one."""
    orbit, bar = state.orbit, state.error_bar
    print(f"transmittance         {state.transmittance_db:.4f} dB")
    if bar is not None and bar.resolved:
        print(f"error bar             ±{bar.transmittance_db:.2g} dB (measured order {bar.order:.2f})")
        print(f"extrapolated          {bar.extrapolated_db:.4f} dB")
    elif bar is not None:
        print(f"error bar             below what can be resolved: at most {bar.floor_db:.1f} dB")
    for level in exact.values():
        print(f"exact                 {level:.4f} dB (without a time step: the one to cite)")
    for answer in proven.values():
        _print_proof(answer)
    print(f"periodicity residual  {orbit.residual:.2e} ({orbit.status} after {orbit.periods} periods)")
    if orbit.reason:
        print(f"steady state          {orbit.reason}")
    print(f"steps per period      {orbit.trajectory.steps} (dt = {orbit.lane.time_step:.6g} s)")
    if why_more_steps is not None:
        print(f"                      {why_more_steps}")
    rows = []
    for place, fraction in enumerate(state.stuck_fraction.tolist()):
        error = "" if bar is None else f" ± {bar.stuck_fraction[place]:.2g}"
        rows.append((str(place + 1), f"{fraction:.4f}{error}", _transitions_of(state, place + 1)))
    print_table(("cell", "stuck fraction", "transitions: time (s) and new mode"), rows)


def _print_proof(answer: dict[str, Any]) -> None:
    """Print what is proven of a steady state, or why nothing is."""
    if answer["reason"] is not None:
        print(f"not proven            {answer['reason']}")
        return
    for name, unit in (("transmittance_db", "dB"), ("phase", "rad")):
        number = answer[name]
        print(f"proven                {number['value']} ± {float(number['radius']):.1g} {unit}")
    print(f"                      {len(answer['transitions'])} transitions a period; unique by {answer['unique_by']}")


def _transitions_of(state: SteadyState, cell: int) -> str:
    """Transitions of a cell with the error bars of their times; those that the step does not decide are said to be."""
    bar = state.error_bar
    lines = []
    for place, change in enumerate(state.transitions):
        error = None if bar is None else bar.transition_time[place]
        if change.cell != cell:
            continue
        if error is None:
            lines.append(f"{change.time:.5f} {change.kind}")
        elif math.isnan(error):
            lines.append(f"{change.time:.5f} {change.kind} (inconclusive: not with every step)")
        else:
            lines.append(f"{change.time:.5f} ± {error:.1g} {change.kind}")
    missing = [] if bar is None else [change for change in bar.missing_transitions if change.cell == cell]
    lines += [f"{change.time:.5f} {change.kind} (with other steps only)" for change in missing]
    return ", ".join(lines) or "none"
