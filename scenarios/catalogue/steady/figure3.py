"""Figure 3 of the paper: transmittance of the seven cells at points of the figure; `run figure3` has all of it."""

from multibody_xval.scenarios.catalogue.steady.base import SteadyScenario, point_case

HALF_WIDTH = 0.004
"""Distance in η_r from an edge of the two points whose transmittance is compared, on its flanks."""

LOWER_EDGES = {0.3: 0.637, 1.0: 0.999}
"""Friction ratios of the widest band and of cells that nearly lock; its lower edges, to three digits."""


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
