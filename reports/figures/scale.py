"""The error of presets over the frequency of the drive."""

import math
from collections.abc import Sequence

import matplotlib as mpl

from reports.figures.drawing import Drawing, legend, set_ticks, small_multiples
from reports.figures.errors import SMALLEST_DB
from reports.figures.style import PRINT_STYLE, by_panel, preset_style
from scenarios.studies.scale import ScalePoint


@mpl.rc_context(PRINT_STYLE)
def scale_figure(points: Sequence[ScalePoint]) -> Drawing:
    """Draw a panel an engine and formulation: the error of its presets over the frequency of the drive."""
    groups = by_panel(dict.fromkeys(point.variant for point in points))
    known = [point.error_db for point in points if not math.isnan(point.error_db)]
    canvas, panels = small_multiples(
        list(groups), 1.3, x_label="frequency of the drive [Hz]", y_labels=["error to the exact motion [dB]"]
    )
    for (axes,), variants in zip(panels, groups.values(), strict=True):
        for variant in variants:
            own = [point for point in points if point.variant == variant]
            axes.plot([point.hertz for point in own], [point.error_db for point in own], **preset_style(variant))
        axes.set(xscale="log", yscale="log", ylim=(0.5 * max(min(known), SMALLEST_DB), 2 * max(known)))
        set_ticks(axes, "x", {point.hertz: f"{point.hertz:.2g}" for point in points})
    legend(canvas)
    caption = (
        "Error of transmittance to the exact motion over the frequency of the drive, of one chain with softer and "
        "stiffer springs: all ratios are the same"
    )
    return Drawing("scale", caption, canvas)
