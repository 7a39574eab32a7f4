"""``multibody-xval translate``: which options of another engine bring out the same motion of boxes."""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated

import typer

from multibody_xval.engines.completion import complete_engine, complete_variant
from multibody_xval.reports.cli.options import AsJson, Computing, Store, grouped, keeping
from multibody_xval.scenarios.terminal_table import print_table

if TYPE_CHECKING:
    from multibody_xval.engines.interface.variant import Variant
    from multibody_xval.scenarios.catalogue.translation import Translation

app = typer.Typer(name="multibody-xval", add_completion=False, rich_markup_mode=None, pretty_exceptions_enable=False)


@app.command()
@grouped
def translate(
    given: Annotated[
        str,
        typer.Argument(
            metavar="NAME:contact:PRESET", help="The engine whose motion is wanted.", autocompletion=complete_variant
        ),
    ],
    engine: Annotated[str, typer.Argument(metavar="ENGINE", help="The engine to set.", autocompletion=complete_engine)],
    *,
    as_json: AsJson = False,
    store: Store = None,
    computing: Computing,
) -> None:
    """Find the options of another engine with which boxes move as in this one, and say what difference is left.

    Boxes are held, slide, stop, are pushed, carried and spun in both engines, each with its own time step. The options
    are found by search: those of the other engine's recipe, a few more, and a factor of the coefficients of friction.
    Exit code 0: printed, however large the difference.

    Example: multibody-xval translate mujoco:contact:default sapien
    """
    from multibody_xval.engines.interface.variant import Variant
    from multibody_xval.scenarios.catalogue.translation import translated

    wanted = Variant.parse(given)
    with keeping(store):
        found = translated(wanted, engine, computing.means(store))
    if as_json:
        from multibody_xval.scenarios.table_text import json_text

        rows = found.table.to_dict("records")
        print(
            json_text({"given": given, "engine": engine, "options": found.options, "apart [mm]": rows}, indent=2),
            end="",
        )
    else:
        _print(wanted, found)


def _print(wanted: Variant, found: Translation) -> None:
    """Print options, a table of the scenes, and what is left."""
    from multibody_xval.engines.interface.changed_options import value_text
    from multibody_xval.scenarios.catalogue.scenes.scene import NONE
    from multibody_xval.scenarios.catalogue.translation import PAIRS
    from multibody_xval.scenarios.catalogue.worst_numbers import printed_number

    titles = {own.engine: own.capabilities.title for own in (wanted, found.found)}
    title = titles[found.found.engine]
    print(f"Options of {title} with which boxes move most as with {wanted}:")
    for name, (value, own) in found.options.items():
        print(f"    {name} = {value_text(value)}  (its own: {value_text(own)})")
    if not found.options:
        print("    none: its own are nearest")
    if titles.keys() <= PAIRS.keys():
        print(f"Of two coefficients, {'; '.join(f'{text} takes {PAIRS[name]}' for name, text in titles.items())}.")
    table = found.table
    rows = [(scene, *map(printed_number, numbers)) for scene, *numbers in table.itertuples(index=False)]
    print_table(("scene", "way [mm]", "apart by default [mm]", "with these [mm]"), rows)
    seen = table[table.found >= NONE["wander"]]
    if seen.empty:
        print(f"Boxes move alike: nowhere are they {NONE['wander']:g} mm apart.")
        return
    worst = seen.iloc[int((seen.found / seen.way).argmax())]
    print(
        f"Most is left in {worst.scene}: {printed_number(worst.found)} mm apart on a way of "
        f"{printed_number(worst.way)} mm. No option that was tried does better."
    )
