"""``multibody-xval engines``: which engines there are, and what they can do."""

from __future__ import annotations

import json
from typing import Any

import typer

from multibody_xval.engines.interface.texts import visible
from multibody_xval.reports.cli.options import AsJson
from multibody_xval.scenarios.terminal_table import print_table

app = typer.Typer(
    name="multibody-xval engines", add_completion=False, rich_markup_mode=None, pretty_exceptions_enable=False
)


@app.command()
def engines(as_json: AsJson = False) -> None:
    """List every registered engine: version, friction law and presets, and why it is missing if it is.

    Exit code 0: listed, installed or not.

    Example: multibody-xval engines --json
    """
    from multibody_xval.engines.interface.registry import registered_names

    rows = [described(name) for name in registered_names()]
    if as_json:
        print(json.dumps(rows, indent=2))
        return
    lines = []
    for row in rows:
        arithmetic = row.get("precision", "") + ("" if row.get("deterministic", True) else ", varies")
        law = f"{row.get('friction_law', '')}\n{arithmetic}"
        presets = "\n".join(_presets(row, formulation) for formulation in row["presets"])
        lines.append((row["engine"], row["version"] or "missing", row["python"] or "", law, presets))
    print_table(("engine", "version", "Python", "friction law, precision", "formulation: presets"), lines)
    for row in rows:
        if row["missing"] is not None:
            print(visible(f"{row['engine']}: {row['missing']}"))


def _presets(row: dict[str, Any], formulation: str) -> str:
    only = row["scenes_only"][formulation]
    names = [f"{name} (scenes only)" if name in only else name for name in row["presets"][formulation]]
    return f"{formulation}: {', '.join(names)}"


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
        "scenes_only": {
            str(formulation): [name for name, preset in presets.items() if preset.scenes_only]
            for formulation, presets in abilities.presets.items()
        },
        "normal_force": {
            str(formulation): {name: str(preset.normal_force) for name, preset in presets.items()}
            for formulation, presets in abilities.presets.items()
        },
        "precision": abilities.precision,
        "deterministic": abilities.deterministic,
        "missing": missing,
        "notes": abilities.notes,
    }
