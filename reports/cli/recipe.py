"""``multibody-xval recipe`` and ``run recipes``: what to write in one's own model so that friction holds."""

from __future__ import annotations

import json
import math
from typing import TYPE_CHECKING, Annotated, Any

import typer

from multibody_xval.engines.completion import complete_engine
from multibody_xval.reports.cli.options import (
    TABLE_ENDINGS,
    AsJson,
    Computing,
    Store,
    TableFiles,
    check_outs,
    grouped,
    keeping,
)
from multibody_xval.reports.cli.shown import cost_line
from multibody_xval.scenarios.output_files import write_whole
from multibody_xval.scenarios.terminal_table import print_table

if TYPE_CHECKING:
    import pandas as pd

app = typer.Typer(name="multibody-xval", add_completion=False, rich_markup_mode=None, pretty_exceptions_enable=False)


@app.command()
@grouped
def recipe(
    engine: Annotated[str, typer.Argument(metavar="NAME", help="The engine.", autocompletion=complete_engine)],
    *,
    measure: Annotated[
        bool,
        typer.Option("--run/--no-run", help="Measure all scenes, for a minute or more; --no-run: the recipe alone."),
    ] = True,
    as_json: AsJson = False,
    store: Store = None,
    computing: Computing,
) -> None:
    """Print what to write in your model so that friction holds, in the engine's own syntax, then measure what it gives.

    Indented lines can be pasted as they are. The table is measured here and now: the worst number of each scene at the
    engine's own time step, with default options and with the recipe. "Not cured": with the recipe, too, it is more
    than twice what is allowed.
    Exit code 0: printed.

    Example: multibody-xval recipe mujoco
    """
    from multibody_xval.engines.interface.registry import engine as engine_of
    from multibody_xval.engines.interface.variant import check_installed
    from multibody_xval.reports.reproducers.recipe import for_terminal, to_write
    from multibody_xval.scenarios.catalogue.recipes import recipe_results

    text = to_write(engine)
    if measure:
        check_installed(engine, engine_of(engine).unavailable_reason())
    if not as_json:
        print("\n".join(for_terminal(text)), flush=True)
    scenes: dict[str, dict[str, Any]] = {}
    costs: dict[str, float] = {}
    if measure:
        with keeping(store):
            worst, costs = recipe_results(engine, computing.means(store))
        scenes = {str(name): {str(key): value for key, value in own.items()} for name, own in worst.iterrows()}
    if as_json:
        known = {name: {key: _known(value) for key, value in own.items()} for name, own in scenes.items()}
        print(json.dumps({"engine": engine, "recipe": text, "scenes": known, "cost": costs}, indent=2))
    elif measure:
        _print_table(scenes, costs)


def _known(value: float) -> float | str | None:
    """Give a number as JSON has it: ``never`` and ``failed`` as texts, ``null`` where there is none."""
    from multibody_xval.scenarios.catalogue.worst_numbers import printed_number

    return value if math.isfinite(value) else None if math.isnan(value) else printed_number(value)


def _print_table(scenes: dict[str, dict[str, Any]], costs: dict[str, float]) -> None:
    """Print a row a number, and what a step costs with the recipe where that is another cost."""
    from multibody_xval.scenarios.catalogue.worst_numbers import NOT_CURED, printed_number, with_recipe

    rows = [
        (name, printed_number(own["default"]), with_recipe(own["recommended"], cured=own["cured"]))
        for name, own in scenes.items()
    ]
    print("\nMeasured here, at the engine's own time step: the worst number of each scene")
    print("(default: with default options)")
    print_table(("scene", "default", "recipe"), rows)
    if not all(own["cured"] for own in scenes.values()):
        print(f"{NOT_CURED.capitalize()}: more than twice what is allowed with the recipe, too.")
    for line in filter(None, (cost_line(ratio, f", {formulation}") for formulation, ratio in costs.items())):
        print(line)


@grouped
def recipes(
    *,
    chosen: Annotated[
        list[str] | None,
        typer.Option("--engine", metavar="NAME[:FORMULATION]", help="An engine; may be repeated. Without it, all."),
    ] = None,
    store: Store = None,
    out: TableFiles = None,
    computing: Computing,
) -> None:
    """Measure every set of the options that a recipe changes, in all scenes: drift, cost of a step, what gets worse.

    Exit code 0: the table is complete, whatever its numbers.

    Example: multibody-xval run recipes --engine mujoco
    """
    outs = check_outs(out, TABLE_ENDINGS, store)
    import pandas as pd

    from multibody_xval.reports.document import document
    from multibody_xval.scenarios import table_text
    from multibody_xval.scenarios.catalogue.recipes import named_recipes, study

    wanted = named_recipes(chosen or [])
    with keeping(store):
        rows = pd.concat([study(own, computing.means(store)) for own in wanted])
    shown = _for_people(rows)
    table_text.print_table(shown)
    for file in outs:
        write_whole(file, table_text.csv_text(rows) if file.suffix == ".csv" else document([shown]))


def _for_people(rows: pd.DataFrame) -> pd.DataFrame:
    """Give the table of a study as texts."""
    import pandas as pd

    from multibody_xval.scenarios.catalogue.worst_numbers import printed_number

    texts = {
        "drift [µm/s, µrad/s]": rows.drift.map(printed_number),
        "held out": rows["held out"].map(printed_number),
        "cost": rows.cost.map("×{:.2f}".format),
        "front": rows.front.map({True: "yes", False: ""}),
    }
    return pd.DataFrame({"engine": rows.engine, "options": rows.options, **texts, "spoils": rows.spoils})
