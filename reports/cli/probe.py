"""``multibody-xval probe``: what creeps in a model of one's own, and what the recipe makes of it."""

from __future__ import annotations

import json
import math
import textwrap
from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from multibody_xval.engines.interface.texts import visible
from multibody_xval.reports.cli.options import AsJson

if TYPE_CHECKING:
    from multibody_xval.engines.mujoco.probe import Creep, Probe

NAMES = 6
"""Of what was not tested, printed at most."""

app = typer.Typer(name="multibody-xval", add_completion=False, pretty_exceptions_enable=False)


@app.command()
def probe(
    model: Annotated[Path, typer.Argument(metavar="MODEL", help="MJCF, or URDF as MuJoCo reads it.")],
    time: Annotated[float, typer.Option(help="How long the model is watched, in seconds.")] = 2.0,
    settling: Annotated[float, typer.Option(help="How long the model is left alone before, in seconds.")] = 1.0,
    keyframe: Annotated[
        str | None, typer.Option(help="Where the model starts; by default its first, or 'none'.")
    ] = None,
    ctrl: Annotated[Path | None, typer.Option(help="CSV file that drives the model: time and all controls.")] = None,
    floor: Annotated[bool, typer.Option("--floor", help="Put a floor below the model.")] = False,
    free: Annotated[bool, typer.Option("--free", help="Let the base of a URDF move.")] = False,
    as_json: AsJson = False,
) -> None:
    """Measure what creeps in a MuJoCo model of one's own: as it is, with each line of the recipe, and with all.

    Watched is what friction should hold: pairs of geoms and joints whose friction stays below its bound in one of the
    runs. The model starts at its first keyframe, with the controls of that; without one at its own pose, with controls
    at zero. Each row of --ctrl, with the time since the start in seconds, holds until the next one. Nothing sleeps.
    Creep is the mean slip velocity of the fastest point; the cost of a step is one over that of the model as it is. A
    joint that moves at the start is watched until friction has stopped it. The file is never changed. Other engines
    have no such probe.
    Exit code 0: printed; 2: wrong input: the model does not load, has no friction, explodes, or nothing in it rests;
    130: interrupted.

    Example: multibody-xval probe model.xml --time 2
    """
    from multibody_xval.engines.interface.registry import engine
    from multibody_xval.engines.interface.variant import check_installed
    from multibody_xval.engines.mujoco.probe import probe as probed
    from multibody_xval.engines.mujoco.probe.lines import recommended

    mujoco = engine("mujoco")
    check_installed("mujoco", mujoco.unavailable_reason())
    presets = recommended(mujoco.capabilities.presets)
    found = probed(model, presets, time, settling, keyframe=keyframe, ctrl=ctrl, floor=floor, free=free)
    if as_json:
        print(json.dumps(_as_json(found), indent=2))
    else:
        _print_tables(found)


def _print_tables(found: Probe) -> None:
    """Print what is to be known, a row a line of the recipe, a row for all that is held, and the finding."""
    from multibody_xval.scenarios.terminal_table import print_table

    for note in (*found.notes, *_more_notes(found)):
        print(textwrap.fill(visible(note), 80))
    first, *_, last = found.costs
    units = dict.fromkeys(held.unit for held in found.held)
    rows = []
    for line, cost in found.costs.items():
        creeps = (_number(_worst(found, line, unit)) for unit in units)
        times = (_seconds(stop.times[line]) for stop in found.stops)
        rows.append((line, *creeps, *times, f"×{cost:.2f}" if math.isfinite(cost) else "explodes"))
    if found.stops:
        rows.append(("exact", *("" for _ in units), *(_seconds(stop.exact) for stop in found.stops), ""))
    stops = (f"{stop.name} stops after" for stop in found.stops)
    print_table(("model", *(f"largest creep, {unit}" for unit in units), *stops, "cost of a step"), rows)
    if found.held:
        columns = ("what should hold", "load", "unit", first, "law", last, "law")
        print_table(columns, [_row(held, first, last) for held in found.held])
    print(visible(_finding(found)))


def _more_notes(found: Probe) -> Iterator[str]:
    """Say what was not tested, and where the solver did not converge."""
    if found.not_loaded:
        more = len(found.not_loaded) - NAMES
        names = ", ".join(found.not_loaded[:NAMES]) + (f" and {more} more" if more > 0 else "")
        yield f"Not loaded, so not tested: {names}."
    first, *_, last = found.costs
    for line in (first, last):
        if count := found.unfinished.get(line):
            yield f"The solver stopped at its limit in {count} of {found.watched} steps ({line})."


def _row(held: Creep, first: str, last: str) -> tuple[str, ...]:
    numbers = (_number(numbers.get(line)) for line in (first, last) for numbers in (held.creep, held.law))
    return held.name, f"{held.load:.3g}", held.unit, *numbers


def _worst(found: Probe, line: str, unit: str) -> float:
    """Give the largest creep of a line; infinite where something slides."""
    known = [held.creep[line] for held in found.held if held.unit == unit and not math.isnan(held.creep[line])]
    return max(known, default=math.nan)


def _finding(found: Probe) -> str:
    """Say in one line what the recipe makes of it."""
    first, *_, last = found.costs
    if found.held:
        units = dict.fromkeys(held.unit for held in found.held)
        numbers = ([_number(_worst(found, line, unit)) for line in (first, last)] for unit in units)
        pairs = (f"{' → '.join(own)} {unit}" for unit, own in zip(units, numbers, strict=True))
        return f"Largest creep, {first} → {last}: {'; '.join(pairs)}."
    if found.stops:
        stop = max(found.stops, key=lambda each: each.times[first])
        known = "" if math.isnan(stop.exact) else f"; exact: {_seconds(stop.exact)}"
        return (
            f"{stop.name} stops after {_seconds(stop.times[first])}, {_seconds(stop.times[last])} with {last}{known}."
        )
    return "Nothing was tested; the lines above say why."


def _number(value: float | None) -> str:
    """Write a velocity in millionths."""
    if value is None or math.isnan(value):
        return "" if value is None else "–"
    return f"{1e6 * value:.4g}" if math.isfinite(value) else "slides"


def _seconds(value: float) -> str:
    return "" if math.isnan(value) else f"{value:.3g} s" if math.isfinite(value) else "never"


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
    stops = [
        {
            "name": stop.name, "exact": _known(stop.exact),
            "time": {line: _known(value) for line, value in stop.times.items()},
        }
        for stop in found.stops
    ]  # fmt: skip
    return {
        "cost": {line: _known(cost) for line, cost in found.costs.items()}, "held": held,
        "not_loaded": found.not_loaded, "stops": stops, "watched": found.watched, "unfinished": found.unfinished,
        "notes": found.notes,
    }  # fmt: skip


def _known(value: float) -> float | None:
    return value if math.isfinite(value) else None
