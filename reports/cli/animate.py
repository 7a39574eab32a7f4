"""``python -m reports animate``: the chain in motion over one period, stick and slip in colours."""

import sys
from pathlib import Path
from typing import Annotated

import typer

from engines.interface.variant import Variant
from reference_lcp.console import checked_output_file
from reference_lcp.exit_code import ExitCode
from reference_lcp.output import replacing
from reference_lcp.validation import ParameterError, checked_count
from reference_lcp.visible import visible
from scenarios.cli.options import store_of_run
from scenarios.execution.evaluator import Evaluator, unavailable_reason
from scenarios.execution.executor import TIME_LIMIT
from scenarios.execution.local_processes import LocalExecutor
from scenarios.tasks.recorded import RecordedPeriod, RecordedPeriodTask
from scenarios.tasks.task import SteadyStateTask

ENDINGS = (".gif", ".html")


def animate(
    chosen: Annotated[
        str, typer.Option("--engine", metavar="NAME[:FORMULATION[:PRESET]]", help="The variant whose motion is drawn.")
    ] = "reference",
    friction_ratio: Annotated[float, typer.Option(help="Friction ratio μλ_N / (k_c U0), >= 0.")] = 0.3,
    frequency_ratio: Annotated[float, typer.Option(help="Frequency ratio ω / ω_r, > 0.")] = 0.9,
    out: Annotated[Path, typer.Option(help="File to write: .gif, or .html with controls.")] = Path("chain.gif"),
    frames: Annotated[int, typer.Option(help="Pictures of one period, 8 to 400.")] = 80,
    time_limit: Annotated[float, typer.Option(help="Seconds that the engine may take.")] = TIME_LIMIT,
) -> None:
    """Animate one period of the steady state: outer masses as frames, inner masses coloured by stick and slip.

    Exit code 0: the file is written; 1: the engine has no steady state there, with the reason; 2: wrong input, or the
    engine is not installed; 3: the file could not be written at the end; 130: interrupted.

    Example: python -m reports animate --engine mujoco:contact --friction-ratio 0.3 --out chain.gif
    """
    variant = Variant.parse(chosen)
    task = SteadyStateTask(variant=variant, friction_ratio=friction_ratio, frequency_ratio=frequency_ratio)
    task.setting()
    checked_count("frames", frames, 8)
    if frames > 400:
        raise ParameterError(f"frames = {frames}; allowed: 8 to 400")
    if out.suffix not in ENDINGS:
        raise ParameterError(f"--out = {out} has the ending {out.suffix!r}; allowed: {' or '.join(ENDINGS)}")
    checked_output_file("--out", out)
    missing = unavailable_reason(variant)
    if missing is not None:
        raise ParameterError(f"--engine = {chosen} is not installed: {missing}; allowed: one that is")
    period = period_of(task, time_limit)
    if not period.known:
        print(visible(f"{variant.title}: {period.reason}"), file=sys.stderr)
        raise typer.Exit(ExitCode.FAILED)
    from reports.figures.animation import write_animation  # matplotlib is imported once a backend is chosen

    with replacing(out) as part:
        write_animation(task, period, frames, part)
    print(out)


def period_of(task: SteadyStateTask, time_limit: float) -> RecordedPeriod:
    """Compute the period that is drawn, in a worker process that may take so many seconds."""
    with store_of_run(None) as store, Evaluator(store, LocalExecutor(1, time_limit)) as evaluator:
        return RecordedPeriod.of_result(evaluator.evaluate([RecordedPeriodTask.of(task)])[0])
