"""``multibody-xval probe``: what creeps in a model of one's own, and what the recipe makes of it."""

from __future__ import annotations

import json
import math
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

if TYPE_CHECKING:
    from multibody_xval.engines.mujoco.probe import Probe

app = typer.Typer(name="multibody-xval", add_completion=False, pretty_exceptions_enable=False)


@app.command()
def probe(
    model: Annotated[Path, typer.Argument(metavar="MODEL", help="MJCF, or URDF as MuJoCo reads it.")],
    time: Annotated[float, typer.Option(help="How long the model is watched, in seconds.")] = 2.0,
    settling: Annotated[float, typer.Option(help="How long the model is left alone before, in seconds.")] = 1.0,
    as_json: Annotated[bool, typer.Option("--json", help="Print JSON.")] = False,
) -> None:
    """Measure what creeps in a MuJoCo model of one's own: as it is, with each line of the recipe, and with all.

    Watched is what friction should hold: pairs of geoms and joints whose friction stays below its bound in one of the
    runs, each from the model's initial state with controls at zero, without sleeping. Creep is the mean slip velocity
    of the fastest point; the cost of a step is one over that of the model as it is. The file is never changed. Other
    engines have no such probe.
    Exit code 0: printed; 2: wrong input: the model does not load, has no friction, explodes, or nothing in it rests;
    130: interrupted.

    Example: multibody-xval probe model.xml --time 2
    """
    from multibody_xval.engines.interface.registry import engine
    from multibody_xval.engines.interface.variant import check_installed
    from multibody_xval.engines.mujoco.probe import probe as probed
    from multibody_xval.engines.mujoco.probe import recommended

    mujoco = engine("mujoco")
    check_installed("mujoco", mujoco.unavailable_reason())
    found = probed(model, recommended(mujoco.capabilities.presets), time, settling)
    if as_json:
        print(json.dumps(_as_json(found), indent=2))
    else:
        _print_tables(found)


def _print_tables(found: Probe) -> None:
    """Print a row a line of the recipe, then a row for all that is held."""
    from reference_lcp.terminal import print_table

    units = dict.fromkeys(held.unit for held in found.held)
    rows = []
    for line, cost in found.costs.items():
        known = [(held.unit, held.creep[line]) for held in found.held if math.isfinite(held.creep[line])]
        worst = [max((creep for own, creep in known if own == unit), default=math.nan) for unit in units]
        rows.append((line, *map(_number, worst), f"×{cost:.2f}" if math.isfinite(cost) else "explodes"))
    print_table(("model", *(f"largest creep, {unit}" for unit in units), "cost of a step"), rows)
    first, *_, last = found.costs
    columns = ("what should hold", "load", "unit", first, "law", last, "law")
    own = [
        (
            held.name, f"{held.load:.3g}", held.unit,
            *(_number(numbers.get(line)) for line in (first, last) for numbers in (held.creep, held.law)),
        )
        for held in found.held
    ]  # fmt: skip
    print_table(columns, own)


def _number(value: float | None) -> str:
    """Write a velocity in millionths."""
    return "" if value is None else f"{1e6 * value:.4g}" if math.isfinite(value) else "–"


def _as_json(found: Probe) -> dict[str, object]:
    """Give all numbers, velocities in millionths, and ``null`` where there is none."""
    held = [
        {
            "name": each.name, "load": each.load, "unit": each.unit,
            "creep": {line: _known(1e6 * value) for line, value in each.creep.items()},
            "law": {line: _known(1e6 * value) for line, value in each.law.items()},
        }
        for each in found.held
    ]  # fmt: skip
    return {"cost": {line: _known(cost) for line, cost in found.costs.items()}, "held": held}


def _known(value: float) -> float | None:
    return value if math.isfinite(value) else None
