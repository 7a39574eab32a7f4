"""Which options make friction hold in a user's own model: every set of those that an engine's recipe has, measured.

A set is worth its cost if no other one creeps less at no more cost. A recipe is the smallest such set that spoils no
other number of a scene; it is also measured on variations that it was not found with.
"""

import itertools
import math
import timeit
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace

from multibody_xval.engines.interface.presets import Formulation
from multibody_xval.engines.interface.registry import engine, engine_names
from multibody_xval.engines.interface.scene import SceneWorld
from multibody_xval.engines.interface.variant import Variant
from multibody_xval.scenarios.catalogue.base import Scenario
from multibody_xval.scenarios.catalogue.registry import CATALOGUE
from multibody_xval.scenarios.catalogue.scenes.base import CREEP, SceneScenario, general_variants
from multibody_xval.scenarios.catalogue.scenes.hold import StackHold
from multibody_xval.scenarios.catalogue.scenes.joints import TURNING, ArmHold
from multibody_xval.scenarios.catalogue.scenes.table import worst_numbers
from multibody_xval.scenarios.catalogue.verdict_table import finding_table
from multibody_xval.scenarios.runs.evaluator import Evaluator
from multibody_xval.scenarios.runs.scene import built
from multibody_xval.scenarios.tables import Column
from multibody_xval.scenarios.verdicts.finding import Finding, Verdict
from reference_lcp.errors import ParameterError, checked_choice

MOST_SETS = 32
"""Sets of a study: those of five options."""

BLOCKS, STEPS = 25, 60
"""Samples of a cost, and steps of each: the fastest counts, for other programs only add time."""

NOT_SPOILT = 1.1
"""An error counts as larger than that of the engine as it comes from so many times on: hopping is chaotic."""

SAME_COST = 1.05
"""Ratio of costs that are not told apart."""


@dataclass(frozen=True)
class Measurement:
    """One set of options of one engine in all scenes of a formulation."""

    variant: Variant
    options: tuple[str, ...]
    """What it changes, by name; none where the engine is as it comes."""
    findings: tuple[Finding, ...]
    held_out: tuple[Finding, ...]
    """Of variations that no recipe is found with."""
    cost: float
    """Of a step, over that of the engine as it comes, in the same run; NaN where it was not measured."""

    @property
    def creep(self) -> float:
        """Largest creep [µm/s], [µrad/s]; infinite where a scene failed."""
        return largest_creep(self.findings)

    def spoils(self, installed: "Measurement") -> list[Finding]:
        """Give the numbers that are farther from the truth than with the engine as it comes, and than is allowed."""
        before = {(finding.case, finding.metric): abs(finding.comparison.difference) for finding in installed.findings}
        return [
            finding
            for finding in self.findings
            if finding.comparison.verdict is Verdict.DISAGREE
            and not abs(finding.comparison.difference) <= NOT_SPOILT * before[finding.case, finding.metric]
        ]


def largest_creep(findings: Sequence[Finding]) -> float:
    """Give the largest creep of what should hold [µm/s], [µrad/s]; infinite where a scene failed, NaN without any."""
    held = [finding for finding in findings if finding.metric in (CREEP, TURNING)]
    failed = any(finding.comparison.verdict is Verdict.DISAGREE and math.isnan(finding.value) for finding in held)
    known = [abs(finding.value) for finding in held if not math.isnan(finding.value)]
    return math.inf if failed else max(known, default=math.nan)


Numbers = dict[str, dict[str, float]]
"""The worst number of each scene by preset; see `worst_numbers`."""


def scenes_of(formulation: Formulation) -> list[SceneScenario]:
    """Give the scenarios whose friction acts in joints, or in contacts."""
    scenes = [scenario for scenario in CATALOGUE.values() if isinstance(scenario, SceneScenario)]
    return [scenario for scenario in scenes if scenario.formulation is formulation]


def option_sets(recommended: Variant) -> dict[tuple[str, ...], Variant]:
    """Give every set of the options that a recipe changes, as variants; with all of them, other values too.

    Raises
    ------
    ParameterError
        If there are more than `MOST_SETS`.
    """
    preset = recommended.preset
    changed = preset.changed_from(replace(recommended, preset_name="default").preset)
    if 2 ** len(changed) > MOST_SETS:
        raise ParameterError(f"{recommended} changes {len(changed)} options; allowed in a study: {MOST_SETS} sets")
    sets = {}
    for left_out in itertools.chain.from_iterable(
        itertools.combinations(changed, count) for count in reversed(range(len(changed) + 1))
    ):
        variant = recommended
        for name in left_out:
            variant = variant.changed(name, changed[name])
        sets[tuple(name for name in changed if name not in left_out)] = variant
    for name, values in preset.varied.items():
        for value in values:
            others = (other for other in changed if other != name)
            sets[*others, f"{name} = {value:g}"] = recommended.changed(name, value)
    return sets


NOTHING_TO_RECOMMEND = "it has no options to recommend"
"""Of an engine whose scenes have no recommended preset."""


def named_recipes(names: Sequence[str]) -> list[Variant]:
    """Give the recipes of engines by name, of one formulation or of both; of all engines that have scenes without any.

    Raises
    ------
    ParameterError
        If an engine is unknown or not installed, or has no recipe or no scenes of a formulation that is named.
    """
    every = [(name, formulation) for name in engine_names() for formulation in Formulation]
    wanted = [(name, kind) for text in names for name, kind in _parsed(text)]
    for name, formulation in wanted:
        gap = engine(name).unavailable_reason() or engine(name).scene_gap(formulation)
        if gap is None and len(general_variants(name, formulation)) == 1:
            gap = NOTHING_TO_RECOMMEND
        if gap is not None:
            raise ParameterError(
                f"engine = {name}:{formulation}: {gap}; allowed: one with scenes, and options to recommend"
            )
    found = [
        general_variants(name, formulation)[1:] for name, formulation in wanted or every if _has(name, formulation)
    ]
    return [variant for own in found for variant in own]


def _has(name: str, formulation: Formulation) -> bool:
    """Whether an engine is there and has scenes of a formulation."""
    return engine(name).scene_gap(formulation) is None and engine(name).unavailable_reason() is None


def _parsed(text: str) -> list[tuple[str, Formulation]]:
    """Read ``NAME`` or ``NAME:FORMULATION``; a name alone stands for all formulations with scenes of the engine."""
    name, colon, formulation = text.partition(":")
    checked_choice("engine", name, engine_names())
    if colon:
        return [(name, Formulation(checked_choice("formulation", formulation, list(Formulation))))]
    return [(name, each) for each in Formulation if engine(name).scene_gap(each) is None] or [
        (name, Formulation.CONTACT)
    ]


def study(recommended: Variant, evaluator: Evaluator) -> "list[StudyRow]":
    """Measure every set of options of a recipe, the engine as it comes first."""
    installed = replace(recommended, preset_name="default")
    sets = {**option_sets(recommended), (): installed}
    scenes = scenes_of(Formulation(recommended.formulation))
    found = _by_variant(sets.values(), [each for scene in scenes for each in scene.run([*sets.values()], evaluator)])
    kept = [installed, recommended]
    apart = _by_variant(kept, [own for each in scenes for own in each.judged(kept, each.held_out, evaluator)])
    rows = [
        Measurement(variant, options, found[variant], apart.get(variant, ()), step_ratio(variant, installed))
        for options, variant in sorted(sets.items(), key=lambda item: len(item[0]))
    ]
    return [(row, rows) for row in rows]


def recipe_results(name: str, evaluator: Evaluator) -> tuple[Numbers, dict[str, float]]:
    """Give the worst number of every scene of an engine by preset, and by formulation what its recipe costs a step.

    Scenes without numbers are left out.
    """
    scenes = [scene for formulation in Formulation for scene in scenes_of(formulation)]
    own = {scene: general_variants(name, scene.formulation) for scene in scenes if _has(name, scene.formulation)}
    found: dict[Scenario, list[Finding]] = {scene: scene.run(variants, evaluator) for scene, variants in own.items()}
    worst = worst_numbers(finding_table(found)).loc[name].dropna(how="all")
    numbers = {str(number): {str(key): float(value) for key, value in row.items()} for number, row in worst.iterrows()}
    pairs = {formulation: general_variants(name, formulation) for formulation in Formulation if _has(name, formulation)}
    return numbers, {str(kind): step_ratio(pair[-1], pair[0]) for kind, pair in pairs.items() if len(pair) > 1}


def _by_variant(variants: Iterable[Variant], found: Sequence[Finding]) -> dict[Variant, tuple[Finding, ...]]:
    return {variant: tuple(each for each in found if each.variant == variant) for variant in variants}


def step_ratio(variant: Variant, base: Variant) -> float:
    """Measure the cost of a step over that of another variant, in turns, in a stack of boxes or an arm of six links."""
    scenario = StackHold() if variant.formulation == Formulation.CONTACT else ArmHold()
    worlds: list[SceneWorld] = []
    try:
        for each in (variant, base):
            worlds.append(built(scenario.cases[-1].task(each, engine(each.engine).scene_step)))
            worlds[-1].run(STEPS)
        taken = [math.inf, math.inf]
        for _ in range(BLOCKS):
            for index, world in enumerate(worlds):
                taken[index] = min(taken[index], timeit.timeit(lambda world=world: world.run(STEPS), number=1))  # type: ignore[misc]
    finally:
        for world in worlds:
            world.close()
    return taken[0] / taken[1]


def on_front(row: Measurement, rows: Sequence[Measurement]) -> bool:
    """Tell whether no other set creeps less at no more cost."""
    return not any(other.creep < row.creep and other.cost <= row.cost * SAME_COST for other in rows)


StudyRow = tuple[Measurement, Sequence[Measurement]]
"""A set of options, and all sets; the engine as it comes is the first."""

RECIPE_COLUMNS: tuple[Column[StudyRow], ...] = (
    Column("engine", lambda row: f"{row[0].variant.engine}:{row[0].variant.formulation}"),
    Column("options", lambda row: ", ".join(row[0].options) or "as installed"),
    Column("creep", lambda row: row[0].creep, "creep [µm/s, µrad/s]", "{:.3g}"),
    Column("held out", lambda row: largest_creep(row[0].held_out), pattern="{:.3g}"),
    Column("cost", lambda row: row[0].cost, pattern="×{:.2f}"),
    Column("front", lambda row: "yes" if on_front(*row) else ""),
    Column("spoils", lambda row: _spoilt(row[0].spoils(row[1][0]))),
)
"""Of a study: creep is the worst of all scenes, at the engine's own step and at 1 ms."""


def _spoilt(findings: Sequence[Finding]) -> str:
    """Name the worst of what is spoilt, and say how much there is."""
    if not findings:
        return ""
    worst = max(findings, key=lambda own: own.excess)
    more = f" (and {len(findings) - 1} more)" if len(findings) > 1 else ""
    return f"{worst.metric.name} {worst.value:.3g} {worst.metric.unit}, {worst.case}{more}"
