"""What a probe found, in one line of plain words."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from multibody_xval.engines.mujoco.probe import Held, Probe
    from multibody_xval.engines.mujoco.probe.stops import Stop

NOTICEABLE = 1.0
"""Drift from which on it is a finding [µm/s], [µrad/s]: at this a model moves by 0.1 mm in 100 s."""

TRACE = 0.01
"""Drift below which digits are rounding errors of the solver [µm/s], [µrad/s]."""

CHANGE = 0.1
"""Part of a drift by which it must differ to be another one; a run of another second differs by less."""


def ends(found: Probe) -> tuple[str, str]:
    """Name the model as it is, and the last line: the recipe where that was tried."""
    lines = list(found.costs)
    return lines[0], lines[-1]


def finding(found: Probe) -> str:
    """Say whether the recipe helps."""
    first, last = ends(found)
    if not (found.held or found.stops):
        return _of_sliding(found) if found.slides else _of_nothing(found)
    if not math.isfinite(found.costs[last]):
        return "Leave the model as it is: with the recipe it explodes."
    parts = []
    if found.held:
        most = max(found.held, key=lambda held: _given_way(held, first, last))
        gives_way = _given_way(most, first, last) > NOTICEABLE
        parts.append(_gives_way(most, first, last) if gives_way else _of_drift(found, first, last))
    if found.stops:
        stop = max(found.stops, key=lambda each: each.times[first])
        parts.append(_of_stop(stop, stop.times[first], stop.times[last]))
    return " ".join(parts)


def _of_sliding(found: Probe) -> str:
    """Say that friction is overloaded, and what to do."""
    from multibody_xval.engines.mujoco.probe.lines import AS_IT_IS, RECIPE

    own, recipe = (sum(line in slide for slide in found.slides.values()) for line in (AS_IT_IS, RECIPE))
    lines = "with the recipe too" if own == recipe else "as it is" if own > recipe else "with the recipe"
    return (
        f"Nothing was judged: all that is loaded slides, {lines}. Its load is above the friction limit: grip harder, "
        "load it less, or move more slowly."
    )


def _of_nothing(found: Probe) -> str:
    """Say that friction is not loaded, and how to load it."""
    reason = "nothing loads the friction of this model" if found.not_loaded else "nothing else has friction"
    return f"Nothing was tested: {reason}. Ways to load it: {'; '.join(found.ways_to_load)}."


def helps(said: str) -> bool:
    """Tell whether a finding says that the recipe is worth writing."""
    return "The recipe helps" in said


def _of_stop(stop: Stop, own: float, recipe: float) -> str:
    """Compare when friction stops a joint: how late it is, or after which time where the exact one is not known."""
    exact = 0.0 if math.isnan(stop.exact) else stop.exact
    late, with_recipe = abs(own - exact), abs(recipe - exact)
    little = (1 - CHANGE) * late <= with_recipe <= (1 + CHANGE) * late
    words = "The recipe changes little" if little else "The recipe helps" if with_recipe < late else "The recipe harms"
    known = f" (exact: {seconds(exact)})" if exact else ""
    return f"{words}: time until friction stops {stop.name}: {seconds(own)} → {seconds(recipe)}{known}."


def _of_drift(found: Probe, first: str, last: str) -> str:
    """Compare the largest drifts as it is and with the recipe."""
    pairs = {unit: (largest(found, first, unit), largest(found, last, unit)) for unit in units(found)}
    changes = {_change(*pair) for pair in pairs.values()}
    own, recipe = ("; ".join(_in_unit(pair[n], unit) for unit, pair in pairs.items()) for n in (0, 1))
    both = "; ".join(_both(*pair, unit) for unit, pair in pairs.items())
    nothing = all(before < NOTICEABLE for before, _ in pairs.values())
    if changes >= {-1, 1}:
        text = f"The recipe helps some and makes others worse: {both}"
    elif -1 in changes:
        text = f"The recipe helps: {both}"
    elif 1 in changes and nothing:
        text = f"Leave the model as it is: nothing drifts ({own}), and the recipe makes it worse ({recipe})"
    elif 1 in changes:
        text = f"Leave the model as it is: the recipe makes it worse: {both}"
    elif any(math.isnan(before + after) for before, after in pairs.values()):
        text = f"What touches at times only is not compared: {both}"
    elif nothing:
        text = f"Nothing drifts noticeably, with or without the recipe: {both}"
    else:
        text = f"The recipe changes little: {both}"
    return f"{text}."


def _in_unit(value: float, unit: str) -> str:
    """Write a velocity with its unit; what is not held has none."""
    return f"{velocity(value)} {unit}" if math.isfinite(value) else velocity(value)


def _both(before: float, after: float, unit: str) -> str:
    """Write a velocity as it is and with the recipe, with the unit once."""
    finite = math.isfinite(before) and math.isfinite(after)
    return f"{velocity(before) if finite else _in_unit(before, unit)} → {_in_unit(after, unit)}"


def _gives_way(held: Held, first: str, last: str) -> str:
    """Say of a joint that friction holds it with the recipe alone."""
    lost, kept = (1e3 * abs(held.settled[line]) for line in (first, last))
    unit = way_unit(held.unit)
    return (
        f"The recipe helps: before it is watched, {held.name} moves by {lost:.3g} {unit} as it is, until something "
        f"else carries its load, and by {kept:.3g} {unit} with the recipe."
    )


def _given_way(held: Held, first: str, last: str) -> float:
    """Give how much farther a joint moved that is loaded with the recipe alone [millionths]."""
    if not held.settled or not held.loaded.get(last) or held.loaded.get(first):
        return 0.0
    lost, kept = (abs(held.settled[line]) for line in (first, last))
    return 1e6 * (lost - kept)


def _change(own: float, recipe: float) -> int:
    """Give -1 where the recipe drifts less, 1 where more, 0 where neither is noticeable or both are the same."""
    if math.isnan(own + recipe) or max(own, recipe) < NOTICEABLE or (1 - CHANGE) * own <= recipe <= (1 + CHANGE) * own:
        return 0
    return -1 if recipe < own else 1


def units(found: Probe) -> list[str]:
    """Give the units of what is held, each once."""
    return list(dict.fromkeys(held.unit for held in found.held))


def largest(found: Probe, line: str, unit: str) -> float:
    """Give the largest known drift of a line in millionths; NaN where none is known."""
    drifts = (1e6 * held.drift[line] for held in found.held if held.unit == unit)
    return max((drift for drift in drifts if not math.isnan(drift)), default=math.nan)


def velocity(value: float) -> str:
    """Write a velocity in millionths."""
    if not math.isfinite(value):
        return "–" if math.isnan(value) else "not held"
    return f"< {TRACE:g}" if value < TRACE else f"{value:,.0f}" if value >= 1000 else f"{value:.3g}"


def way_unit(unit: str) -> str:
    """Give the unit of a way, thousandths, from that of a velocity, millionths."""
    return unit.removesuffix("/s").replace("µ", "m")


def seconds(value: float) -> str:
    """Write when something stopped."""
    return "" if math.isnan(value) else f"{value:.3g} s" if math.isfinite(value) else "never"
