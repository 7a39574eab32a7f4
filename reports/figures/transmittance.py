"""Figure 3 of the paper, by the reference and by every engine with its differences; and over friction and frequency."""

import math

import numpy as np

from engines.interface.tolerances import CONVERGED_TOLERANCE_DB, SCHEME_TOLERANCE_DB
from engines.interface.variant import Variant
from reference_lcp.validation import FloatArray
from reports.data.descriptions import file_name, named_axes
from reports.drawing.figure import Axis, Figure, HeatMap, Mark, Panel, Rule, Series, difference_axis
from reports.drawing.style import DASHED, DOTTED, RULE, SOLID, Style, compared_variants, curve_style, style_of
from scenarios.studies.friction_map import FrictionMap
from scenarios.sweeps.compared import ComparedSweep
from scenarios.sweeps.point import Point
from scenarios.sweeps.sweep import Case, baseline_of
from scenarios.verdicts.finding import FLOOR_DB
from scenarios.verdicts.steady_case import CONVERGED, REFERENCE


def baseline_curve(result: ComparedSweep, case: Case) -> dict[float, float]:
    """Transmittance [dB] by η_r of the converged reference, or of the reference where that takes no part."""
    reference = baseline_of(result.sweep.variants)
    curve = [] if reference is None else result.curve(reference, case)
    return {point.frequency_ratio: point.result.transmittance_db for point in curve if point.result.converged}


def differences(result: ComparedSweep, variant: Variant, case: Case) -> tuple[FloatArray, FloatArray]:
    """η_r, and transmittance less the converged reference's [dB]; NaN where that is below `FLOOR_DB` or unknown."""
    baseline = baseline_curve(result, case)
    pairs = []
    for point in result.curve(variant, case):
        known = point.result.converged and baseline.get(point.frequency_ratio, -math.inf) > FLOOR_DB
        difference = point.result.transmittance_db - baseline[point.frequency_ratio] if known else math.nan
        pairs.append((point.frequency_ratio, difference))
    etas, all_differences = np.array(pairs).reshape(-1, 2).T
    return etas, all_differences


def reference_line(result: ComparedSweep, case: Case) -> tuple[FloatArray, FloatArray]:
    """η_r and transmittance [dB] of the reference: its dense curve, and the grid with the resonances in it."""
    eta, curve = result.dense_reference.get(case, (np.empty(0), np.empty(0)))
    known = dict(zip(eta.tolist(), curve.tolist(), strict=True))
    for point in result.curve(REFERENCE, case):
        known[point.frequency_ratio] = point.result.transmittance_db if point.result.converged else math.nan
    ascending = sorted(known.items())
    return np.array([eta for eta, _ in ascending]), np.array([value for _, value in ascending])


def converged_edges(result: ComparedSweep, case: Case) -> list[float]:
    """η_r of the edges of the converged reference that are known."""
    etas = [edge.frequency_ratio for edge in result.edges if (edge.variant, edge.case) == (CONVERGED, case)]
    return [eta for eta in etas if eta is not None and not math.isnan(eta)]


FREQUENCY_LABEL = "frequency ratio η_r = ω/ω_r [-]"

LOWEST_DB = -80.0
"""Lowest transmittance that is drawn: beyond, the motion is less than the ten-thousandth part of the base's."""

LINEAR_DB = SCHEME_TOLERANCE_DB / 2
"""Differences below are drawn to scale, larger ones by their logarithm: the tightest tolerance is visible."""

DIFFERENCE_TICKS = (SCHEME_TOLERANCE_DB, CONVERGED_TOLERANCE_DB, 2.0, 10.0, 50.0)

MOST_VECTOR_MARKERS = 2000
"""Markers beyond which a printed panel holds them as a picture of pixels: its file stays small."""

TOLERANCE_LINE = Style("#666666", dash=DASHED, width=0.6)
EDGE_LINE = Style("#555555", dash=DOTTED, width=0.7)
STEP_ERROR = Style("#8c8c8c", size=2.5, width=2.5)


def overview(result: ComparedSweep) -> Figure:
    """Draw the reference's curves of all cases: over friction alone, the paper's Figure 3."""
    curves = [
        Series(
            *reference_line(result, case), curve_style(number), case.numbers,
            hover="%{y:.2f} dB",
        )
        for number, case in enumerate(result.cases)
    ]  # fmt: skip
    return Figure(
        "figure3",
        f"The reference at all {named_axes(result.sweep)} ({result.sweep.fewest_steps} steps a period or more)",
        [Panel(_frequency_axis(result, FREQUENCY_LABEL), _transmittance_axis(result), [_threshold(result), *curves])],
        height=2.9,
        pixels=440,
        legend_columns=min(len(curves), 6),
        together=True,
        legend_title=named_axes(result.sweep, plural=False).replace("friction ratio", "friction ratio μλ̃_N [-]"),
    )


def panel(result: ComparedSweep, case: Case) -> Figure:
    """Draw one case: every variant over the reference, and below it their differences."""
    variants = compared_variants(result.sweep)
    edges = [Rule("x", eta, EDGE_LINE) for eta in converged_edges(result, case)]
    reference = Series(*reference_line(result, case), Style("#000000"), REFERENCE.title, hover="%{y:.3f} dB")
    drawn = [variant for variant in variants if _points(result, variant, case)]
    upper = [_variant(result, variant, case) for variant in drawn]
    lower = [_difference(result, variant, case) for variant in drawn]
    tolerances = [Rule("y", sign * CONVERGED_TOLERANCE_DB, TOLERANCE_LINE) for sign in (-1, 1)]
    error = _step_error(result, case)
    limit = _largest_difference(result)
    return Figure(
        f"transmittance-{file_name((case,))}",
        case.title.capitalize(),
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
        together=True,
        dense=sum(len(result.curve(variant, case)) for variant in variants) > MOST_VECTOR_MARKERS,
    )  # fmt: skip


def _threshold(result: ComparedSweep) -> Mark:
    return Rule("y", result.sweep.band.threshold_db, RULE)


def _variant(result: ComparedSweep, variant: Variant, case: Case) -> Series:
    """Mark the steady states of one variant, with their verdicts."""
    points = _points(result, variant, case)
    return Series(
        [point.frequency_ratio for point in points], [point.result.transmittance_db for point in points],
        style_of(result.sweep, variant), variant.title, "markers", "%{y:.4f} dB, %{text}",
        [str(point.comparison.verdict) for point in points],
    )  # fmt: skip


def _difference(result: ComparedSweep, variant: Variant, case: Case) -> Series:
    return Series(
        *differences(result, variant, case), style_of(result.sweep, variant), variant.title, "markers",
        "difference %{y:+.5f} dB",
    )  # fmt: skip


def _step_error(result: ComparedSweep, case: Case) -> Series:
    """Mark what the scheme itself errs by at the common time step."""
    return Series(
        *differences(result, REFERENCE, case), STEP_ERROR, "scheme's own step error",
        hover="difference %{y:+.5f} dB", draw="lines+markers",
    )  # fmt: skip


def _points(result: ComparedSweep, variant: Variant, case: Case) -> list[Point]:
    return [point for point in result.curve(variant, case) if point.result.converged]


def _frequency_axis(result: ComparedSweep, label: str = "") -> Axis:
    return Axis(label, (result.sweep.frequency_ratios[0] - 0.03, result.sweep.frequency_ratios[-1] + 0.03))


def _transmittance_axis(result: ComparedSweep) -> Axis:
    """Give the axis of transmittance, from the lowest to the highest value, the same for all panels."""
    every = np.concatenate([reference_line(result, case)[1] for case in result.cases])
    known = np.append(every[np.isfinite(every)], result.sweep.band.threshold_db)
    return Axis("transmittance [dB]", (max(LOWEST_DB, float(known.min()) - 5), float(known.max()) + 5))


def _largest_difference(result: ComparedSweep) -> float:
    """Give the end of the axis of differences, the same for all panels [dB]."""
    curves: list[FloatArray] = [
        differences(result, variant, case)[1]
        for variant in (REFERENCE, *compared_variants(result.sweep))
        for case in result.cases
    ]
    every = np.concatenate(curves)
    return max(1.4 * CONVERGED_TOLERANCE_DB, 1.3 * float(np.max(np.abs(every[np.isfinite(every)]), initial=0.0)))


MAP_LOWEST_DB, MAP_HIGHEST_DB = -60.0, 20.0
"""Range of the colours: beyond, curves show more."""


def friction_map_figure(data: FrictionMap) -> Figure:
    """Draw the map, with both edges of the band over friction."""
    colours = HeatMap(
        data.frequency_ratios, data.friction_ratios, data.transmittance_db, MAP_LOWEST_DB, MAP_HIGHEST_DB,
        "transmittance [dB]", "friction %{y}\nη_r %{x}\n%{z} dB",
    )  # fmt: skip
    first, last = data.frequency_ratios[[0, -1]]
    panel = Panel(
        Axis(FREQUENCY_LABEL, (first, last), grid=False),
        Axis("friction ratio μλ̃_N [-]", grid=False),
        [
            colours,
            *_edge(data, "lower edge", data.lower, SOLID),
            *_edge(data, "upper edge", data.upper, DASHED),
        ],
    )
    return Figure(
        "friction-map",
        "Transmittance of the reference over friction and frequency [dB]; lines: lower (solid) and upper (dashed) "
        "edge of the attenuation band",
        [panel],
        height=2.9,
        pixels=430,
        legend_columns=0,
    )


def _edge(data: FrictionMap, name: str, edge: FloatArray, dash: tuple[float, ...]) -> list[Series]:
    """Draw an edge in white on black, to be seen on every colour."""
    friction = data.friction_ratios
    return [
        Series(edge, friction, Style("#000000", size=3.8, width=2.6), draw="lines+markers"),
        Series(edge, friction, Style("#ffffff", size=2.6, dash=dash, width=1.4), name, "lines+markers",
               "friction %{y}\nη_r %{x:.3f}"),
    ]  # fmt: skip
