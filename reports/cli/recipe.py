"""``multibody-xval recipe``: what to write in one's own model so that friction holds, and what that gives."""

from __future__ import annotations

import json
from typing import Annotated

import typer

from multibody_xval.engines.completion import complete_engine
from multibody_xval.reports.cli.options import Store, Work, grouped

app = typer.Typer(name="multibody-xval", add_completion=False, pretty_exceptions_enable=False)


@app.command()
@grouped
def recipe(
    engine: Annotated[str, typer.Argument(metavar="NAME", help="The engine.", autocompletion=complete_engine)],
    *,
    measure: Annotated[
        bool,
        typer.Option("--run/--no-run", help="Measure all scenes with it; --no-run prints the recipe alone."),
    ] = True,
    as_json: Annotated[bool, typer.Option("--json", help="Print JSON.")] = False,
    store: Store = None,
    work: Work,
) -> None:
    """Print what to write in one's own model so that friction holds, in the engine's own syntax, and what that gives.

    Numbers are the worst of each scene at the engine's own time step, as installed and with the recipe.
    Exit code 0: printed; 2: wrong input, or the engine has no recipe; 3: results could not be written; 130:
    interrupted.

    Example: multibody-xval recipe mujoco
    """
    from multibody_xval.engines.interface.registry import engine as engine_of
    from multibody_xval.engines.interface.variant import check_installed
    from multibody_xval.reports.reproducers.recipe import recipe_text
    from multibody_xval.scenarios.catalogue.scenes.recipes import recipe_results

    text = recipe_text(engine)
    numbers: dict[str, dict[str, float]] = {}
    costs: dict[str, float] = {}
    if measure:
        check_installed(engine, engine_of(engine).unavailable_reason())
        with work.evaluator(store, []) as evaluator:
            numbers, costs = recipe_results(engine, evaluator)
    if as_json:
        print(json.dumps({"engine": engine, "recipe": text, "scenes": numbers, "cost": costs}, indent=2))
        return
    print(text, end="")
    if measure:
        _print_table(numbers, costs)


def _print_table(numbers: dict[str, dict[str, float]], costs: dict[str, float]) -> None:
    """Print a row a number, and what a step costs with the recipe."""
    from multibody_xval.scenarios.catalogue.scenes.table import printed_number
    from reference_lcp.terminal import print_table

    rows = [(name, *(printed_number(value) for value in own.values())) for name, own in numbers.items()]
    print_table(("scene, worst number", "as installed", "recipe"), rows)
    for formulation, ratio in costs.items():
        print(f"cost of a step with the recipe, {formulation}: ×{ratio:.2f}")
