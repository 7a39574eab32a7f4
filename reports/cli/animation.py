"""What ``python -m reports animate`` does: compute one period, and draw it."""

import sys
from pathlib import Path

import typer

from engines.interface.selection import check_installed
from engines.interface.variant import Variant
from reference_lcp.console import checked_output_file
from reference_lcp.exit_code import ExitCode
from reference_lcp.output import replacing
from reference_lcp.refusal import ParameterError
from reference_lcp.validation import checked_count
from reference_lcp.visible import visible
from scenarios.cli.evaluation import store_of_run
from scenarios.execution.evaluator import Evaluator
from scenarios.execution.local_processes import LocalExecutor
from scenarios.tasks.recorded import RecordedPeriod, RecordedPeriodTask
from scenarios.tasks.task import SteadyStateTask

ENDINGS = (".gif", ".html")


def animate_period(
    chosen: str, friction_ratio: float, frequency_ratio: float, out: Path, frames: int, time_limit: float
) -> None:
    """Animate a period of the variant of this name; everything is checked before it is computed."""
    variant = Variant.parse(chosen)
    task = SteadyStateTask(variant=variant, friction_ratio=friction_ratio, frequency_ratio=frequency_ratio)
    task.setting()
    checked_count("frames", frames, 8)
    if frames > 400:
        raise ParameterError(f"frames = {frames}; allowed: 8 to 400")
    if out.suffix not in ENDINGS:
        raise ParameterError(f"--out = {out} has the ending {out.suffix!r}; allowed: {' or '.join(ENDINGS)}")
    checked_output_file("--out", out)
    check_installed(variant.engine, variant.unavailable_reason)
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
