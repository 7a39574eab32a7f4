"""``multibody-xval translate``: which options of another engine bring out the same motion of boxes."""

from __future__ import annotations

import textwrap
from typing import TYPE_CHECKING, Annotated

import typer

from multibody_xval.engines.completion import complete_engine, complete_variant
from multibody_xval.reports.cli.options import AsJson, Computing, Store, grouped, keeping
from multibody_xval.scenarios.terminal_table import print_table
from reference_lcp.errors import ParameterError

if TYPE_CHECKING:
    from multibody_xval.engines.interface.variant import Variant
    from multibody_xval.scenarios.catalogue.translation import Translation

app = typer.Typer(name="multibody-xval", add_completion=False, rich_markup_mode=None, pretty_exceptions_enable=False)


@app.command()
@grouped
def translate(
    given: Annotated[
        str,
        typer.Argument(metavar="WANTED", help="The engine whose motion is wanted.", autocompletion=complete_variant),
    ],
    engine: Annotated[str, typer.Argument(metavar="ENGINE", help="The engine to set.", autocompletion=complete_engine)],
    *,
    as_json: AsJson = False,
    store: Store = None,
    computing: Computing,
) -> None:
    """Say what to write in ENGINE so that boxes move as in WANTED, and how far apart they still are.

    WANTED is an engine (its default options), or NAME:contact:PRESET. In both engines boxes are held, slide, stop, are
    pushed, carried and spun, with the engine's own time step. A search of some minutes tries options of the recipe, a
    few more, and a factor of the coefficients of friction. Exit code 0: printed, however large the difference.

    Example: multibody-xval translate mujoco sapien
    """
    from multibody_xval.engines.interface.variant import GENERAL, Variant
    from multibody_xval.scenarios.catalogue.translation import translated

    wanted = Variant.parse(given if ":" in given else f"{given}:contact:{GENERAL[0]}")
    if engine == wanted.engine:
        raise ParameterError(f"engine = {engine} is the wanted one too; allowed: another engine")
    with keeping(store):
        found = translated(wanted, engine, computing.means(store))
    if as_json:
        from multibody_xval.scenarios.table_text import json_text

        said = {"wanted": str(wanted), "engine": engine, "write": found.text, "options": found.options}
        print(json_text({**said, "apart [mm]": found.table.to_dict("records")}, indent=2), end="")
    else:
        _print(wanted, found)


def _print(wanted: Variant, found: Translation) -> None:
    """Print what is left, what to write, what else motions depend on, and a table of the scenes."""
    from multibody_xval.engines.interface.changed_options import value_text
    from multibody_xval.engines.interface.registry import engine
    from multibody_xval.scenarios.catalogue.scenes.scene import NONE
    from multibody_xval.scenarios.catalogue.translation import ALIKE, SAID
    from multibody_xval.scenarios.catalogue.worst_numbers import printed_number

    both = {own.engine: own.capabilities.title for own in (wanted, found.found)}
    title = both[found.found.engine]
    print(
        f"{title} with these options moves boxes as {wanted} in {found.alike('found')} of {len(found.table)} scenes, "
        f"with default options in {found.alike('default')}:"
    )
    print(textwrap.indent(found.text or "its default options", "    "))
    changes = [f"{name} = {value_text(new)} (default {value_text(own)})" for name, (new, own) in found.options.items()]
    print(f"Changed: {', '.join(changes) or 'nothing'}.")
    for name, text in both.items():
        said = SAID.get(name, {})
        more = f"; {said['setup']}; of two coefficients it takes {said['coefficients']}" if said else ""
        print(f"{text} here: time step {1e3 * engine(name).scene_step:.3g} ms{more}.")
    rows = [(scene, *map(printed_number, numbers)) for scene, *numbers in found.table.itertuples(index=False)]
    print_table(("scene", "way [mm]", "apart by default [mm]", "with these [mm]"), rows)
    print(f"As: at most {ALIKE:.0%} of the way apart, or {NONE['wander']:g} mm.")
