"""``python -m reports animate``: the chain in motion over one period, stick and slip in colours."""

from pathlib import Path
from typing import Annotated

import typer

from engines.completion import complete_variant
from scenarios.cli.options import NAME_METAVAR, Settings, with_settings
from scenarios.execution.limits import TIME_LIMIT


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

    Example: python -m reports animate --engine mujoco:contact --chain cells=3 --chain mass_ratio=0.5,1,2
    """
    from reports.cli.animation import animate_period, planned_task

    variant = with_settings([chosen], settings)[0]
    task = planned_task(variant, friction_ratio, frequency_ratio, chain or [], sweep)
    animate_period(task, out, frames, time_limit)
