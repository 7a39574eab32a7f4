"""The labelled table of a sweep, one row a point, and its stages: grid, results, verdicts.

Its columns are ``variant``, ``case``, the axes, ``result``, ``others`` (results with other numbers of steps, by
`refinements`) and ``findings`` (of level and phase); each stage takes a table and gives one with more rows or columns.
"""

import math
from collections.abc import Iterable, Mapping, Sequence
from functools import lru_cache
from typing import NamedTuple, Protocol

import pandas as pd

from engines.interface.variant import Variant
from scenarios.runs.result import Result
from scenarios.runs.task import SteadyStateTask
from scenarios.sweeps.sweep import Case, Sweep
from scenarios.verdicts.finding import Comparison, Finding, Metric
from scenarios.verdicts.judge import FrictionEffect, friction_effect
from scenarios.verdicts.pointwise import CONVERGED, UNBOUNDED, PointResults, decisive, point_findings, refinements
from scenarios.verdicts.steady_case import REFERENCE

GridPoint = tuple[Variant, Case, float]
"""Variant, case and frequency ratio."""


class GivesResults(Protocol):
    """What gives a result to every task: an evaluator, a store, a dataset."""

    def evaluate(self, tasks: Sequence[SteadyStateTask], /) -> list[Result]:
        """Give the results, in order; what is not known is ``missing``."""


class Point(NamedTuple):
    """One row of a judged table."""

    variant: Variant
    case: Case
    frequency_ratio: float
    result: Result
    others: tuple[Result, ...]
    """Results with other numbers of steps; empty where there are none."""
    findings: tuple[Finding, ...]
    """The comparisons of its transmittance and of its phase with those of its baseline."""

    @property
    def finding(self) -> Finding:
        """The worse of both, which decides."""
        return decisive(self.findings)

    @property
    def comparison(self) -> Comparison:
        """The comparison that decides."""
        return self.finding.comparison

    def difference(self, metric: Metric) -> float:
        """Give the difference from the baseline in the unit of a metric; NaN where it was not compared."""
        return next((own.comparison.difference for own in self.findings if own.metric == metric), math.nan)

    def allowed(self, metric: Metric) -> float:
        """Give the largest such difference that counts as agreement; likewise."""
        return next((own.comparison.tolerance for own in self.findings if own.metric == metric), math.nan)


def table_of(points: Iterable[GridPoint]) -> pd.DataFrame:
    """Give a table of grid points: a column an axis, beside the variant and the case."""
    rows = list(points)
    axes = {name: [case.by_axis[name] for _, case, _ in rows] for name in (rows[0][1].by_axis if rows else ())}
    variants, cases, etas = zip(*rows, strict=True) if rows else ((), (), ())
    return pd.DataFrame({"variant": variants, "case": cases, **axes, "frequency_ratio": etas})


def grid_points_of(table: pd.DataFrame) -> list[GridPoint]:
    """Give the grid points of the rows of a table, in order."""
    return list(zip(table["variant"], table["case"], table["frequency_ratio"].tolist(), strict=True))


def points_of(table: pd.DataFrame) -> list[Point]:
    """Give the rows of a judged table, in order."""
    return [
        Point(*point, *columns)
        for point, columns in zip(
            grid_points_of(table), zip(table["result"], table["others"], table["findings"], strict=True), strict=True
        )
    ]


def with_columns(table: pd.DataFrame, **columns: Sequence[object]) -> pd.DataFrame:
    """Add columns of objects, one a row."""
    return table.assign(
        **{name: pd.Series(list(values), index=table.index, dtype=object) for name, values in columns.items()}
    )


def grid(sweep: Sweep, etas: Mapping[Case, Sequence[float]] | None = None) -> pd.DataFrame:
    """Give every variant at every point; `etas` are frequency ratios of each case, those of the sweep without it."""
    known = dict.fromkeys(sweep.cases, sweep.frequency_ratios) if etas is None else etas
    return table_of((variant, case, eta) for variant in sweep.variants for case in known for eta in known[case])


def tasks_of(sweep: Sweep, table: pd.DataFrame) -> list[SteadyStateTask]:
    """Give the tasks of all rows: first one a row, then those with other numbers of steps."""
    points = grid_points_of(table)
    return [
        *(sweep.task(*point) for point in points),
        *(sweep.task(*point, factor) for point in points for factor in refinements(point[0], sweep.tolerance)),
    ]


def with_results(sweep: Sweep, table: pd.DataFrame, evaluator: GivesResults) -> pd.DataFrame:
    """Evaluate all rows at once, and add the columns ``result`` and ``others``."""
    evaluated = iter(evaluator.evaluate(tasks_of(sweep, table)))
    results = [next(evaluated) for _ in range(len(table))]
    others = [tuple(next(evaluated) for _ in refinements(variant, sweep.tolerance)) for variant in table["variant"]]
    return with_columns(table, result=results, others=others)


def results_at(sweep: Sweep, table: pd.DataFrame) -> dict[GridPoint, PointResults]:
    """Give the results at every row, beside the reference's results at the same point."""
    known = dict(zip(grid_points_of(table), zip(table["result"], table["others"], strict=True), strict=True))
    missing = Result.missing(), ()
    at_points = {}
    for (variant, case, eta), (result, others) in known.items():
        reference, refined = known.get((REFERENCE, case, eta), missing)
        converged, _ = known.get((CONVERGED, case, eta), missing)
        at_points[variant, case, eta] = PointResults(
            variant=variant,
            result=result,
            others=others,
            reference=reference,
            converged=converged,
            refined=refined,
            given=sweep.tolerance,
            effect=_effect(sweep.task(REFERENCE, case, eta), converged.transmittance_db, converged.phase),
        )
    return at_points


@lru_cache(maxsize=10_000)
def _effect(task: SteadyStateTask, transmittance_db: float, phase: float) -> FrictionEffect:
    """Give how much friction changes a point at all; without limit where its steady state is not known."""
    if math.isnan(transmittance_db) or math.isnan(phase):
        return UNBOUNDED
    return friction_effect(*task.setting(), transmittance_db, phase)


def label_of(point: GridPoint) -> str:
    """Give a point of a curve as tables print it."""
    _, case, eta = point
    return f"{case}, η_r = {eta:.6g}"


def judged(sweep: Sweep, table: pd.DataFrame) -> pd.DataFrame:
    """Compare every row with its baseline at the same point, and add the column ``findings``."""
    findings = [point_findings(known, label_of(point)) for point, known in results_at(sweep, table).items()]
    return with_columns(table, findings=findings)
