"""From a question to everything that its report shows: from a store, and by asking what the store does not know."""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from engines.interface.variant import Variant
from reference_lcp.accuracy.convergence import STICK_SLIP_POINTS
from reports.data.report import OperatingPoint, Report
from scenarios.execution.evaluator import Evaluator, StoredResults
from scenarios.execution.local_processes import TIME_LIMIT
from scenarios.execution.recorded import PeriodStore, RecordedPeriod, recorded_periods
from scenarios.execution.store import ResultStore
from scenarios.studies.figure3 import CONVERGED, REFERENCE, Figure3, run
from scenarios.studies.friction_map import (
    MAP_FREQUENCY_RATIOS,
    MAP_FRICTION_RATIOS,
    QUICK_MAP_FREQUENCY_RATIOS,
    QUICK_MAP_FRICTION_RATIOS,
    friction_map,
)
from scenarios.studies.work_precision import StepPoint, exact_answers, step_questions, step_study
from scenarios.tasks.parameters import ChainRatios
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
    file: Path,
    evaluator: Evaluator,
    command: str,
    *,
    scope: Scope | None = None,
    workers: int | None = None,
    time_limit: float = TIME_LIMIT,
) -> Report:
    """Gather everything.

    Parameters
    ----------
    asked
        The grid of Figure 3.
    kept, file
        The store, and its file.
    evaluator
        Who answers; one that only reads (`StoredResults`) gives a report of what there is.
    command
        The command line that asks for the same.
    scope
        What is asked beside the grid; everything without it.
    workers, time_limit
        For motions, which are computed on this machine.
    """
    scope = scope or Scope()
    reads = isinstance(evaluator, StoredResults)
    result = run(asked, evaluator)
    found = friction_map(asked, scope.map_friction_ratios, scope.map_frequency_ratios, evaluator)
    study = _step_study(asked, kept, evaluator, asks=scope.step_study and not reads, workers=workers)
    questions = _motion_questions(asked, scope.places)
    moved = recorded_periods(
        list(questions.values()), PeriodStore(file), ask=not reads, workers=workers, time_limit=time_limit
    )
    by_place: dict[OperatingPoint, dict[Variant, RecordedPeriod]] = {}
    for (place, variant), question in questions.items():
        by_place.setdefault(place, {})[variant] = moved[question]
    return Report(result, command, by_place, study, found)


def _step_study(
    asked: Figure3, kept: ResultStore, evaluator: Evaluator, *, asks: bool, workers: int | None
) -> tuple[StepPoint, ...]:
    """Give what the steps cost under the drive of `asked`; the six points are the canonical chain's alone."""
    if asked.ratios != ChainRatios():
        return ()
    drive = asked.excitation
    exact = exact_answers(STICK_SLIP_POINTS, kept, excitation=drive, ask=asks, workers=workers)
    study = step_study(asked.all_variants, exact, evaluator if asks else StoredResults(kept), drive)
    return tuple(one for one in study if one.answered or one.reason)


def expected_questions(asked: Figure3, scope: Scope) -> list[SteadyStateTask]:
    """Give what is known from the start to be asked, for bars of progress."""
    grid = [
        asked.question(REFERENCE, friction, eta)
        for friction in scope.map_friction_ratios
        for eta in scope.map_frequency_ratios
    ]
    steps = [question for variant in asked.all_variants for question in step_questions(variant, asked.excitation)]
    steps = steps if scope.step_study and asked.ratios == ChainRatios() else []
    return list(dict.fromkeys([*asked.grid, *grid, *steps]))


def _motion_questions(
    asked: Figure3, places: Sequence[OperatingPoint]
) -> dict[tuple[OperatingPoint, Variant], SteadyStateTask]:
    """Ask everybody but the converged reference at the places whose friction and frequency the grid holds."""
    held = [
        (friction, eta)
        for friction, eta in places
        if friction in asked.friction_ratios and any(math.isclose(eta, one) for one in asked.frequency_ratios)
    ]
    return {
        (place, variant): asked.question(variant, *place)
        for place in held
        for variant in asked.all_variants
        if variant != CONVERGED
    }
