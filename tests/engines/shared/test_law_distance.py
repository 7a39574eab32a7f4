"""How far an engine may be from what it states after a period."""

from dataclasses import replace
from types import SimpleNamespace

import pytest

from multibody_xval.engines.interface.tolerances import CREEP, TRAJECTORY_TOLERANCE
from multibody_xval.engines.interface.variant import Variant
from multibody_xval.engines.shared.law_distance import allowed_distance


def test_without_a_law_a_contact_that_gives_way_may_be_farther_off_by_its_compliance() -> None:
    own = Variant("reference")
    soft = replace(own.preset, residual_slip_compliance=1e-3)
    stiff = replace(own.preset, residual_slip_compliance=0.0)
    allowed = [allowed_distance(SimpleNamespace(preset=each, capabilities=own.capabilities)) for each in (stiff, soft)]
    assert allowed[0] == TRAJECTORY_TOLERANCE[own.capabilities.precision]
    assert allowed[1] - allowed[0] == pytest.approx(CREEP * 1e-3)
