"""How well presets step as they state, by a law of their own or by the reference's scheme: a row of numbers each."""

import platform
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from multibody_xval.engines.interface.law import NotModelled
from multibody_xval.engines.interface.variant import Variant
from multibody_xval.engines.shared.law_distance import FREQUENCY_RATIOS, FRICTION_RATIOS, allowed_distance, stepped_by
from multibody_xval.scenarios.runs.evaluator import Evaluator
from multibody_xval.scenarios.runs.result import Result, ResultStatus
from multibody_xval.scenarios.runs.task import Recorded, SteadyStateTask, versions_of
from multibody_xval.scenarios.tables import Column, markdown_lines, text_table
from multibody_xval.scenarios.verdicts.steady_case import REFERENCE
from reference_lcp.validation import FloatArray

POINTS = tuple((friction, frequency) for friction in FRICTION_RATIOS for frequency in FREQUENCY_RATIOS)
"""Friction and frequency ratio of each point."""


@dataclass(frozen=True)
class LawAgreement:
    """What a variant deviates by from the reference at equal step, and what its law leaves of it.

    The law of a variant that takes the reference's own step is that step: nothing is left to predict of a deviation.
    """

    variant: Variant
    reason: str
    """Why its steps are not modelled; empty where they are."""
    deviation: float
    error: float
    """Largest difference of its transmittance from the reference's, and from its law's [dB], over the points that are
    certified in both; NaN without any."""
    stuck_fraction: float
    """Largest difference of a stuck fraction from the law's."""
    period: FloatArray
    """Distance from the law after a period from the same state, over U0, at every point where the law claims to
    hold."""
    bound: float
    certified: int


def law_tasks(variant: Variant) -> Iterator[SteadyStateTask]:
    """Give everything that the row of a variant needs."""
    for simulated in (variant, REFERENCE, variant.law):
        if simulated is not None:
            yield from _steady_states(simulated)
    if stepped_by(variant) is not None:
        yield from _periods(variant)


def beside_the_reference(variants: Iterable[Variant]) -> list[Variant]:
    """Give the variants of other engines than the reference."""
    return [variant for variant in variants if variant.engine != REFERENCE.engine]


def law_agreements(variants: Sequence[Variant], evaluator: Evaluator) -> list[LawAgreement]:
    """Give the row of each of `beside_the_reference`."""
    tasks = list(dict.fromkeys(task for variant in variants for task in law_tasks(variant)))
    results = dict(zip(tasks, evaluator.evaluate(tasks), strict=True))
    return [_row(variant, results) for variant in variants]


def _steady_states(variant: Variant) -> list[SteadyStateTask]:
    return [SteadyStateTask(variant=variant, friction_ratio=point[0], frequency_ratio=point[1]) for point in POINTS]


def _periods(variant: Variant) -> list[SteadyStateTask]:
    return [task.recording(Recorded.LAW) for task in _steady_states(variant)]


def _row(variant: Variant, results: Mapping[SteadyStateTask, Result]) -> LawAgreement:
    own, reference = ([results[task] for task in _steady_states(each)] for each in (variant, REFERENCE))
    deviation, _, certified = _differences(own, reference)
    stated = variant.preset.stated_law()
    if isinstance(stated, NotModelled):
        return LawAgreement(variant, stated.reason, deviation, np.nan, np.nan, np.empty(0), np.nan, certified)
    error, stuck, both = _differences(own, [results[task] for task in _steady_states(variant.law or REFERENCE)])
    claimed = [end for end in (results[task] for task in _periods(variant)) if not end.reason]
    distances = [end.series["distance"][0] for end in claimed if end.status is ResultStatus.FINISHED]
    return LawAgreement(variant, "", deviation, error, stuck, np.array(distances), allowed_distance(variant), both)


def _differences(own: Sequence[Result], others: Sequence[Result]) -> tuple[float, float, int]:
    """Give the largest differences of transmittance and stuck fraction, and how many points are certified in both."""
    pairs = [pair for pair in zip(own, others, strict=True) if all(result.converged for result in pair)]
    if not pairs:
        return np.nan, np.nan, 0
    levels = [abs(one.transmittance_db - other.transmittance_db) for one, other in pairs]
    stuck = [one.stuck_difference(other) for one, other in pairs]
    return float(max(levels)), float(max(stuck)), len(pairs)


LAW_COLUMNS: tuple[Column[LawAgreement], ...] = (
    Column("variant", lambda row: str(row.variant), "engine:formulation:preset"),
    Column("steps_by", lambda row: _stated(row.variant), "steps by"),
    Column("deviation_db", lambda row: row.deviation, "deviation [dB]", "{:.3g}"),
    Column("prediction_error_db", lambda row: row.error, "prediction error [dB]", "{:.1e}"),
    Column("stuck_fraction_error", lambda row: row.stuck_fraction, "of stuck fraction", "{:.2g}"),
    Column("period_largest", lambda row: _of(np.max, row.period), "period, largest [U0]", "{:.1e}"),
    Column("period_median", lambda row: _of(np.median, row.period), "median", "{:.1e}"),
    Column("period_bound", lambda row: row.bound, "allowed", "{:.0e}"),
    Column("period_points", lambda row: len(row.period) if not row.reason else None, "points"),
    Column("certified", lambda row: f"{row.certified}/{len(POINTS)}"),
    Column("not_modelled", lambda row: row.reason, "not modelled"),
)

LAW_LEGEND = f"""\
How well does the law of each preset predict its engine? A *law* is a model of the steps of a preset. The chain is that
of Figure 3, at {len(POINTS)} points (friction {", ".join(map(str, FRICTION_RATIOS))} × η_r
{", ".join(map(str, FREQUENCY_RATIOS))}), with 400 steps a period.

| column | what it is |
|---|---|
| *deviation* | largest difference of the transmittance from the reference's at equal step, over certified points |
| *prediction error* | the same from the law's steady state; from the reference's if the preset takes the same step |
| *of stuck fraction* | the same for the stuck fraction |
| *period* | distance of engine and law after one period from the same state: largest, median, and allowed |
| *points* | points at which the law claims to hold |
| *certified* | points that are certified in both engine and law |
| *not modelled* | why no law predicts the steps |
"""


def _stated(variant: Variant) -> str:
    """Name what a variant says that it steps by."""
    if variant.preset.shares_scheme:
        return "the reference's scheme"
    return "a law" if variant.law is not None else "neither"


def _of(reduce: Callable[[FloatArray], Any], values: FloatArray) -> float:
    """Give the largest or the median value; NaN without any."""
    return float(reduce(values)) if values.size else np.nan


def law_document(rows: Sequence[LawAgreement], command: str) -> str:
    """Give the table as a document, with how it was made."""
    lines = ["# Laws and engines", "", LAW_LEGEND, f"Made by `{command}`.", ""]
    lines += markdown_lines(text_table(LAW_COLUMNS, rows))
    versions = versions_of(row.variant.engine for row in rows)
    return "\n".join([*lines, "", f"Versions: {versions}; Python {platform.python_version()}.", ""])
