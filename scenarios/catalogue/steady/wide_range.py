"""Steady states all over the ranges that a user may ask for."""

from multibody_xval.engines.shared.wide_range import DESIGN, RangePoint
from multibody_xval.scenarios.catalogue.steady.base import SteadyScenario
from multibody_xval.scenarios.runs.parameters import ChainRatios
from multibody_xval.scenarios.verdicts.steady_case import SteadyCase


def _case(point: RangePoint) -> SteadyCase:
    ratios = point._asdict()
    friction, frequency, steps = (ratios.pop(name) for name in ("friction_ratio", "frequency_ratio", "steps"))
    return SteadyCase(
        label=f"μ {point.friction_coefficient:g}, friction {friction:g}, η_r {frequency:g}, ζ {point.damping_ratio:g}",
        friction_ratio=friction,
        frequency_ratio=frequency,
        ratios=ChainRatios(**ratios),
        steps=steps,
    )


class WideRange(SteadyScenario):
    """Other coefficients of friction, dashpots, frequencies, cells and time steps than figure 3 has."""

    name = "wide-range"
    source = "a design of few chains, every parameter at the ends of its range and between them"
    cases = tuple(map(_case, DESIGN))

    def parameters(self) -> list[str]:
        """Give what the names of the cases leave out; see `Scenario.parameters`."""
        return [
            f"{case.label}: ζ of resonators {case.ratios.inner_damping_ratio}, mass ratio {case.ratios.mass_ratio}, "
            f"stiffness ratio {case.ratios.stiffness_ratio}, cells {case.ratios.cells}, steps a period {case.steps}"
            for case in self.cases
        ]
