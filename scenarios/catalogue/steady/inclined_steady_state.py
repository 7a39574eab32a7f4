"""Steady states of seven cells whose contacts are inclined to the row, so that normal forces depend on the motion."""

import math
from collections.abc import Sequence
from typing import ClassVar

from reference_lcp.chain.linear_response import stuck_response
from scenarios.catalogue.steady.base import SteadyScenario, response_findings
from scenarios.catalogue.steady.linear_limits import linear_expected
from scenarios.catalogue.steady.long_chain import expected_of
from scenarios.runs.parameters import Modulation
from scenarios.runs.result import Result
from scenarios.runs.task import SteadyStateTask
from scenarios.verdicts.finding import PHASE, TRANSMITTANCE, Finding
from scenarios.verdicts.steady_case import REFERENCE, Evidence, Expected, SteadyCase

BASELINE = (4, 8, 16)
"""Steps of the reference that is compared with, over the fewest: the finest is judged, and three give its error bar."""


def _case(title: str, friction_ratio: float, frequency_ratio: float, degrees: float, modulation: float) -> SteadyCase:
    return SteadyCase(
        label=f"{title}, {degrees:g}°",
        friction_ratio=friction_ratio,
        frequency_ratio=frequency_ratio,
        inclination=math.radians(degrees),
        modulation=Modulation(modulation=modulation, multiple=2),
    )


STUCK = _case("stuck", 2.0, 0.6, 12.0, 0.0)


class InclinedSteadyState(SteadyScenario):
    """Contacts that slide, stick, and part, where one steady state is certified and attracts.

    Friction is not monotone there: a chain may have several steady states, and one that is certified may repel.
    """

    name = "inclined-steady-state"
    source = "Equation (7) of Sethi, Banerjee and Manna, with a coupling of normal and tangential direction, G_NT."
    metrics = (TRANSMITTANCE, PHASE)
    cases: ClassVar[tuple[SteadyCase, ...]] = (
        _case("sliding", 0.1, 0.7, 12.0, 0.0),
        _case("sliding and sticking", 0.3, 0.7, 12.0, 0.0),
        _case("sliding and sticking", 0.3, 0.7, 25.0, 0.0),
        _case("sliding and sticking, modulated", 0.3, 0.9, -12.0, 0.5),
        STUCK,
        _case("lift-off by the motion alone", 0.1, 0.7, 25.0, 0.0),
        _case("lift-off and landing", 0.3, 0.7, 12.0, 1.5),
    )

    def parameters(self) -> list[str]:
        """Give friction, frequency and preload of the cases; see `Scenario.parameters`."""
        return [
            f"{case.label}: μλ_N/(k_c U0) = {case.friction_ratio:g}, η_r = {case.frequency_ratio:g}, N = N0 (1 + "
            f"{case.modulation.modulation:g} sin 2ωt)"
            for case in self.cases
            if case.modulation is not None
        ]

    def expected_by(self, case: SteadyCase) -> list[SteadyStateTask]:
        """Give the tasks of the reference with finer steps; none where the chain is linear."""
        return [] if case is STUCK else [case.task(REFERENCE, refinement) for refinement in BASELINE]

    def expected(self, case: SteadyCase, results: Sequence[Result]) -> Expected:
        """Give the reference with finer steps and its error bar; the closed form where the chain is linear."""
        return linear_expected(case, stuck_response) if case is STUCK else expected_of(results)

    def findings(self, evidence: Evidence) -> list[Finding]:
        """Judge transmittance and phase; a step of an engine is nowhere that of equation (7) to round-off."""
        findings = response_findings(evidence)
        return findings if evidence.certified else [finding.uncertified() for finding in findings]
