"""``multibody-xval engines``: which engines there are, what they can do, and their laws."""

from __future__ import annotations

import json
from typing import TYPE_CHECKING, Annotated, Any

import typer

from multibody_xval.engines.completion import complete_variant
from multibody_xval.reports.cli.options import NAME_METAVAR, AsJson
from reference_lcp.terminal import print_table, visible

if TYPE_CHECKING:
    from multibody_xval.engines.interface.law import Law
    from multibody_xval.engines.interface.variant import Variant

app = typer.Typer(name="multibody-xval engines", add_completion=False, pretty_exceptions_enable=False)


@app.callback(invoke_without_command=True)
def engines(context: typer.Context, as_json: AsJson = False) -> None:
    """List every registered engine: version, friction law and presets, and why it is missing if it is.

    Exit code 0: listed, installed or not; 2: wrong input; 130: interrupted.

    Example: multibody-xval engines --json
    """
    if context.invoked_subcommand is not None:
        return
    from multibody_xval.engines.interface.registry import registered_names

    rows = [described(name) for name in registered_names()]
    if as_json:
        print(json.dumps(rows, indent=2))
        return
    lines = []
    for row in rows:
        arithmetic = row.get("precision", "") + ("" if row.get("deterministic", True) else ", varies")
        law = f"{row.get('friction_law', '')}\n{arithmetic}"
        presets = "\n".join(f"{formulation}: {', '.join(names)}" for formulation, names in row["presets"].items())
        lines.append((row["engine"], row["version"] or "missing", row["python"] or "", law, presets))
    print_table(("engine", "version", "Python", "friction law, precision", "formulation: presets"), lines)
    for row in rows:
        if row["missing"] is not None:
            print(visible(f"{row['engine']}: {row['missing']}"))


@app.command()
def law(
    name: Annotated[
        str, typer.Argument(metavar=NAME_METAVAR, help="The configuration.", autocompletion=complete_variant)
    ],
) -> None:
    """Print the law of a preset: its formula, its constants and their origin, and the distance between engine and law.

    Exit code 0: printed; 2: wrong input; 130: interrupted.

    Example: multibody-xval engines law mujoco:joint:default
    """
    from multibody_xval.engines.interface.law import NotModelled
    from multibody_xval.engines.interface.variant import Variant

    variant = Variant.parse(name)
    stated = variant.preset.stated_law()
    if stated is None:
        step = "the step of the reference, equation (5)" if variant.preset.shares_scheme else "none"
        print(f"{variant}: {step}")
    elif isinstance(stated, NotModelled):
        print(visible(f"{variant} is not modelled: {stated.reason}"))
    else:
        print(f"{variant}: {stated.formula}")
        rows = [(symbol, f"{each.value:g}", each.unit, each.source) for symbol, each in stated.constants.items()]
        print_table(("constant", "value", "unit", "from"), rows)
        print(_measured(variant, stated))


def _measured(variant: Variant, law: Law) -> str:
    """Compare a period of engine and law at the points where the law claims to hold."""
    from multibody_xval.engines.shared.law_distance import difference_in_words, figure3_lanes

    bound = f"allowed {law.period_bound:g} U0: {law.bound_reason}"
    missing = variant.unavailable_reason
    if missing is not None:
        return f"not measured here, {missing}; {bound}"
    asked = [(lane, law.unclaimed_reason(lane)) for lane in figure3_lanes()]
    lanes = [lane for lane, reason in asked if reason is None]
    if not lanes:
        reasons = "; ".join(dict.fromkeys(reason for _, reason in asked if reason is not None))
        return f"not measured: it does not claim to hold at any of {len(asked)} points: {reasons}"
    return f"{difference_in_words(variant, law, lanes)}; {bound}"


def described(name: str) -> dict[str, Any]:
    """Describe one engine as plain data, ready for JSON; of a broken one, without its capabilities."""
    from multibody_xval.engines.interface.registry import broken_reason, engine

    broken = broken_reason(name)
    if broken is not None:
        return {"engine": name, "version": None, "python": None, "presets": {}, "missing": broken}
    own = engine(name)
    abilities, missing = own.capabilities, own.unavailable_reason()
    return {
        "engine": name,
        "title": abilities.title,
        "package": abilities.package,
        "licence": abilities.licence,
        "version": own.version() if missing is None else None,
        "python": own.python() if missing is None else None,
        "friction_law": str(abilities.friction_law),
        "presets": {str(formulation): list(presets) for formulation, presets in abilities.presets.items()},
        "normal_force": {
            str(formulation): {name: str(preset.normal_force) for name, preset in presets.items()}
            for formulation, presets in abilities.presets.items()
        },
        "precision": abilities.precision,
        "deterministic": abilities.deterministic,
        "missing": missing,
        "notes": abilities.notes,
    }
