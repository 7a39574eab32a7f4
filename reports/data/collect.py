"""From a sweep to everything that its report shows."""

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

import xarray as xr

from multibody_xval.engines.interface.variant import Variant
from multibody_xval.reports.data.catalogue import catalogue_outcomes, scene_numbers
from multibody_xval.reports.data.report import Report
from multibody_xval.reports.data.stick_slip import CasePoint
from multibody_xval.scenarios.runs.evaluator import Evaluator, StoredResults
from multibody_xval.scenarios.runs.parameters import ChainRatios, OperatingPoint
from multibody_xval.scenarios.runs.recorded import RecordedPeriod
from multibody_xval.scenarios.runs.store import ResultStore
from multibody_xval.scenarios.runs.task import Recorded, SteadyStateTask
from multibody_xval.scenarios.studies.claims import (
    Conclusions,
    compared_conclusions,
    evaluated_conclusions,
    led_claims_sweep,
)
from multibody_xval.scenarios.studies.friction_map import (
    MAP_FREQUENCY_RATIOS,
    MAP_FRICTION_RATIOS,
    QUICK_MAP_FREQUENCY_RATIOS,
    QUICK_MAP_FRICTION_RATIOS,
    friction_map,
    map_sweep,
)
from multibody_xval.scenarios.studies.headline import headline_points, headline_sweep, headline_tasks
from multibody_xval.scenarios.studies.response import ONE_CELL, response_curves
from multibody_xval.scenarios.studies.work_precision import (
    STUDY_STEPS,
    coarse_steps,
    exact_step_tasks,
    step_tasks,
    thrifty_step_study,
)
from multibody_xval.scenarios.sweeps.checks import LEAST_POINTS, check_starts
from multibody_xval.scenarios.sweeps.compared import ComparedSweep, compare_sweep, judged_points
from multibody_xval.scenarios.sweeps.dataset_reader import DatasetResults, recorded_variants
from multibody_xval.scenarios.sweeps.point import Point, tasks_of
from multibody_xval.scenarios.sweeps.sweep import Sweep
from multibody_xval.scenarios.sweeps.truths import exact_tasks, with_recorded_truths, with_truths
from multibody_xval.scenarios.verdicts.steady_case import CONVERGED, EXACT

RECORDED_POINTS = (OperatingPoint(0.3, 0.9), OperatingPoint(1.0, 0.9))
"""Points whose period is recorded in full: where contacts stick for part of the period."""


MOST_PERIODS = 6
"""Most points whose period is recorded; a sweep over more than friction holds each of them many times."""


@dataclass(frozen=True)
class Scope:
    """The parts of a report beside the grid of its sweep."""

    recorded_points: tuple[OperatingPoint, ...] = RECORDED_POINTS
    """Points whose period is recorded."""
    map_friction_ratios: tuple[float, ...] = MAP_FRICTION_RATIOS
    map_frequency_ratios: tuple[float, ...] = MAP_FREQUENCY_RATIOS
    """Grid of the friction map."""
    steps: tuple[int, ...] = STUDY_STEPS
    """Steps a period at which every variant is simulated at six points, `FINEST_STEPS` only where its error still
    falls; what the store holds of others is shown too.
    """
    checked: int = LEAST_POINTS
    """Fewest points of each variant that are computed the long way too, see `scenarios.sweeps.checks`."""
    beside: tuple[Variant, ...] = ()
    """Variants that are compared with the truth at the headline's points only, and have no verdict."""
    recommended: tuple[Variant, ...] = ()
    """Likewise; they take part in no scenario."""
    claims: tuple[Variant, ...] = ()
    """Variants that answer the paper's claims on points of their own; without any, all answer by those of the grid."""
    scenarios: tuple[str, ...] = ()
    """Scenarios of the catalogue that all variants are run in; of others, what the store knows is shown."""
    proof: bool = False
    """Whether truths are proven that the table of proven levels does not have."""


QUICK = Scope(RECORDED_POINTS[:1], QUICK_MAP_FRICTION_RATIOS, QUICK_MAP_FREQUENCY_RATIOS, steps=(), checked=2)
"""Two points a variant are computed both ways: a preview."""


def collect(
    sweep: Sweep, store: ResultStore, evaluator: Evaluator, command: str, *, scope: Scope | None = None
) -> Report:
    """Collect everything that the report of a sweep shows."""
    scope = scope or Scope()
    evaluator.stage("all points that are known from the start")
    evaluator.evaluate(expected_tasks(sweep, scope))
    evaluator.stage("other numbers of steps, band edges and laws")
    compared = compare_sweep(sweep, evaluator, scope.checked)
    evaluator.stage("searches from harmonic balance")
    points, starts = check_starts(sweep, compared.points, evaluator, scope.checked)
    result = replace(compared, points=points)
    evaluator.stage("recorded periods")
    mapped = _map(sweep, scope)
    tasks = _recorded_tasks(sweep, scope.recorded_points)
    periods: dict[CasePoint, dict[Variant, RecordedPeriod]] = {}
    for (point, variant), recorded in zip(tasks, evaluator.evaluate(list(tasks.values())), strict=True):
        periods.setdefault(point, {})[variant] = RecordedPeriod.of_result(recorded)
    evaluator.stage("exact motions")
    # before steps that are read from the store: these compare with the exact motion
    result = with_truths(result, evaluator, proof=scope.proof)
    evaluator.stage("the paper's claims")
    concluded = _conclusions(result, scope, evaluator)
    evaluator.stage("the headline's points")
    headline = _headline(sweep, scope, evaluator)
    evaluator.stage("other steps, friction map and responses")
    steps = None
    if _is_canonical(sweep):
        stored = StoredResults(store)
        steps = tuple(thrifty_step_study(sweep.variants, evaluator, stored, sweep.excitation, scope.steps))
    return Report(
        result,
        command,
        periods,
        conclusions=concluded,
        steps=steps,
        friction_map=None if mapped is None else friction_map(mapped, evaluator),
        starts=starts,
        headline=headline,
        unit_cell=response_curves(ONE_CELL, evaluator, sweep.excitation) if headline else {},
        chain=response_curves(sweep.ratios, evaluator, sweep.excitation) if headline else {},
        catalogue=catalogue_outcomes((*sweep.variants, *scope.beside), store, evaluator, scope.scenarios),
        scenes=scene_numbers(store),
    )


def _headline(sweep: Sweep, scope: Scope, evaluator: Evaluator) -> tuple[Point, ...]:
    """Compare every variant with the truth at the headline's points, which are of the canonical chain."""
    return headline_points(_shown(sweep, scope), evaluator, sweep.excitation) if _is_papers(sweep) else ()


def _shown(sweep: Sweep, scope: Scope) -> tuple[Variant, ...]:
    """Give the variants at the headline's points; those that may have no steady state, and take longest, come last."""
    return tuple(dict.fromkeys((*sweep.variants, *scope.beside, *scope.recommended)))


def _conclusions(result: ComparedSweep, scope: Scope, evaluator: Evaluator) -> tuple[Conclusions, ...]:
    """Answer the paper's claims, which are about the canonical chain on a moving base."""
    sweep = result.sweep
    if not _is_papers(sweep):
        return ()
    if not scope.claims:
        return tuple(compared_conclusions(result))
    return tuple(evaluated_conclusions(sweep, scope.claims, evaluator))


def collect_dataset(data: xr.Dataset, command: str) -> Report:
    """Collect what a dataset holds: its points, judged; nothing is computed, and no edge is refined."""
    results = DatasetResults(data)
    recorded = recorded_variants(data)
    points = sorted(results.points, key=lambda point: point[2])
    result = judged_points(results.sweep.ascending(), points, results, results.predictions, results.modelled)
    known = with_recorded_truths(result, data, results.sweep)
    return Report(known, command, steps=None, recorded=recorded)


def _map(sweep: Sweep, scope: Scope) -> Sweep | None:
    """Give the sweep of the friction map; ``None`` where more than friction is varied: there is no one chain then."""
    if sweep.case_axes != ("friction_ratio",):
        return None
    return map_sweep(sweep, scope.map_friction_ratios, scope.map_frequency_ratios)


def _is_canonical(sweep: Sweep) -> bool:
    """Whether the sweep is about the canonical chain, which the six points of the step study belong to."""
    return sweep.case_axes == ("friction_ratio",) and sweep.ratios == ChainRatios()


def _is_papers(sweep: Sweep) -> bool:
    """Whether the sweep is about the canonical chain on a moving base, as the paper's claims and the headline are."""
    return _is_canonical(sweep) and sweep.excitation.kind == "base"


def expected_tasks(sweep: Sweep, scope: Scope) -> list[SteadyStateTask]:
    """Give what is known from the start to be evaluated; what may never settle comes before most of it.

    One exact motion is the first, whose solver is compiled beside the first engine's law.
    """
    exact = exact_tasks(sweep.task(EXACT, case, eta) for case in sweep.cases for eta in sweep.frequency_ratios)
    if scope.steps and _is_canonical(sweep):
        exact = [*exact_step_tasks(sweep.excitation), *exact]
    tasks = [*exact[:1], *tasks_of(sweep, list(sweep.grid_points()))]
    if _is_papers(sweep):
        tasks += headline_tasks(headline_sweep(_shown(sweep, scope)[::-1], sweep.excitation)).values()
        tasks += led_claims_sweep(sweep, scope.claims).tasks() if scope.claims else ()
    mapped = _map(sweep, scope)
    if mapped is not None:
        tasks += mapped.tasks()
    if scope.steps and _is_canonical(sweep):
        steps = coarse_steps(scope.steps)
        tasks += [task for variant in sweep.variants for task in step_tasks(variant, sweep.excitation, steps)]
    return list(dict.fromkeys([*tasks, *exact, *_recorded_tasks(sweep, scope.recorded_points).values()]))


def _recorded_tasks(sweep: Sweep, points: Sequence[OperatingPoint]) -> dict[tuple[CasePoint, Variant], SteadyStateTask]:
    """Record every variant but the converged reference at those of the points that the grid holds."""
    held = [
        (case, eta)
        for friction, eta in points
        for case in sweep.cases
        if friction == case.friction_ratio and any(math.isclose(eta, ratio) for ratio in sweep.frequency_ratios)
    ]
    return {
        (point, variant): sweep.task(variant, *point).recording(Recorded.PERIOD)
        for point in held[:MOST_PERIODS]
        for variant in sweep.variants
        if variant != CONVERGED
    }
