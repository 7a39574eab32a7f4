"""From a question to everything that its report shows: from a store, and by asking what the store does not know."""

import math
from collections.abc import Sequence
from dataclasses import dataclass

from engines.interface.variant import Variant
from reports.data.report import OperatingPoint, Report
from scenarios.execution.evaluator import Evaluator, StoredResults
from scenarios.execution.store import ResultStore
from scenarios.studies.figure3 import CONVERGED, REFERENCE, Figure3, run
from scenarios.studies.friction_map import (
    MAP_FREQUENCY_RATIOS,
    MAP_FRICTION_RATIOS,
    QUICK_MAP_FREQUENCY_RATIOS,
    QUICK_MAP_FRICTION_RATIOS,
    friction_map,
)
from scenarios.studies.work_precision import StepPoint, exact_step_tasks, step_study, step_tasks
from scenarios.tasks.parameters import ChainRatios
from scenarios.tasks.recorded import RecordedPeriod, RecordedPeriodTask
from scenarios.tasks.task import SteadyStateTask

MOTION_PLACES = ((0.3, 0.9), (1.0, 0.9))
"""Friction and frequency ratios at which the motion is kept in full: where contacts stick for part of the period."""


@dataclass(frozen=True)
class Scope:
    """How much is asked beside the grid of Figure 3.

    Parameters
    ----------
    places
        Where motions are wanted.
    map_friction_ratios, map_frequency_ratios
        Grid of the friction map.
    step_study
        Whether everybody is asked at several step sizes; if not, what the store knows of it is shown.
    """

    places: tuple[OperatingPoint, ...] = MOTION_PLACES
    map_friction_ratios: tuple[float, ...] = MAP_FRICTION_RATIOS
    map_frequency_ratios: tuple[float, ...] = MAP_FREQUENCY_RATIOS
    step_study: bool = True


QUICK = Scope(MOTION_PLACES[:1], QUICK_MAP_FRICTION_RATIOS, QUICK_MAP_FREQUENCY_RATIOS, step_study=False)


def collect(
    asked: Figure3,
    kept: ResultStore,
    evaluator: Evaluator,
    command: str,
    *,
    scope: Scope | None = None,
) -> Report:
    """Gather everything.

    Parameters
    ----------
    asked
        The grid of Figure 3.
    kept
        The store.
    evaluator
        Gives the results; one that only reads (`StoredResults`) gives a report of what there is.
    command
        The command line that asks for the same.
    scope
        What is asked beside the grid; everything without it.
    """
    scope = scope or Scope()
    result = run(asked, evaluator)
    found = friction_map(asked, scope.map_friction_ratios, scope.map_frequency_ratios, evaluator)
    study = _step_study(asked, evaluator if scope.step_study else StoredResults(kept))
    tasks = _recorded_tasks(asked, scope.places)
    by_place: dict[OperatingPoint, dict[Variant, RecordedPeriod]] = {}
    for (place, variant), one in zip(tasks, evaluator.evaluate(list(tasks.values())), strict=True):
        by_place.setdefault(place, {})[variant] = RecordedPeriod.of_result(one)
    return Report(result, command, by_place, study, found)


def _step_study(asked: Figure3, evaluator: Evaluator) -> tuple[StepPoint, ...]:
    """Give what the steps cost under the drive of `asked`; the six points are the canonical chain's alone."""
    if asked.ratios != ChainRatios():
        return ()
    study = step_study(asked.all_variants, evaluator, asked.excitation)
    return tuple(one for one in study if one.answered or one.reason)


def expected_questions(asked: Figure3, scope: Scope) -> list[SteadyStateTask]:
    """Give what is known from the start to be asked, for bars of progress."""
    grid = [
        asked.question(REFERENCE, friction, eta)
        for friction in scope.map_friction_ratios
        for eta in scope.map_frequency_ratios
    ]
    steps = [task for variant in asked.all_variants for task in step_tasks(variant, asked.excitation)]
    steps += exact_step_tasks(asked.excitation)
    steps = steps if scope.step_study and asked.ratios == ChainRatios() else []
    return list(dict.fromkeys([*asked.grid, *grid, *steps, *_recorded_tasks(asked, scope.places).values()]))


def _recorded_tasks(
    asked: Figure3, places: Sequence[OperatingPoint]
) -> dict[tuple[OperatingPoint, Variant], RecordedPeriodTask]:
    """Record every variant but the converged reference at the places whose friction and frequency the grid holds."""
    held = [
        (friction, eta)
        for friction, eta in places
        if friction in asked.friction_ratios and any(math.isclose(eta, one) for one in asked.frequency_ratios)
    ]
    return {
        (place, variant): RecordedPeriodTask.of(asked.question(variant, *place))
        for place in held
        for variant in asked.all_variants
        if variant != CONVERGED
    }
