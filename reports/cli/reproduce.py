"""``multibody-xval reproduce``: a number of one variant as a script in the engine's own API."""

from __future__ import annotations

from typing import Annotated

import typer

from multibody_xval.engines.completion import complete_variant
from multibody_xval.reports.cli.options import NAME_METAVAR, Limit, Store, Work, keeping
from multibody_xval.scenarios.runs import TIME_LIMIT
from reference_lcp.errors import checked_choice

app = typer.Typer(name="multibody-xval reproduce", add_completion=False, pretty_exceptions_enable=False)


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
            "stack-hold, heavy-on-light, slide-to-stop, grip, held-while-shaken, joint-hold or arm-hold."
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
    from multibody_xval.engines.interface.variant import check_installed
    from multibody_xval.reports.reproducers.questions import QUESTIONS
    from multibody_xval.reports.reproducers.scene_script import SCENES, checked_scene, scene_script
    from multibody_xval.reports.reproducers.script import checked, script
    from multibody_xval.scenarios.evaluate import Means, computed

    if checked_choice("scenario", scenario, [*QUESTIONS, *SCENES]) in SCENES:
        scene = checked_scene(variant, scenario, case)
        check_installed(scene.run.config.engine, scene.run.config.unavailable_reason)
        with keeping(store):
            (stored,) = computed([scene.run], Means(store=store, workers=1, seconds_a_run=time_limit), "scenes")
        print(scene_script(scene, stored.result), end="")
        return
    shown = checked(variant, scenario, case)
    check_installed(shown.variant.engine, shown.variant.unavailable_reason)
    with Work(1, time_limit).evaluator(store, [shown.variant]) as evaluator:
        print(script(shown, evaluator), end="")
