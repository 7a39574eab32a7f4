"""Figure 3 of the paper: transmittance of the seven cells, and where the attenuation band begins."""

from collections.abc import Sequence

from multibody_xval.engines.interface.variant import Variant
from multibody_xval.scenarios.catalogue.steady.base import (
    SAME_STEP,
    SteadyScenario,
    point_case,
    results_of,
    skip_reason,
)
from multibody_xval.scenarios.runs.evaluator import Evaluator
from multibody_xval.scenarios.studies.figure3 import figure3
from multibody_xval.scenarios.sweeps.attenuation_band import Edge
from multibody_xval.scenarios.sweeps.edges import BAND_EDGE, BandEdge, band_edges
from multibody_xval.scenarios.sweeps.sweep import Case
from multibody_xval.scenarios.verdicts.finding import TRANSMITTANCE, Finding
from multibody_xval.scenarios.verdicts.steady_case import case_tasks

HALF_WIDTH = 0.004
"""Distance in η_r from an edge of the two points whose transmittance is compared, on its flanks."""

LOWER_EDGES = {0.3: 0.637, 1.0: 0.999}
"""Friction ratios of the widest band and of cells that nearly lock; its lower edges, to three digits."""

SIDES = (-0.05, -0.025, -HALF_WIDTH, HALF_WIDTH, 0.025, 0.05)
"""Distances in η_r from these edges of the points between which the edge of a curve is looked for."""

DEEP = {0.3: 1.1, 1.0: 1.3}
"""Frequency ratios within the band, where the attenuation is deep."""


class Figure3Points(SteadyScenario):
    """The canonical chain at points of figure 3."""

    name = "figure3"
    source = "Sethi, Banerjee, Manna, figure 3: mass and stiffness ratio 1, ζ = 0.01, seven cells"
    cases = (
        *(
            point_case(f, round(edge + side, 6))
            for f, edge in LOWER_EDGES.items()
            for side in (-HALF_WIDTH, HALF_WIDTH)
        ),
        point_case(0.6, 0.9),
        point_case(0.1, 0.6),
    )
    metrics = (TRANSMITTANCE, SAME_STEP, BAND_EDGE)

    def run(self, variants: Sequence[Variant], evaluator: Evaluator) -> list[Finding]:
        """Judge transmittance point by point, then the edges; those of variants that are too slow are skipped."""
        findings = super().run(variants, evaluator)
        tasks = [task for variant in variants for task in case_tasks(variant, self.cases[0])]
        results = results_of(tasks, evaluator)
        skipped = {variant: skip_reason(variant, self.cases[:1], 1.0, results) for variant in variants}
        edges = lower_edges([variant for variant in variants if skipped[variant] is None], evaluator)
        judged = []
        for variant in variants:
            judged += [finding for finding in findings if finding.variant == variant]
            reason = skipped[variant]
            if reason is None:
                judged += [edge.finding for edge in edges if edge.variant == variant]
            else:
                for friction in LOWER_EDGES:
                    judged += Finding.without_numbers(variant, edge_label(friction), [BAND_EDGE], reason)
        return judged


def edge_label(friction: float) -> str:
    """Name the lower edge at a friction ratio, as `BandEdge.finding` does."""
    return f"{Case.of(friction_ratio=friction)}, {Edge.LOWER} edge"


def lower_edges(variants: Sequence[Variant], evaluator: Evaluator) -> list[BandEdge]:
    """Give the lower edges of the attenuation band, of these variants, of the reference and of the converged one."""
    etas = {f: sorted([*(round(edge + side, 6) for side in SIDES), DEEP[f]]) for f, edge in LOWER_EDGES.items()}
    sweep = figure3(variants, tuple(LOWER_EDGES), sorted({eta for own in etas.values() for eta in own}))
    by_case = [(case, eta) for case in sweep.cases for eta in etas[case.friction_ratio]]
    places = [(variant, *place) for variant in sweep.variants for place in by_case]
    results = dict(zip(places, evaluator.evaluate([sweep.task(*place) for place in places]), strict=True))
    return [edge for edge in band_edges(sweep, results, evaluator) if edge.edge is Edge.LOWER]
