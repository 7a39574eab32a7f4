"""Repetition: whether a motion that is run again is the same, bit for bit."""

from collections.abc import Mapping, Sequence

from engines.interface.presets import Formulation
from engines.interface.registry import engine
from engines.interface.variant import GENERAL, Variant
from scenarios.catalogue.base import Scenario
from scenarios.catalogue.scenes.base import COMMON_STEP
from scenarios.catalogue.scenes.slide import launched
from scenarios.runs.evaluator import Evaluator
from scenarios.runs.repeat import AGAIN, PROCESS, REVERSED, TOGETHER, RepeatTask
from scenarios.verdicts.finding import Finding, Metric, Tolerance
from scenarios.verdicts.judge import decide, missing

WAYS = (
    Metric(AGAIN, "", "Largest difference of positions, run again in the same process."),
    Metric(PROCESS, "", "The same, run in a process of its own."),
    Metric(TOGETHER, "", "The same, run beside 63 others that move in another way."),
    Metric(REVERSED, "", "The same, run beside these in the reverse order."),
)
"""All over the displacement scale, U0 of the chain or the side of the box."""


class Repeat(Scenario):
    """A motion that is run again is the same, bit for bit: of the chain, and of a box that slides."""

    name = "repeat"
    source = "What a simulation is: state in, trajectory out."
    metrics = WAYS

    def law_variant(self, variant: Variant) -> None:
        """Give none: a model has nothing to say on it."""

    def run(self, variants: Sequence[Variant], evaluator: Evaluator) -> list[Finding]:
        """Repeat what each variant has; see `Scenario.run`."""
        own = {variant: _tasks(variant) for variant in variants}
        evaluator.evaluate([task for tasks in own.values() for task in tasks.values()])
        return [
            finding
            for variant, tasks in own.items()
            for case, task in tasks.items()
            for finding in _findings(variant, case, task, evaluator)
        ]


def _tasks(variant: Variant) -> Mapping[str, RepeatTask]:
    """Give the chain, and the box where the variant has scenes."""
    tasks = {"chain": RepeatTask(variant=variant)}
    scenes = variant.unchanged.preset_name in GENERAL and variant.formulation == Formulation.CONTACT
    if scenes and not engine(variant.engine).scene_gap(Formulation.CONTACT):
        motion = launched(1.0).task(variant, COMMON_STEP)
        tasks["box that slides"] = RepeatTask(variant=variant, motion=motion)
    return tasks


def _findings(variant: Variant, case: str, task: RepeatTask, evaluator: Evaluator) -> list[Finding]:
    """Judge the ways of one motion: nothing is allowed."""
    (result,) = evaluator.evaluate([task])
    gap = missing("", [result])
    if gap is not None:
        return list(Finding.without_numbers(variant, case, WAYS, gap))
    values = {metric: result.series[metric.name][0] for metric in WAYS}
    return [
        Finding(variant, case, metric, value, 0.0, decide(metric, value, 0.0, Tolerance()))
        for metric, value in values.items()
    ]
