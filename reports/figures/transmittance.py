"""Figure 3 of the paper, by the reference; then by every engine, with its differences from the converged reference."""

import math

import numpy as np

from engines.interface.tolerances import CONVERGED_TOLERANCE_DB, SCHEME_TOLERANCE_DB
from engines.interface.variant import Variant
from reference_lcp.validation import FloatArray
from reports.data.findings import differences, reference_line
from reports.figures.figure import Axis, Figure, Mark, Panel, Rule, Series, difference_axis
from reports.figures.style import DASHED, DOTTED, RULE, Style, compared_variants, curve_style, style_of
from reports.formatting import ratio
from scenarios.studies.attenuation_band import Edge
from scenarios.studies.figure3 import CONVERGED, REFERENCE, Figure3Result, Point

FREQUENCY_LABEL = "frequency ratio η_r = ω/ω_r [-]"

LOWEST_DB = -80.0
"""Lowest transmittance that is drawn: beyond, the motion is less than the ten-thousandth part of the base's."""

LINEAR_DB = SCHEME_TOLERANCE_DB / 2
"""Differences below are drawn to scale, larger ones by their logarithm: the tightest tolerance is told from zero."""

DIFFERENCE_TICKS = (SCHEME_TOLERANCE_DB, CONVERGED_TOLERANCE_DB, 2.0, 10.0, 50.0)

CROWD = 2000
"""Markers beyond which a printed panel holds them as a picture of pixels: its file stays small."""

TOLERANCE = Style("#666666", dash=DASHED, width=0.6)
EDGE = Style("#555555", dash=DOTTED, width=0.7)
STEP_ERROR = Style("#8c8c8c", size=2.5, width=2.5)


def overview(result: Figure3Result) -> Figure:
    """Draw the reference's curves of all friction ratios: the paper's Figure 3."""
    curves = [
        Series(
            *reference_line(result, friction), curve_style(place), ratio(friction),
            hover=f"friction {ratio(friction)}\nη_r %{{x}}\n%{{y:.2f}} dB",
        )
        for place, friction in enumerate(result.asked.friction_ratios)
    ]  # fmt: skip
    return Figure(
        "figure3",
        f"The reference at all friction ratios ({result.asked.steps_per_period} steps a period or more)",
        [Panel(_frequency_axis(result, FREQUENCY_LABEL), _transmittance_axis(result), [_threshold(result), *curves])],
        height=2.9,
        pixels=440,
        legend_columns=min(len(curves), 6),
        legend_title="friction ratio μλ̃_N [-]",
    )


def panel(result: Figure3Result, friction_ratio: float) -> Figure:
    """Draw one friction ratio: every variant over the reference, and below it their differences."""
    variants = compared_variants(result.asked)
    edges = _edges(result, friction_ratio)
    reference = Series(
        *reference_line(result, friction_ratio), Style("#000000"), REFERENCE.title, hover="η_r %{x}\n%{y:.3f} dB"
    )
    drawn = [variant for variant in variants if _points(result, variant, friction_ratio)]
    upper = [_variant(result, variant, friction_ratio) for variant in drawn]
    lower = [_difference(result, variant, friction_ratio) for variant in drawn]
    tolerances = [Rule("y", sign * CONVERGED_TOLERANCE_DB, TOLERANCE) for sign in (-1, 1)]
    error = _step_error(result, friction_ratio)
    limit = _largest_difference(result)
    return Figure(
        f"transmittance-{friction_ratio:g}",
        f"Friction ratio {ratio(friction_ratio)}",
        [
            Panel(
                _frequency_axis(result), _transmittance_axis(result),
                [*edges, _threshold(result), reference, *upper],
            ),
            Panel(
                _frequency_axis(result, FREQUENCY_LABEL),
                difference_axis("difference [dB]", LINEAR_DB, DIFFERENCE_TICKS, limit),
                [*edges, Rule("y", 0.0, RULE), *tolerances, error, *lower],
            ),
        ],
        height=3.6 + 0.13 * math.ceil((len(variants) + 2) / 2),
        pixels=540,
        heights=(3, 2),
        dense=sum(len(result.curve(variant, friction_ratio)) for variant in variants) > CROWD,
    )  # fmt: skip


def _threshold(result: Figure3Result) -> Mark:
    return Rule("y", result.asked.band.threshold_db, RULE)


def _edges(result: Figure3Result, friction_ratio: float) -> list[Mark]:
    found = [result.edge(CONVERGED, friction_ratio, edge).frequency_ratio for edge in Edge]
    return [Rule("x", eta, EDGE) for eta in found if eta is not None and not math.isnan(eta)]


def _variant(result: Figure3Result, variant: Variant, friction_ratio: float) -> Series:
    """Mark the steady states of one variant, with their verdicts."""
    points = _points(result, variant, friction_ratio)
    return Series(
        [point.frequency_ratio for point in points], [point.answer.transmittance_db for point in points],
        style_of(result.asked, variant), variant.title, "markers", "η_r %{x}\n%{y:.4f} dB, %{text}",
        [str(point.comparison.verdict) for point in points],
    )  # fmt: skip


def _difference(result: Figure3Result, variant: Variant, friction_ratio: float) -> Series:
    """Mark the differences of one variant."""
    return Series(
        *differences(result, variant, friction_ratio), style_of(result.asked, variant), variant.title, "markers",
        "η_r %{x}\ndifference %{y:+.5f} dB",
    )  # fmt: skip


def _step_error(result: Figure3Result, friction_ratio: float) -> Series:
    """Mark what the scheme itself errs by at the common time step."""
    return Series(
        *differences(result, REFERENCE, friction_ratio), STEP_ERROR, "scheme's own step error",
        hover="η_r %{x}\ndifference %{y:+.5f} dB", draw="lines+markers",
    )  # fmt: skip


def _points(result: Figure3Result, variant: Variant, friction_ratio: float) -> list[Point]:
    return [point for point in result.curve(variant, friction_ratio) if point.answer.converged]


def _frequency_axis(result: Figure3Result, label: str = "") -> Axis:
    return Axis(label, (result.asked.frequency_ratios[0] - 0.03, result.asked.frequency_ratios[-1] + 0.03))


def _transmittance_axis(result: Figure3Result) -> Axis:
    """Cut the axis off where nothing is to be seen, the same for all panels."""
    every = np.concatenate([reference_line(result, friction)[1] for friction in result.asked.friction_ratios])
    known = np.append(every[np.isfinite(every)], result.asked.band.threshold_db)
    return Axis("transmittance [dB]", (max(LOWEST_DB, float(known.min()) - 5), float(known.max()) + 5))


def _largest_difference(result: Figure3Result) -> float:
    """Give the end of the axis of differences, the same for all panels [dB]."""
    found: list[FloatArray] = [
        differences(result, variant, friction)[1]
        for variant in (REFERENCE, *compared_variants(result.asked))
        for friction in result.asked.friction_ratios
    ]
    every = np.concatenate(found)
    return max(1.4 * CONVERGED_TOLERANCE_DB, 1.3 * float(np.max(np.abs(every[np.isfinite(every)]), initial=0.0)))
