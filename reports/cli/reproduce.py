"""``python -m reports reproduce``: a script that shows a number in the engine's own API."""

from typing import Annotated

import typer

from engines.completion import complete_variant
from scenarios.cli.options import NAME_METAVAR, Limit, Store
from scenarios.execution.limits import TIME_LIMIT


def reproduce(
    variant: Annotated[
        str,
        typer.Argument(
            metavar=NAME_METAVAR, help="The variant whose number is shown.", autocompletion=complete_variant
        ),
    ],
    scenario: Annotated[
        str, typer.Argument(help="The scenario: static-hold, breakaway, stopping-distance or figure3.")
    ],
    case: Annotated[
        str | None, typer.Argument(help="Case of the scenario; without it, a case of 1 kg, or (0.6, 0.9) of figure3.")
    ] = None,
    store: Store = None,
    time_limit: Limit = TIME_LIMIT,
) -> None:
    """Print a script of at most 60 lines that shows a number in the engine's own API, without this suite.

    The script needs only the engine and NumPy, and can be sent to the engine's tracker. Its header has the suite's
    number, which is computed unless the store has it.
    Exit code 0: the script is printed; 2: wrong input, or the engine has no script yet; 3: the result could not be
    written; 130: interrupted.

    Example: python -m reports reproduce mujoco:joint:default static-hold "1 kg, load 0.5" > repro.py
    """
    from reports.cli.reproduction import print_script

    print_script(variant, scenario, case, store, time_limit)
