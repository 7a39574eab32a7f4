"""Steady states of a chain with inclined contacts: engines that take part, and those that are wrong."""

import dataclasses

import pytest

from engines.interface.variant import Variant
from scenarios.catalogue.steady import inclined_steady_state
from scenarios.catalogue.steady.inclined_steady_state import InclinedSteadyState
from scenarios.runs.parameters import ChainRatios
from scenarios.verdicts.finding import TRANSMITTANCE, Verdict
from scenarios.verdicts.steady_case import REFERENCE
from tests.installed import each_variant
from tests.scenarios.in_process import deviating, findings, incline_otherwise

SCENARIO = InclinedSteadyState()
SLIDING = dataclasses.replace(InclinedSteadyState.cases[0], ratios=ChainRatios(cells=2))
MUJOCO, ODE = Variant("mujoco", "contact"), Variant("ode", "contact")


@pytest.fixture(autouse=True)
def few_steps(monkeypatch: pytest.MonkeyPatch) -> None:
    """The case that slides, of two cells, beside a baseline that is cheaper."""
    monkeypatch.setattr(InclinedSteadyState, "cases", (SLIDING,))
    monkeypatch.setattr(inclined_steady_state, "BASELINE", (1, 2, 4))


@pytest.mark.slow
@pytest.mark.parametrize("variant", each_variant([MUJOCO, Variant("dart", "contact", "sphere")]))
def test_engines_that_solve_normal_and_tangential_direction_together_agree(variant) -> None:
    assert not deviating(findings(SCENARIO, variant, REFERENCE))


@pytest.mark.slow
@pytest.mark.needs("ode")
def test_ode_slides_under_a_normal_force_that_knows_no_friction() -> None:
    judged = findings(SCENARIO, ODE)
    (transmittance,) = (finding for finding in deviating(judged) if finding.metric is TRANSMITTANCE)
    assert -0.1 < transmittance.comparison.difference < -0.05


@pytest.mark.slow
@pytest.mark.parametrize("factor", [0.0, 0.9], ids=["none", "a tenth too small"])
def test_another_inclination_has_another_transmittance(factor, monkeypatch) -> None:
    """But for that of the other sign: the mirrored motion has the same."""
    incline_otherwise(monkeypatch, factor)
    assert TRANSMITTANCE in {finding.metric for finding in deviating(findings(SCENARIO, MUJOCO))}


@pytest.mark.needs("ode")
def test_stuck_chain_is_the_linear_one(monkeypatch) -> None:
    short = dataclasses.replace(inclined_steady_state.STUCK, ratios=ChainRatios(cells=2))
    monkeypatch.setattr(InclinedSteadyState, "cases", (short,))
    monkeypatch.setattr(inclined_steady_state, "STUCK", short)
    judged = findings(SCENARIO, REFERENCE, ODE)
    assert not deviating(judged)
    assert {abs(finding.expected - 3.854) < 1e-3 for finding in judged if finding.metric is TRANSMITTANCE} == {True}


def test_engines_that_cannot_incline_their_contacts_say_so() -> None:
    judged = findings(SCENARIO, Variant("pybullet", "contact"), Variant("mujoco"))
    assert {finding.comparison.verdict for finding in judged} == {Verdict.BLOCKED}
    assert all("cannot incline its contacts" in finding.comparison.reason for finding in judged)
