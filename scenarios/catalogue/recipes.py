"""Which options make friction hold in a user's own model: every set of those that an engine's recipe has, measured.

A set is worth its cost if no other one drifts less at no more cost. A recipe is the smallest such set that spoils no
other number of a scene; it is also measured on variations that it was not found with.
"""

import itertools
import math
import timeit
from collections.abc import Sequence
from dataclasses import replace

import pandas as pd

from multibody_xval.engines.interface.presets import Formulation
from multibody_xval.engines.interface.registry import engine, engine_names
from multibody_xval.engines.interface.scene import SceneWorld
from multibody_xval.engines.interface.variant import GENERAL
from multibody_xval.scenarios.cases.scene_motion import SceneMotion
from multibody_xval.scenarios.catalogue.all_scenarios import SCENARIOS
from multibody_xval.scenarios.catalogue.numbers import numbers
from multibody_xval.scenarios.catalogue.scenario import Scenario, general_configs
from multibody_xval.scenarios.catalogue.worst_numbers import worst_numbers
from multibody_xval.scenarios.compute.scenes import built
from multibody_xval.scenarios.model import Config, Run
from multibody_xval.scenarios.result_tables import full_name
from multibody_xval.scenarios.ruler.judge import DEVIATES
from multibody_xval.scenarios.running.evaluate import Means, computed
from reference_lcp.errors import ParameterError, checked_choice

MOST_SETS = 32
"""Sets of a study: those of five options."""

BLOCKS, STEPS = 25, 60
"""Samples of a cost, and steps of each: the fastest counts, for other programs only add time."""

NOT_SPOILT = 1.1
"""An error counts as larger than that with default options from so many times on: hopping is chaotic."""

SAME_COST = 1.05
"""Ratio of costs that are not told apart."""

NOTHING_TO_RECOMMEND = "it has no options to recommend"
"""Of an engine whose scenes have no recommended preset."""

COSTLY = {Formulation.CONTACT: "stack-hold", Formulation.JOINT: "arm-hold"}
"""Scenarios whose last case has most bodies: in it the cost of a step is measured."""


def scenes_of(formulation: Formulation) -> list[Scenario]:
    """Give the scenarios of scenes whose friction acts in joints, or in contacts."""
    first = [(scenario, next(iter(scenario.cases.values()))) for scenario in SCENARIOS.values()]
    return [own for own, case in first if isinstance(case, SceneMotion) and case.formulation == formulation]


def named_recipes(names: Sequence[str]) -> list[Config]:
    """Give the recipes of engines by name, of one formulation or of both; of all engines that have scenes without any.

    Raises
    ------
    ParameterError
        If an engine is unknown or not installed, or has no recipe or no scenes of a formulation that is named.
    """
    wanted = [pair for name in names for pair in _parsed(name)]
    found = []
    for name, formulation in wanted or itertools.product(engine_names(), Formulation):
        gap = engine(name).unavailable_reason() or engine(name).scene_gap(formulation)
        configs = general_configs(name, formulation)
        if gap is None and len(configs) == 1:
            gap = NOTHING_TO_RECOMMEND
        if gap is None:
            found.append(configs[-1])
        elif names:
            raise ParameterError(
                f"engine = {name}:{formulation}: {gap}; allowed: one with scenes, and options to recommend"
            )
    if not found:
        raise ParameterError("engine = all: none of those installed has a recipe; allowed: install one that has")
    return found


def _parsed(text: str) -> list[tuple[str, Formulation]]:
    """Read ``NAME`` or ``NAME:FORMULATION``; a name alone stands for all formulations with scenes of the engine."""
    name, colon, formulation = text.partition(":")
    checked_choice("engine", name, engine_names())
    if colon:
        return [(name, Formulation(checked_choice("formulation", formulation, list(Formulation))))]
    return [(name, each) for each in Formulation if engine(name).scene_gap(each) is None] or [
        (name, Formulation.CONTACT)
    ]


def option_sets(recipe: Config) -> dict[tuple[str, ...], Config]:
    """Give every set of the options that a recipe changes; with all of them, other values too.

    Raises
    ------
    ParameterError
        If there are more than `MOST_SETS`.
    """
    changed = recipe.changed_options
    if 2 ** len(changed) > MOST_SETS:
        raise ParameterError(f"{recipe} changes {len(changed)} options; allowed in a study: {MOST_SETS} sets")
    sets = {}
    for count in reversed(range(len(changed) + 1)):
        for left_out in itertools.combinations(changed, count):
            config = recipe
            for name in left_out:
                config = config.changed(name, changed[name])
            sets[tuple(name for name in changed if name not in left_out)] = config
    for name, values in recipe.preset.varied.items():
        others = [other for other in changed if other != name]
        sets.update({(*others, f"{name} = {value:g}"): recipe.changed(name, value) for value in values})
    return sets


def scene_numbers(scenes: Sequence[Scenario], configs: Sequence[Config], means: Means) -> pd.DataFrame:
    """Run scenes with configurations of their formulation, and give their numbers."""
    runs = [
        run
        for scene in scenes
        for config in configs
        for run in scene.own_runs(config).values()
        if isinstance(run.case, SceneMotion) and run.case.formulation == config.formulation
    ]
    stored = computed(runs, means, "scenes")
    return pd.concat([numbers(scene, stored) for scene in scenes], ignore_index=True)


def study(recipe: Config, means: Means) -> pd.DataFrame:
    """Measure every set of options of a recipe, in all scenes.

    Returns
    -------
    pandas.DataFrame
        A row a set, default options first: ``engine`` with the formulation, ``options`` that are changed; the largest
        ``drift`` of what should hold [µm/s], [µrad/s], also in ``held out`` variations; ``cost`` of a step over that
        with default options; ``front``: whether no other set drifts less at no more cost; what it ``spoils``.
    """
    installed = replace(recipe, preset_name="default")
    sets = sorted({**option_sets(recipe), (): installed}.items(), key=lambda item: len(item[0]))
    scenes = scenes_of(Formulation(recipe.formulation))
    found = scene_numbers(scenes, [config for _, config in sets], means)
    apart = scene_numbers([replace(scene, cases=scene.held_out) for scene in scenes], [installed, recipe], means)
    before = _of(found, installed)
    rows = [
        {
            "engine": f"{config.engine}:{config.formulation}",
            "options": ", ".join(options) or "default options",
            "drift": largest_drift(_of(found, config)),
            "held out": largest_drift(_of(apart, config)),
            "cost": step_ratio(config, installed),
            "spoils": _worst_spoilt(spoilt(_of(found, config), before)),
        }
        for options, config in sets
    ]
    table = pd.DataFrame(rows)
    table.insert(5, "front", on_front(table))
    return table


def _of(table: pd.DataFrame, config: Config) -> pd.DataFrame:
    return table[table.configuration == full_name(config)]


def largest_drift(table: pd.DataFrame) -> float:
    """Give the largest drift of what should hold [µm/s], [µrad/s]; infinite where a scene failed, NaN without any."""
    held = table[table.quantity.isin(["drift", "turning"])]
    return math.inf if (held.verdict == "failed").any() else float(held.value.astype(float).abs().max())


def spoilt(own: pd.DataFrame, installed: pd.DataFrame) -> pd.DataFrame:
    """Give the numbers that are farther from the exact value than with default options, and than is allowed."""
    keys = ["scenario", "case", "quantity"]
    before = own[keys].merge(installed, on=keys, how="left").distance.to_numpy()
    return own[own.verdict.isin([DEVIATES, "failed"]) & ~(own.distance <= NOT_SPOILT * before)]


def _worst_spoilt(rows: pd.DataFrame) -> str:
    """Name the worst of what is spoilt, and say how much there is."""
    if rows.empty:
        return ""
    excess = (rows.distance / rows.allowed).fillna(math.inf)
    worst = rows.iloc[int(excess.argmax())]
    more = f" (and {len(rows) - 1} more)" if len(rows) > 1 else ""
    return f"{worst.quantity} {worst.value:.3g} {worst.unit}, {worst.case}{more}"


def on_front(table: pd.DataFrame) -> list[bool]:
    """Tell of each set whether no other one drifts less at no more cost."""
    return [not ((table.drift < own.drift) & (table.cost <= own.cost * SAME_COST)).any() for _, own in table.iterrows()]


def recipe_results(name: str, means: Means) -> tuple[pd.DataFrame, dict[str, float]]:
    """Give the worst number of every scene of an engine, and by formulation what its recipe costs a step.

    The table is that of `worst_numbers`, a row a number; scenes without numbers are left out.
    """
    usable = [kind for kind in Formulation if engine(name).scene_gap(kind) is None]
    configs = {kind: general_configs(name, kind) for kind in usable}
    scenes = [scene for kind in usable for scene in scenes_of(kind)]
    worst = worst_numbers(scene_numbers(scenes, [config for own in configs.values() for config in own], means))
    costs = {str(kind): step_ratio(own[-1], own[0]) for kind, own in configs.items() if len(own) > 1}
    return worst.droplevel("engine").dropna(subset=list(GENERAL), how="all"), costs


def step_ratio(config: Config, base: Config) -> float:
    """Measure the cost of a step over that of another configuration, in turns, in a stack of boxes or an arm."""
    scenario = SCENARIOS[COSTLY[Formulation(config.formulation)]]
    case = list(scenario.cases.values())[-1]
    worlds: list[SceneWorld] = []
    try:
        for own in (config, base):
            worlds.append(built(Run(own, case, next(iter(scenario.steps(own, case).values())))))
            worlds[-1].run(STEPS)
        taken = [math.inf, math.inf]
        for _ in range(BLOCKS):
            for place, world in enumerate(worlds):
                taken[place] = min(taken[place], timeit.timeit(lambda world=world: world.run(STEPS), number=1))  # type: ignore[misc]
    finally:
        for world in worlds:
            world.close()
    return taken[0] / taken[1]
