"""Steady states of chains under a harmonic drive."""

from multibody_xval.scenarios.catalogue.scenario import STICK_SLIP, TRANSMITTANCE, Scenario, steady_steps
from multibody_xval.scenarios.model import Case


def at_points(points: tuple[tuple[float, float], ...], cells: int = 1) -> dict[str, Case]:
    """Give the cases of friction and frequency ratios, by both."""
    return {
        f"friction {friction:g}, η_r {eta:g}": Case(friction_ratio=friction, frequency_ratio=eta, cells=cells)
        for friction, eta in points
    }


UNIT_CELL = Scenario(
    name="unit-cell",
    question="Does a single cell respond as it should, and stick and slip when it should?",
    expects="the proven steady state, or the event-driven motion; of presets that share the scheme the reference at "
    "equal steps",
    source="Sethi, Banerjee, Manna, figure 2 with one cell, mass and stiffness ratio 1, ζ = 0.01",
    cases=at_points(((0.6, 0.9), (0.1, 0.45), (0.6, 1.6), (0.3, 0.9))),
    quantities=(TRANSMITTANCE, *STICK_SLIP),
    steps=steady_steps,
)
"""It sticks briefly, about half of the time, for most of it, and never."""

SCENARIOS = (UNIT_CELL,)
