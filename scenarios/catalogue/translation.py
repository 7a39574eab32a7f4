"""Which options of another engine bring out the same motion of boxes: found by search, with what is left apart.

Boxes are held, slide, stop, are pushed, carried and spun in the engine that is given, and in the other one. What counts
is how far the two boxes come apart.
"""

import math
import re
import tomllib
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
import pandas as pd
from scipy.interpolate import CubicHermiteSpline

from multibody_xval.engines.interface.presets import Formulation
from multibody_xval.engines.interface.registry import engine, engine_names
from multibody_xval.engines.interface.variant import GENERAL, check_installed
from multibody_xval.scenarios.cases.scene_motion import SceneMotion
from multibody_xval.scenarios.catalogue.all_scenarios import SCENARIOS
from multibody_xval.scenarios.catalogue.scenario import general_configs, scene_steps
from multibody_xval.scenarios.catalogue.scenes.scene import NONE, box_scene
from multibody_xval.scenarios.model import Config, Result, Run
from multibody_xval.scenarios.running.evaluate import Means, computed
from reference_lcp.errors import ParameterError, checked_choice
from reference_lcp.validation import FloatArray

TABLE: Mapping[str, Any] = tomllib.loads(Path(__file__).with_suffix(".toml").read_text(encoding="utf-8"))
SAID: Mapping[str, Any] = TABLE["engines"]
"""What is said of engines: how their options are written, and what else their motions depend on."""

SCENES = {f"{name}, {case}": SCENARIOS[name].cases[case] for name, case in TABLE["scenes"]}
CASES: dict[str, SceneMotion] = {name: case for name, case in SCENES.items() if isinstance(case, SceneMotion)}
"""Scenes in which two engines are compared: boxes are held, slide, stop, are pushed, carried and spun."""

OPTION = re.compile("{([^{}]+)}")
"""An option in what is to be written."""

FACTOR = "factor of every coefficient of friction"
"""It is among the options that are sought."""

FACTOR_STEP = 0.1
"""Change of that factor where options with a range are changed by a decade, in decades."""

WIDE = 10.0
"""Ratio of two values of an option from which on those between are tried too, and those beyond by as much."""

FINEST = 0.1
"""Smallest change that is tried [decades]: a smaller one changes a drift by less than a quarter."""

CHANGE = 0.02
"""What a changed option has to bring [decades, in the mean of all scenes]: distances that are a twentieth smaller."""

ALIKE = 0.05
"""Part of their way that boxes are apart at most which move alike: coefficients of friction are hardly known better."""

NEVER_APART = 1e4
"""Distance at which a scene counts that an engine fails at [mm]: farther than any box goes."""


class Translation(NamedTuple):
    """The options of an engine with which boxes move most as in another one."""

    found: Config
    """The engine with its changed options."""
    friction: float
    """Factor of the coefficients of friction."""
    table: pd.DataFrame
    """A row a scene: its name, the way of the box in the engine that is given, the distance to it with the other's
    default options, and with those that are found [mm]."""

    @property
    def options(self) -> dict[str, tuple[Any, Any]]:
        """Give what differs from default options, by name: the value that is found, and the engine's own."""
        changed = {name: (self.found.preset[name], own) for name, own in self.found.changed_options.items()}
        return changed | ({} if self.friction == 1 else {FACTOR: (self.friction, 1.0)})

    @property
    def text(self) -> str:
        """Give what to write: all options that were sought, or the changed ones where no syntax is known."""
        values = {name: own.value for name, own in self.found.preset.options.items()}
        bare = [f"{name} = {{{name}}}" for name in self.found.changed_options]
        texts = SAID.get(self.found.engine, {}).get("write", bare)
        known = [each for each in texts if set(OPTION.findall(each)) <= values.keys()]
        return "\n".join(OPTION.sub(lambda own: str(values[own[1]]), each) for each in known)

    def alike(self, column: str) -> int:
        """Give in how many scenes boxes move alike, with options that are found, or with default ones."""
        return int((self.table[column] <= np.maximum(ALIKE * self.table.way, NONE["wander"])).sum())


def translated(given: Config, name: str, means: Means) -> Translation:
    """Find the options of an engine with which boxes move most as in another one; fewer changes where they do as well.

    Parameters
    ----------
    given
        Whose motion is wanted: contacts, with default options or the recipe, and any of their options changed.
    name
        The engine whose options are sought.
    means
        What computes, and where results are kept.

    Raises
    ------
    ParameterError
        If an engine is unknown, not installed or has no scenes with contacts.
    """
    _check(given, name)
    wanted = _motions([(given, 1.0)], means, str(given))[0]
    installed, recipe, values = _sought(name)
    first = tuple(installed.items())
    known: dict[tuple[tuple[str, Any], ...], dict[str, float]] = {}

    def measure(candidates: Iterable[Mapping[str, Any]], what: str) -> Any:
        new = [own for own in dict.fromkeys(tuple(each.items()) for each in candidates) if own not in known]
        motions = _motions([_config(name, dict(own)) for own in new], means, what) if new else []
        for own, motion in zip(new, motions, strict=True):
            known[own] = {scene: apart(case, wanted[scene], motion[scene]) for scene, case in CASES.items()}
        return min(known, key=lambda own: _difference(known[own]) + CHANGE * len(set(own) - set(first)))

    best, size = measure([installed, recipe], f"{name}, default options and recipe"), 1.0
    while size > FINEST:
        before, best = best, measure(_neighbours(dict(best), values, size), f"{name}, values × or ÷ {10**size:.2g}")
        size = size / 2 if best == before else size
    rows = [
        (scene, _way(case, wanted[scene]), known[first][scene], known[best][scene]) for scene, case in CASES.items()
    ]
    return Translation(*_config(name, dict(best)), pd.DataFrame(rows, columns=["scene", "way", "default", "found"]))


def _check(given: Config, name: str) -> None:
    checked_choice("engine", name, engine_names())
    if given.formulation != Formulation.CONTACT or not given.runs_scenes:
        text = f"{given.engine}:{given.formulation}:{given.preset_name}"
        presets = " or ".join(f"{given.engine}:contact:{own}" for own in GENERAL)
        raise ParameterError(f"engine = {text}; allowed: contacts in any model, {presets}")
    for own in (given.engine, name):
        missing = engine(own).unavailable_reason()
        check_installed(own, missing and f"{missing}; docs/how_to/fix_creep.md has the pairs that were measured")
        if gap := engine(own).scene_gap(Formulation.CONTACT):
            raise ParameterError(f"engine = {own}: {gap}; allowed: one with scenes of contacts")


def _sought(name: str) -> tuple[dict[str, Any], dict[str, Any], dict[str, tuple[Any, ...]]]:
    """Give the options that are sought with the engine's own values, with those of its recipe, and with all."""
    config = general_configs(name, Formulation.CONTACT)[-1]
    recipe, changed = config.preset, config.changed_options
    more = {
        own: values
        for own, values in {**recipe.varied, **SAID.get(name, {}).get("more", {})}.items()
        if own in recipe.options
    }
    last = {FACTOR: 1.0} | {option: recipe[option] for option in (*changed, *more)}
    first = last | changed
    return first, last, {own: tuple(dict.fromkeys([first[own], *more.get(own, ()), last[own]])) for own in last}


def _config(name: str, values: Mapping[str, Any]) -> tuple[Config, float]:
    """Give the configuration with these values, and the factor of the coefficients of friction."""
    config = general_configs(name, Formulation.CONTACT)[-1]
    for option, value in values.items():
        if option != FACTOR and value != config.preset[option]:
            config = config.changed(option, value)
    return config, values[FACTOR]


def _neighbours(best: Mapping[str, Any], ranges: Mapping[str, Sequence[Any]], size: float) -> Iterator[dict[str, Any]]:
    """Give the values with one option changed: by decades where it has a range, else to any other."""
    for option, values in ranges.items():
        for value in _others(option, best[option], values, size):
            yield {**best, option: value}


def _others(option: str, now: Any, values: Sequence[Any], size: float) -> Sequence[Any]:
    if option == FACTOR:
        return [float(f"{now * 10 ** (sign * FACTOR_STEP * size):.4g}") for sign in (-1, 1)]
    if not _is_range(values):
        return [value for value in values if value != now]
    least, most = min(values) / WIDE, max(values) * WIDE
    moved = [float(f"{now * 10 ** (sign * size):.4g}") for sign in (-1, 1)]
    return [value for value in [*moved, values[0], values[-1]] if least <= value <= most]


def _is_range(values: Sequence[Any]) -> bool:
    numbers = [value for value in values if isinstance(value, float)]
    return len(numbers) == len(values) > 1 and min(numbers) > 0 and max(numbers) >= WIDE * min(numbers)


def _motions(configs: Sequence[tuple[Config, float]], means: Means, what: str) -> list[dict[str, Result]]:
    """Run all scenes with configurations, each at its engine's own time step and with its factor of friction."""
    runs = {(n, scene): _run(*own, CASES[scene]) for n, own in enumerate(configs) for scene in CASES}
    results = {own.run: own.result for own in computed(list(dict.fromkeys(runs.values())), means, what)}
    return [{scene: results[runs[n, scene]] for scene in CASES} for n in range(len(configs))]


def _run(config: Config, factor: float, case: SceneMotion) -> Run:
    scene = box_scene(case)
    changed = replace(case, scene=replace(scene, friction=factor * scene.friction))
    return Run(config, changed, next(iter(scene_steps(config, case).values())))


def apart(case: SceneMotion, one: Result, other: Result) -> float:
    """Give the largest distance between two boxes at one time, at the corners too where they turn [mm].

    Times are those of the first, from the first row of the other on; between its own rows this moves by their cubic.
    Where one failed, `NEVER_APART`.
    """
    if not (one.series and other.series):
        return NEVER_APART
    times = np.array(one.series["time"])
    times = times[times >= other.series["time"][0]]
    (way, turn), (way_other, turn_other) = _motion(one, times), _motion(other, times)
    box = box_scene(case).boxes[-1]
    corner = math.hypot(box.side, box.length or box.side) / 2
    between = np.linalg.norm(way - way_other, axis=1) + corner * np.abs(turn - turn_other)
    return min(1e3 * float(np.max(between)), NEVER_APART)


def _motion(result: Result, times: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Give the way along, across and off the plane [m] and the turn [rad] at times."""
    own = np.array(result.series["time"])
    ways = [
        CubicHermiteSpline(own, result.series[axis], result.series[f"speed {axis}"])(times)
        for axis in ("along", "across", "off")
    ]
    return np.column_stack(ways), np.interp(times, own, np.unwrap(result.series["turn"]))


def _way(case: SceneMotion, result: Result) -> float:
    """Give the farthest that a box comes from where it began, at the corners too where it turns [mm]."""
    at_rest = {name: (0.0,) * len(own) for name, own in result.series.items() if name != "time"}
    return apart(case, result, replace(result, series={**result.series, **at_rest}))


def _difference(scenes: Mapping[str, float]) -> float:
    """Give the mean of the decades by which distances are over the one that counts as none."""
    return float(np.mean([math.log10(1 + own / NONE["wander"]) for own in scenes.values()]))
