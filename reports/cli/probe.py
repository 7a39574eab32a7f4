"""``multibody-xval probe``: what drifts in a user's own model, and whether the recipe helps."""

from __future__ import annotations

import json
import math
import textwrap
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from multibody_xval.engines.interface.texts import visible
from multibody_xval.reports.cli.options import AsJson
from multibody_xval.reports.cli.probe_finding import (
    ends,
    finding,
    helps,
    largest,
    seconds,
    units,
    velocity,
    way_unit,
)
from multibody_xval.reports.cli.shown import cost_line

if TYPE_CHECKING:
    from multibody_xval.engines.mujoco.probe import Held, Probe
    from multibody_xval.engines.mujoco.probe.slides import Slide

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
    ctrl: Annotated[
        Path | None, typer.Option(help="CSV file: seconds since the start, not since --time begins, and all controls.")
    ] = None,
    floor: Annotated[bool, typer.Option("--floor", help="Put a floor below the model.")] = False,
    free: Annotated[bool, typer.Option("--free", help="Let the base of a URDF move.")] = False,
    as_json: AsJson = False,
) -> None:
    """Measure what drifts in your own MuJoCo model: as it is, with each line of the recipe, and with all.

    Judged is what friction should hold: pairs of geoms and joints whose load stays below the friction limit, as it is
    or with the recipe. What slides, and from when on, is printed apart. The model starts at its first keyframe, with
    the controls of that; without one at its own pose, with controls at zero. Each row of --ctrl holds until the next
    one. Nothing sleeps. Lines of the recipe are tried one by one where there is something to hold, and where the model
    has such friction. A joint that moves at the start is watched until friction has stopped it. The file is never
    changed. Other engines have no such probe.
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
    """Print what is to be known, what slides, what friction should hold and stop, what lines change, the finding."""
    for note in (*found.notes, *_more_notes(found)):
        _say(note)
    first, last = ends(found)
    _print_slides(found)
    if found.held:
        text = "Drift of what friction should hold: mean slip velocity of the fastest point. Load: the part of the "
        rows = [_held_row(held, first, last) for held in found.held]
        _table(f"{text}friction limit that is used.", ("friction", "load", "unit", "as it is", "recipe"), rows)
    if found.stops:
        stops = [(stop.name, stop.exact, stop.times[first], stop.times[last]) for stop in found.stops]
        rows = [(name, *map(seconds, times)) for name, *times in stops]
        _table("When friction stops what moves at the start:", ("joint", "exact", "as it is", "recipe"), rows)
    if len(found.costs) > 1:
        late = ["stop"] if found.stops else []
        text = " and ".join(["Largest drift"] * bool(found.held) + ["last stop"] * bool(late))
        rows = [_line_row(found, line) for line in found.costs]
        _table(f"{text} with each line of the recipe alone, and with all:", ("options", *units(found), *late), rows)
    said = finding(found)
    _say(said)
    if line := cost_line(found.costs[last]):
        print(line)
    if helps(said):
        print("To write it: multibody-xval recipe mujoco --no-run")


def _say(text: str) -> None:
    print(textwrap.fill(visible(text), 80))


def _table(text: str, headings: Sequence[str], rows: Sequence[Sequence[str]]) -> None:
    from multibody_xval.scenarios.terminal_table import print_table

    print()
    _say(text)
    print_table(headings, rows)


def _print_slides(found: Probe) -> None:
    """Print what slides, what slides farthest first."""
    from multibody_xval.engines.mujoco.probe.lines import AS_IT_IS, RECIPE

    if found.slides:
        by_way = sorted(found.slides.items(), key=lambda own: -max(slide.way for slide in own[1].values()))
        rows = [(name, *(_slide(own.get(line)) for line in (AS_IT_IS, RECIPE))) for name, own in by_way[:NAMES]]
        more = f" (and {len(by_way) - NAMES} more)" if len(by_way) > NAMES else ""
        text = f"Not judged, for it slides: its load is above the friction limit{more}. Since when, and how far:"
        _table(text, ("friction", "as it is", "recipe"), rows)


def _slide(slide: Slide | None) -> str:
    """Write since when something slides, its way, and how it ends."""
    if slide is None:
        return "–"
    end = ", then apart" if slide.apart else ""
    return f"{slide.first:.3g} s, {1e3 * slide.way:.2g} {way_unit(slide.unit)}{end}"


def _held_row(held: Held, first: str, last: str) -> tuple[str, ...]:
    drifts = (velocity(1e6 * held.drift[line]) for line in (first, last))
    return held.name, f"{held.load:.3g}", held.unit, *drifts


def _line_row(found: Probe, line: str) -> tuple[str, ...]:
    """Give the row of a line of the recipe."""
    if not math.isfinite(found.costs[line]):
        return line, *("explodes" for _ in (*units(found), *found.stops[:1]))
    last = [seconds(max(stop.times[line] for stop in found.stops))] if found.stops else []
    return line, *(velocity(largest(found, line, unit)) for unit in units(found)), *last


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
    slides = [
        {
            "name": name, "unit": way_unit(next(iter(own.values())).unit),
            "since": {line: slide.first for line, slide in own.items()},
            "way": {line: 1e3 * slide.way for line, slide in own.items()},
            "apart": {line: slide.apart for line, slide in own.items()},
        }
        for name, own in found.slides.items()
    ]  # fmt: skip
    return {
        "cost": {line: _known(cost) for line, cost in found.costs.items()}, "held": held,
        "not_loaded": found.not_loaded, "slides": slides, "stops": stops,
        "watched": found.watched, "unfinished": found.unfinished, "notes": found.notes, "finding": finding(found),
    }  # fmt: skip


def _known(value: float) -> float | None:
    return value if math.isfinite(value) else None
