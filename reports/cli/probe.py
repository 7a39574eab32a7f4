"""``multibody-xval probe``: what drifts in a user's own model, and whether the recipe helps."""

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
from multibody_xval.reports.cli.probe_finding import ends, finding, largest, seconds, units, velocity

if TYPE_CHECKING:
    from multibody_xval.engines.mujoco.probe import Held, Probe

NAMES = 6
"""Of what was not tested, printed at most."""

app = typer.Typer(name="multibody-xval", add_completion=False, rich_markup_mode=None, pretty_exceptions_enable=False)


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
    """Measure what drifts in your own MuJoCo model: as it is, with each line of the recipe, and with all.

    Watched is what friction should hold: pairs of geoms and joints whose friction stays below its bound in one of the
    runs. The model starts at its first keyframe, with the controls of that; without one at its own pose, with controls
    at zero. Each row of --ctrl, with the time since the start in seconds, holds until the next one. Nothing sleeps.
    Drift is the mean slip velocity of the fastest point; the cost per step is relative to that of the model as it is.
    Where nothing loads friction, the lines are not tried one by one. A joint that moves at the start is watched until
    friction has stopped it. The file is never changed. Other engines have no such probe.
    Exit code 0: printed.

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
    """Print what is to be known, what friction should hold and stop, what each line changes, and the finding."""
    from multibody_xval.scenarios.terminal_table import print_table

    for note in (*found.notes, *_more_notes(found)):
        print(textwrap.fill(visible(note), 80))
    first, last = ends(found)
    if found.held:
        columns = ("what should hold", "load", "unit", "as it is", "with recipe")
        print_table(columns, [_held_row(held, first, last) for held in found.held])
    if found.stops:
        headings = ("friction stops", "exact", "as it is", "with recipe")
        stops = [(stop.name, stop.exact, stop.times[first], stop.times[last]) for stop in found.stops]
        print_table(headings, [(name, *map(seconds, times)) for name, *times in stops])
    if len(found.costs) > 1:
        drifts = (f"largest drift, {unit}" for unit in units(found))
        late = ["last stop"] if found.stops else []
        print_table(("options", *drifts, *late, "cost per step"), [_line_row(found, line) for line in found.costs])
    print(textwrap.fill(visible(finding(found)), 80))


def _held_row(held: Held, first: str, last: str) -> tuple[str, ...]:
    drifts = (velocity(1e6 * held.drift[line]) for line in (first, last))
    return held.name, f"{held.load:.3g}", held.unit, *drifts


def _line_row(found: Probe, line: str) -> tuple[str, ...]:
    """Give the row of a line of the recipe."""
    cost = found.costs[line]
    if not math.isfinite(cost):
        return line, *("" for _ in units(found)), *([""] if found.stops else []), "explodes"
    last = [seconds(max(stop.times[line] for stop in found.stops))] if found.stops else []
    return line, *(velocity(largest(found, line, unit)) for unit in units(found)), *last, f"×{cost:.2f}"


def _more_notes(found: Probe) -> Iterator[str]:
    """Say what was not tested, and where the solver did not converge."""
    from multibody_xval.engines.mujoco.probe.friction import MARGIN

    if found.not_loaded:
        more = len(found.not_loaded) - NAMES
        names = ", ".join(found.not_loaded[:NAMES]) + (f" and {more} more" if more > 0 else "")
        yield f"Not tested, since less than {MARGIN:g} of the friction is used: {names}."
    first, last = ends(found)
    for line in dict.fromkeys((first, last)):
        if count := found.unfinished.get(line):
            yield f"The solver stopped at its limit in {count} of {found.watched} steps ({line})."


def _as_json(found: Probe) -> dict[str, object]:
    """Give all numbers, velocities in millionths, and ``null`` where there is none."""
    held = [
        {
            "name": each.name, "load": each.load, "unit": each.unit,
            "loaded": each.loaded,
            "drift": {line: _known(1e6 * value) for line, value in each.drift.items()},
            "predicted": {line: _known(1e6 * value) for line, value in each.predicted.items()},
            "settled": each.settled,
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
        "notes": found.notes, "finding": finding(found),
    }  # fmt: skip


def _known(value: float) -> float | None:
    return value if math.isfinite(value) else None
