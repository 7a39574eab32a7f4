"""Curves of a compared sweep as figures draw them: the reference, and differences from the converged one."""

import math

import numpy as np

from engines.interface.variant import Variant
from reference_lcp.validation import FloatArray
from scenarios.sweeps.compared import ComparedSweep
from scenarios.sweeps.sweep import Case, baseline_of
from scenarios.verdicts.finding import FLOOR_DB
from scenarios.verdicts.pointwise import CONVERGED
from scenarios.verdicts.steady_case import REFERENCE


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
