"""Cost of accuracy, and error over the number of steps: for every engine, formulation and preset."""

import math
from collections.abc import Callable, Iterable, Sequence

import numpy as np

from engines.interface.variant import Variant
from reference_lcp.accuracy.convergence import STICK_SLIP_POINTS
from reports.drawing.figure import Axis, Figure, Panel, Series
from reports.drawing.style import DOTTED, Style, style_of
from scenarios.studies.work_precision import StepPoint
from scenarios.sweeps.sweep import Sweep

SMALLEST_DB = 1e-5
"""Errors below are drawn here: less than the steady states of engines repeat to."""

MOST_VECTOR_POINTS = 40
"""Points beyond which the page has a still picture of pixels, a quarter of the drawing's size."""

ERROR_LABEL = "largest error at six points [dB]"

Curves = dict[Variant, list[StepPoint]]


def curves(points: Iterable[StepPoint]) -> Curves:
    """Give the points of each variant whose error is over all six points, by number of steps.

    An error over fewer points is not comparable, and a curve through it shows no convergence.
    """
    complete: Curves = {}
    for point in points:
        if point.certified == len(STICK_SLIP_POINTS) and not math.isnan(point.error_db):
            complete.setdefault(point.variant, []).append(point)
    return complete


def steps_of(drawn: Curves) -> list[int]:
    """Give the steps a period of all curves, ascending."""
    return sorted({point.steps_per_period for own in drawn.values() for point in own})


def work_precision_figure(sweep: Sweep, points: Sequence[StepPoint]) -> Figure:
    """Draw the error over the cost of a step and over the time to the steady state."""
    drawn = curves(points)
    steps = steps_of(drawn)
    return Figure(
        "work-precision",
        "Work and precision: error over the cost of a step, and over the time to a certified steady state; "
        f"points of one variant from {steps[0]} to {steps[-1]} steps a period are joined",
        [
            Panel(
                Axis("time of a step, seven cells [µs]", scale="log"), Axis(ERROR_LABEL, scale="log"),
                _series(sweep, drawn, lambda point: 1e6 * point.step_seconds),
            ),
            Panel(
                Axis("time to the steady state [s]", scale="log"), Axis(scale="log"),
                _series(sweep, drawn, lambda point: point.seconds),
            ),
        ],
        height=2.9 + 0.13 * (len(drawn) // 4),
        pixels=430,
        columns=2,
        legend_columns=4,
        wide=True,
        dense=_is_dense(drawn),
    )  # fmt: skip


def convergence_figure(sweep: Sweep, points: Sequence[StepPoint]) -> Figure:
    """Draw the error over the number of steps a period, with the slope of a first-order scheme."""
    drawn = curves(points)
    steps = steps_of(drawn)
    return Figure(
        "convergence",
        "Convergence in the time step",
        [
            Panel(
                Axis("steps a period [-]", scale="log", ticks={float(step): str(step) for step in steps}),
                Axis(ERROR_LABEL, scale="log"),
                [*_series(sweep, drawn, lambda point: point.steps_per_period), *_first_order(drawn)],
            )
        ],
        height=2.9 + 0.13 * (len(drawn) // 2),
        pixels=430,
        dense=_is_dense(drawn),
    )


def _is_dense(drawn: Curves) -> bool:
    return sum(map(len, drawn.values())) > MOST_VECTOR_POINTS


def _series(sweep: Sweep, drawn: Curves, cost: Callable[[StepPoint], float]) -> list[Series]:
    return [
        Series(
            [cost(point) for point in own], _shown(own), style_of(sweep, variant), variant.title, "lines+markers",
            "%{text} at %{x}",
            [f"{point.steps_per_period} steps a period\nerror {point.error_db:.4g} dB" for point in own],
        )
        for variant, own in drawn.items()
    ]  # fmt: skip


def _shown(points: Iterable[StepPoint]) -> list[float]:
    return [max(point.error_db, SMALLEST_DB) for point in points]


def _first_order(drawn: Curves) -> list[Series]:
    """Give a line of slope −1 through the middle of all errors at the fewest steps."""
    ends = [own[0] for own in drawn.values() if len(own) > 1]
    if not ends:
        return []
    first = min(point.steps_per_period for point in ends)
    last = max(own[-1].steps_per_period for own in drawn.values())
    start = float(np.median(_shown(point for point in ends if point.steps_per_period == first)))
    line = Style("#888888", dash=DOTTED, width=0.7)
    return [Series([first, last], [start, start * first / last], line, "first order")]
