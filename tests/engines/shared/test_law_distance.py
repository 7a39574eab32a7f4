"""What a distance from the law after every period leaves in the response: friction and dashpots take most away."""

import math
from dataclasses import replace
from types import SimpleNamespace

import pytest

from multibody_xval.engines.interface.registry import law_of
from multibody_xval.engines.interface.tolerances import CREEP, TRAJECTORY_TOLERANCE
from multibody_xval.engines.interface.variant import Variant
from multibody_xval.engines.shared.law_distance import allowed_distance, figure3_lanes, gain
from multibody_xval.scenarios.verdicts.finding import TRANSMITTANCE, Comparison, Finding, Verdict
from multibody_xval.scenarios.verdicts.prediction import PERIODS_OF_ERROR, LawPeriod, with_predictions

RAPIER = Variant("rapier", preset_name="default")


def test_pushes_after_every_period_do_not_add_up_to_those_of_a_whole_search() -> None:
    law = law_of(RAPIER.preset)
    assert law is not None
    for lane in figure3_lanes()[::6]:
        assert 1 <= gain(law, lane, 400, 1e-5) < PERIODS_OF_ERROR / 20


@pytest.mark.parametrize(
    ("measured", "verdict"), [(PERIODS_OF_ERROR, Verdict.INCONCLUSIVE), (4.0, Verdict.DISAGREE)], ids=["worst", "gain"]
)
def test_deviation_within_what_its_law_leaves_open_is_inconclusive(measured, verdict) -> None:
    model = RAPIER.law
    assert model is not None
    off = Finding(RAPIER, "case", TRANSMITTANCE, -10.0, -10.05, Comparison(Verdict.DISAGREE, "off", 0.05, 0.01))
    of_law = Finding(model, "case", TRANSMITTANCE, -10.0, -10.05, Comparison(Verdict.DISAGREE, "off", 0.05, 0.01))
    (judged,) = with_predictions([off], [of_law], {"case": LawPeriod(1e-5, 6e-5, gain=measured)})
    assert judged.comparison.verdict is verdict
    assert judged.modelled is (verdict is Verdict.DISAGREE)
    assert math.isclose(judged.comparison.difference, 0.05)


def test_without_a_law_a_contact_that_gives_way_may_be_farther_off_by_its_compliance() -> None:
    own = Variant("reference")
    soft = replace(own.preset, residual_slip_compliance=1e-3)
    stiff = replace(own.preset, residual_slip_compliance=0.0)
    allowed = [allowed_distance(SimpleNamespace(preset=each, capabilities=own.capabilities)) for each in (stiff, soft)]
    assert allowed[0] == TRAJECTORY_TOLERANCE[own.capabilities.precision]
    assert allowed[1] - allowed[0] == pytest.approx(CREEP * 1e-3)
