"""Sweeps as they are: every variant at its own points, nothing beside them."""

from collections.abc import Iterator
from dataclasses import replace

import pandas as pd

from scenarios.execution.evaluator import Evaluator, StoredResults
from scenarios.execution.storage.store import ResultStore
from scenarios.sweeps.predictions import predicted
from scenarios.sweeps.refinement import ForTheAccuracy, refined
from scenarios.sweeps.summary import SweepSummary
from scenarios.sweeps.sweep import Sweep
from scenarios.sweeps.table import grid, judged, with_results
from scenarios.tasks.result import ResultSummary
from scenarios.tasks.task import SteadyStateTask
from scenarios.verdicts.pointwise import refinements


def run_sweep(sweep: Sweep, evaluator: Evaluator) -> SweepSummary:
    """Evaluate what the store does not hold yet; every result is on disk the moment it is there.

    On an adaptive axis, every curve chooses its own points, a curve being one variant in one case.
    """
    summary = SweepSummary()
    if sweep.frequencies is None:
        evaluator.complete(sweep.tasks(), lambda task, ended: summary.add(task.variant, ended))
        return summary
    accuracy = ForTheAccuracy(sweep)
    table = refined(sweep, accuracy.due(), accuracy, evaluator)
    for variant, result in zip(table["variant"], table["result"], strict=True):
        summary.add(variant, ResultSummary.of(result))
    for (variant, _), curve in accuracy.curves.items():
        summary.unresolved[variant] += not curve.resolved
    return summary


def refined_tasks(sweep: Sweep) -> Iterator[SteadyStateTask]:
    """Give the tasks of all points with other numbers of steps, see `refinements`."""
    for point in sweep.grid_points():
        for factor in refinements(point[0], sweep.tolerance):
            yield sweep.task(*point, factor)


def stored_table(sweep: Sweep, store: ResultStore) -> tuple[Sweep, pd.DataFrame]:
    """Give the results of a sweep in a store as a judged table, and the sweep with all frequency ratios of the table.

    On an adaptive axis, the table has the points of every curve, as far as the results that are known choose them.
    """
    evaluator = StoredResults(store)
    if sweep.frequencies is None:
        whole, table = sweep, grid(sweep)
    else:
        accuracy = ForTheAccuracy(sweep)
        table = refined(sweep, accuracy.due(), accuracy, evaluator)
        etas = tuple(sorted(set(table["frequency_ratio"])))
        whole = replace(sweep, axes={**sweep.axes, "frequency_ratio": etas})
    return whole, predicted(whole, judged(whole, with_results(whole, table, evaluator)), evaluator)
