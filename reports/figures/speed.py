"""Work and precision: the error of engines over the time of a simulated second."""

import math
from collections.abc import Iterable, Sequence
from typing import Any

import matplotlib as mpl
from matplotlib.axes import Axes

from multibody_xval.engines.interface.variant import Variant
from multibody_xval.reports.figures.drawing import Drawing, legend, small_multiples
from multibody_xval.reports.figures.style import GREY, PRINT_STYLE, by_panel, preset_style
from multibody_xval.scenarios.studies.work_precision import StepPoint
from multibody_xval.scenarios.verdicts.steady_case import REFERENCE

SMALLEST_DB = 1e-5
"""Errors below are drawn here: less than the steady states of engines repeat to."""

ERROR_LABEL = "largest error at six points [dB]"

Curves = dict[Variant, list[StepPoint]]


def curves(points: Iterable[StepPoint]) -> Curves:
    """Give the points of each variant whose error is over all six points, by number of steps.

    An error over fewer points is not comparable, and a curve through it shows no convergence.
    """
    complete: Curves = {}
    for point in points:
        if point.is_complete and not math.isnan(point.error_db):
            complete.setdefault(point.variant, []).append(point)
    return complete


@mpl.rc_context(PRINT_STYLE)
def speed_figure(drawn: Curves) -> Drawing:
    """Draw errors over the time of a simulated second: a panel an engine and formulation, the reference in grey."""
    groups = by_panel(variant for variant in drawn if variant.engine != REFERENCE.engine) or {REFERENCE.title: []}
    known = [_cost(point) for own in drawn.values() for point in own if math.isfinite(_cost(point))] or [1.0]
    errors = [error for own in drawn.values() for error in _shown(own)]
    label = "time of a simulated second, seven cells [ms]"
    canvas, panels = small_multiples(list(groups), 1.2, x_label=label, y_labels=[ERROR_LABEL])
    for (axes,), variants in zip(panels, groups.values(), strict=True):
        for variant in (own for own in drawn if own.engine == REFERENCE.engine):
            other = {} if variant == REFERENCE else {"label": variant.title, "linestyle": "--"}
            _draw_costs(axes, drawn[variant], {**GREY, **other})
        for variant in variants:
            _draw_costs(axes, drawn[variant], preset_style(variant))
        axes.set(xscale="log", yscale="log", ylim=(0.5 * min(errors), 2 * max(errors)))
        axes.set_xlim(0.7 * min(known), 1.4 * max(known))
    legend(canvas)
    return Drawing("work-precision", "Work and precision: error over the time of a simulated second", canvas)


def _cost(point: StepPoint) -> float:
    return 1e3 * point.simulated_second


def _draw_costs(axes: Axes, points: Sequence[StepPoint], style: Any) -> None:
    axes.plot([_cost(point) for point in points], _shown(points), **style)


def _shown(points: Iterable[StepPoint]) -> list[float]:
    return [max(point.error_db, SMALLEST_DB) for point in points]
