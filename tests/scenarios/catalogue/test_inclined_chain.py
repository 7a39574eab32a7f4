"""A chain whose normal forces depend on its motion: engines that take part, and those that are wrong."""

import dataclasses

import pytest

from engines.interface.variant import Variant
from scenarios.catalogue.transient import inclined_chain
from scenarios.catalogue.transient.inclined_chain import RESPONSE, SLIPS, STEPS_PER_PERIOD, InclinedChainScenario
from scenarios.runs.transient import run_transients
from scenarios.verdicts.finding import Verdict
from scenarios.verdicts.steady_case import REFERENCE
from tests.installed import each_engine
from tests.scenarios.in_process import deviating, findings, incline_otherwise, press_harder

ALL_CASES, THREE_PERIODS = InclinedChainScenario.cases, 3 * STEPS_PER_PERIOD
SCENARIO, MUJOCO = InclinedChainScenario(), Variant("mujoco", "contact")


@pytest.fixture(autouse=True)
def short_slide(monkeypatch: pytest.MonkeyPatch) -> None:
    """Half a period of the case that slides, and a baseline that is cheaper."""
    monkeypatch.setattr(InclinedChainScenario, "cases", ALL_CASES[:1])
    monkeypatch.setattr(inclined_chain, "PERIODS", 1)
    monkeypatch.setattr(inclined_chain, "INCLINED_REFINEMENT", 2)


@pytest.mark.parametrize("name", each_engine(["mujoco", "dart"]))
def test_engines_that_solve_normal_and_tangential_direction_together_agree(name) -> None:
    assert not deviating(findings(SCENARIO, Variant(name, "contact"), REFERENCE))


@pytest.mark.needs("ode")
def test_ode_bounds_friction_by_a_normal_force_that_knows_no_friction() -> None:
    judged = deviating(findings(SCENARIO, Variant("ode", "contact"), laws=True))
    assert {finding.metric for finding in judged} == {RESPONSE, SLIPS}
    assert all(finding.modelled for finding in judged)


@pytest.mark.needs("ode")
def test_ode_pressed_a_hundredth_harder_is_not_as_its_law_predicts(monkeypatch) -> None:
    press_harder(monkeypatch, Variant("ode", "contact"), 1.01)
    judged = deviating(findings(SCENARIO, Variant("ode", "contact"), laws=True))
    assert judged
    assert not any(finding.modelled for finding in judged)


@pytest.mark.parametrize("factor", [-1.0, 0.0, 0.9], ids=["wrong sign", "none", "a tenth too small"])
def test_another_inclination_moves_otherwise(factor, monkeypatch) -> None:
    incline_otherwise(monkeypatch, factor)
    assert {finding.metric for finding in deviating(findings(SCENARIO, MUJOCO))} >= {SLIPS}


@pytest.mark.parametrize(
    ("title", "stuck", "opened", "landings"),
    [
        ("sliding", (0.3, 0.5), (0.0, 0.0), (0, 0)),
        ("sliding and sticking", (0.6, 0.75), (0.0, 0.0), (0, 0)),
        ("sticking", (1.0, 1.0), (0.0, 0.0), (0, 0)),
        ("lift-off and landing", (0.3, 0.45), (0.4, 0.6), (20, 100)),
    ],
    ids=lambda value: value if isinstance(value, str) else "",
)
def test_every_case_is_of_the_contacts_that_it_is_named_after(title, stuck, opened, landings) -> None:
    """The first periods are at rest at the far end of the chain: that is most of the sticking of what slides."""
    case = next(case for case in ALL_CASES if case.title == title)
    (result,) = run_transients([dataclasses.replace(case.task(REFERENCE), steps=THREE_PERIODS)])
    for name, (least, most) in {"stuck": stuck, "open": opened, "landings": landings}.items():
        assert least <= result.series[name][0] <= most, (name, result.series[name])


def test_engines_that_cannot_incline_their_contacts_say_so() -> None:
    judged = findings(SCENARIO, Variant("pybullet", "contact"), Variant("mujoco"))
    assert {finding.comparison.verdict for finding in judged} == {Verdict.BLOCKED}
    assert all("cannot incline its contacts" in finding.comparison.reason for finding in judged)
