"""``multibody-xval reproduce``: a number of one configuration as a script in the engine's own API."""

from __future__ import annotations

from typing import Annotated

import typer

from multibody_xval.engines.completion import complete_variant
from multibody_xval.reports.cli.options import NAME_METAVAR, Store, keeping
from multibody_xval.scenarios.compute import SECONDS_A_RUN

app = typer.Typer(
    name="multibody-xval reproduce", add_completion=False, rich_markup_mode=None, pretty_exceptions_enable=False
)


@app.command()
def reproduce(
    configuration: Annotated[
        str,
        typer.Argument(
            metavar=NAME_METAVAR,
            help="The configuration whose number is shown; without FORMULATION and PRESET, the engine's joint with the "
            "preset tuned, and in scenes its recipe.",
            autocompletion=complete_variant,
        ),
    ],
    scenario: Annotated[
        str,
        typer.Argument(
            help="The scenario: static-hold, ratchet, breakaway, stopping-distance, published, figure3 or "
            "unit-cell, or any scene: slope-hold, slope-slide, conveyor, spin, joint-hold, arm-hold and so on."
        ),
    ],
    case: Annotated[
        str | None, typer.Argument(help="Case of the scenario; without it, the one that says most.")
    ] = None,
    store: Store = None,
    time_limit: Annotated[float, typer.Option(help="Seconds after which a run is stopped.")] = SECONDS_A_RUN,
) -> None:
    """Print a short script that shows a number in the engine's own API, without this suite.

    The script needs only the engine and NumPy, and can be sent to the engine's tracker. Its header has the suite's
    number, which is computed unless the results file has it.
    Exit code 0: the script is printed.

    Example: multibody-xval reproduce mujoco:joint:default static-hold "1 kg, load 0.5" > repro.py
    """
    from multibody_xval.engines.interface.variant import check_installed
    from multibody_xval.reports.reproducers.script import checked, script
    from multibody_xval.scenarios.running.evaluate import Means

    shown = checked(configuration, scenario, case)
    check_installed(shown.run.config.engine, shown.run.config.unavailable_reason)
    with keeping(store):
        number = shown.number(Means(store=store, workers=1, seconds_a_run=time_limit))
    print(script(shown, number), end="")
