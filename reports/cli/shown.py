"""``multibody-xval card``, ``reproduce`` and ``animate``: what is shown of engines, or of one variant."""

from __future__ import annotations

import sys
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from engines.completion import complete_engine, complete_variant
from reference_lcp.errors import ExitCode, ParameterError
from reference_lcp.output import replacing
from reference_lcp.terminal import visible
from reports.cli.options import NAME_METAVAR, Engines, Limit, Settings, Store, Work, Workers, check_outs, opened
from scenarios.runs import TIME_LIMIT

if TYPE_CHECKING:
    from scenarios.runs.parameters import ChainRatios
    from scenarios.runs.recorded import RecordedPeriod
    from scenarios.runs.task import SteadyStateTask

app = typer.Typer(name="multibody-xval", add_completion=False, pretty_exceptions_enable=False)


@app.command()
def card(
    engine: Annotated[
        str, typer.Argument(metavar="NAME", help="The engine, or NAME@VERSION.", autocompletion=complete_engine)
    ],
    out: Annotated[Path, typer.Option(help="Folder of the card; made if it is missing.")] = Path("report"),
    store: Store = None,
    workers: Workers = None,
    time_limit: Limit = TIME_LIMIT,
) -> None:
    """Write the card of an engine as HTML, Markdown and JSON: its errors to the truth, default and tuned.

    Results that the store lacks are computed: about a hundred steady states a preset. A report that is written into the
    same folder afterwards links the card.
    Exit code 0: the card is written; 2: wrong input, or the engine is not installed; 3: results or the card could not
    be written; 130: interrupted.

    Example: multibody-xval card mujoco --store results.sqlite
    """
    from reports.cards import card as cards
    from reports.cards.write import check_card_files, write_card

    variants = cards.card_variants(engine)
    check_card_files(engine, out, store)
    with Work(workers, time_limit).evaluator(store, variants) as evaluator:
        shown = cards.card(engine, evaluator)
    print(write_card(shown, out)[0])


@app.command()
def reproduce(
    variant: Annotated[
        str,
        typer.Argument(
            metavar=NAME_METAVAR, help="The variant whose number is shown.", autocompletion=complete_variant
        ),
    ],
    scenario: Annotated[
        str,
        typer.Argument(
            help="The scenario: static-hold, breakaway, stopping-distance or figure3, or of scenes slope-hold, "
            "stack-hold, heavy-on-light, slide-to-stop, grip, joint-hold or arm-hold."
        ),
    ],
    case: Annotated[
        str | None, typer.Argument(help="Case of the scenario; without it, the one that says most.")
    ] = None,
    store: Store = None,
    time_limit: Limit = TIME_LIMIT,
) -> None:
    """Print a script of at most 60 lines that shows a number in the engine's own API, without this suite.

    The script needs only the engine and NumPy, and can be sent to the engine's tracker. Its header has the suite's
    number, which is computed unless the store has it.
    Exit code 0: the script is printed; 2: wrong input, or the engine has no script or no such number; 3: the result
    could not be written; 130: interrupted.

    Example: multibody-xval reproduce mujoco:joint:default static-hold "1 kg, load 0.5" > repro.py
    """
    from engines.interface.variant import check_installed
    from reports.reproducers.scene_script import reproduction, reproduction_script

    shown = reproduction(variant, scenario, case)
    check_installed(shown.variant.engine, shown.variant.unavailable_reason)
    with Work(1, time_limit).evaluator(store, [shown.variant]) as evaluator:
        print(reproduction_script(shown, evaluator), end="")


@app.command()
def animate(
    chosen: Annotated[
        str,
        typer.Option(
            "--engine", metavar=NAME_METAVAR, help="The variant whose motion is drawn.", autocompletion=complete_variant
        ),
    ] = "reference",
    settings: Settings = None,
    chain: Annotated[
        list[str] | None,
        typer.Option(
            "--chain",
            metavar="NAME=VALUE[,VALUE]...",
            help="A parameter of the chain as in a sweep file, such as cells=3 or mass_ratio=0.5,1,2: one value for "
            "all cells, or one for each cell; may be repeated. Without it, the canonical chain.",
        ),
    ] = None,
    sweep: Annotated[
        Path | None, typer.Option(help="Sweep file; its chain, drive and steps a period are taken.")
    ] = None,
    friction_ratio: Annotated[float, typer.Option(help="Friction ratio μλ_N / (k_c U0), >= 0.")] = 0.3,
    frequency_ratio: Annotated[float, typer.Option(help="Frequency ratio ω / ω_r, > 0.")] = 0.9,
    out: Annotated[Path, typer.Option(help="File to write: .gif, or .html with controls.")] = Path("chain.gif"),
    frames: Annotated[int, typer.Option(help="Number of pictures of the period, 8 to 400.")] = 80,
    time_limit: Annotated[float, typer.Option(help="Time limit of the engine, in seconds.")] = TIME_LIMIT,
) -> None:
    """Animate one period of the steady state: outer masses as frames, inner masses coloured by stick and slip.

    Exit code 0: the file is written; 1: the engine has no steady state there, with the reason; 2: wrong input, or the
    engine is not installed; 3: the file could not be written at the end; 130: interrupted.

    Example: multibody-xval animate --engine mujoco:contact --chain cells=3 --chain mass_ratio=0.5,1,2
    """
    from reference_lcp.validation import checked_count

    task = planned_task(Engines([chosen], settings).names[0], friction_ratio, frequency_ratio, chain or [], sweep)
    checked_count("frames", frames, 8)
    if frames > 400:
        raise ParameterError(f"frames = {frames}; allowed: 8 to 400")
    check_outs([out], (".gif", ".html"))
    period = period_of(task, time_limit)
    if not period.known:
        print(visible(f"{task.variant.title}: {period.reason}"), file=sys.stderr)
        raise typer.Exit(ExitCode.FAILED)
    from reports.figures.animation import write_animation  # matplotlib is imported once a backend is chosen

    with replacing(out) as part:
        write_animation(task, period, frames, part)
    print(out)


def planned_task(
    chosen: str, friction_ratio: float, frequency_ratio: float, chain: Sequence[str], sweep: Path | None
) -> SteadyStateTask:
    """Give the task of the variant of this name."""
    from engines.interface.variant import Variant, check_installed
    from scenarios.runs.task import SteadyStateTask
    from scenarios.sweeps.spec_file import read_sweep

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
    from pydantic import TypeAdapter, ValidationError

    from scenarios.runs.parameters import ChainRatios, first_error

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


def period_of(task: SteadyStateTask, time_limit: float) -> RecordedPeriod:
    """Compute the period that is drawn, in a worker process that may take so many seconds."""
    from scenarios.runs.evaluator import Evaluator
    from scenarios.runs.recorded import RecordedPeriod
    from scenarios.runs.task import Recorded

    with opened(None) as store, Evaluator(store, Work(1, time_limit).executor()) as evaluator:
        return RecordedPeriod.of_result(evaluator.evaluate([task.recording(Recorded.PERIOD)])[0])
