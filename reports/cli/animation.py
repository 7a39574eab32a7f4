"""What ``python -m reports animate`` does: compute one period, and draw it."""

import sys
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import typer
from pydantic import TypeAdapter, ValidationError

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
from scenarios.execution.workers.local_processes import executor_here
from scenarios.sweeps.spec_file import read_sweep
from scenarios.tasks.parameters import ChainRatios
from scenarios.tasks.recorded import RecordedPeriod, RecordedPeriodTask
from scenarios.tasks.task import SteadyStateTask
from scenarios.tasks.validation_message import first_error

ENDINGS = (".gif", ".html")


def planned_task(
    chosen: str, friction_ratio: float, frequency_ratio: float, chain: Sequence[str], sweep: Path | None
) -> SteadyStateTask:
    """Give the task of the variant of this name.

    Parameters
    ----------
    chosen
        Name of the variant.
    friction_ratio, frequency_ratio
        The operating point.
    chain
        Parameters of the chain, ``NAME=VALUE[,VALUE]...``.
    sweep
        File of a sweep, whose chain, drive and steps a period are taken.

    Raises
    ------
    ParameterError
        If a value is not allowed, or the engine is not installed.
    """
    variant = Variant.parse(chosen)
    if chain and sweep is not None:
        raise ParameterError("--sweep has a chain; allowed beside it: no --chain")
    task = SteadyStateTask(
        variant=variant, friction_ratio=friction_ratio, frequency_ratio=frequency_ratio, ratios=_ratios(chain)
    )
    if sweep is not None:
        read = read_sweep(sweep)
        task = replace(task, ratios=read.ratios, excitation=read.excitation, steps_per_period=read.steps_per_period)
    task.setting()
    check_installed(variant.engine, variant.unavailable_reason)
    return task


def _ratios(settings: Sequence[str]) -> ChainRatios:
    """Read parameters of a chain."""
    content: dict[str, Any] = {}
    for setting in settings:
        name, _, text = setting.partition("=")
        if name in content:
            raise ParameterError(f"--chain {name} is given twice; allowed: once")
        values = [_number(part) for part in text.split(",")]
        content[name] = values[0] if len(values) == 1 else values
    try:
        ratios = TypeAdapter(ChainRatios).validate_python(content)
    except ValidationError as problem:
        raise ParameterError(f"--chain: {first_error(problem, ', '.join(vars(ChainRatios())))}") from None
    for name, value in vars(ratios).items():
        if isinstance(value, tuple) and len(value) != ratios.cells:
            given = f"--chain {name} has {len(value)} values and the chain {ratios.cells} cells"
            raise ParameterError(f"{given}; allowed: one value, or {ratios.cells}")
    return ratios


def _number(text: str) -> float | int | str:
    """Give a number as TOML has it; what is none is refused with the rest."""
    for kind in (int, float):
        try:
            return kind(text)
        except ValueError:
            continue
    return text


def animate_period(task: SteadyStateTask, out: Path, frames: int, time_limit: float) -> None:
    """Animate a period of a task; everything is checked before it is computed."""
    checked_count("frames", frames, 8)
    if frames > 400:
        raise ParameterError(f"frames = {frames}; allowed: 8 to 400")
    if out.suffix not in ENDINGS:
        raise ParameterError(f"--out = {out} has the ending {out.suffix!r}; allowed: {' or '.join(ENDINGS)}")
    checked_output_file("--out", out)
    period = period_of(task, time_limit)
    if not period.known:
        print(visible(f"{task.variant.title}: {period.reason}"), file=sys.stderr)
        raise typer.Exit(ExitCode.FAILED)
    from reports.figures.animation import write_animation  # matplotlib is imported once a backend is chosen

    with replacing(out) as part:
        write_animation(task, period, frames, part)
    print(out)


def period_of(task: SteadyStateTask, time_limit: float) -> RecordedPeriod:
    """Compute the period that is drawn, in a worker process that may take so many seconds."""
    with store_of_run(None) as store, Evaluator(store, executor_here(1, time_limit)) as evaluator:
        return RecordedPeriod.of_result(evaluator.evaluate([RecordedPeriodTask.of(task)])[0])
