"""Searches for steady states: from that of Euler's scheme, and from elsewhere where that leads astray."""

import pytest

from multibody_xval.scenarios.compute.batch import run_batch
from multibody_xval.scenarios.model import Case, Config, Run, Status

SOFT = Config("mujoco", preset_name="default")
"""Contacts that creep: far from Euler's steady state, steps of the search may lead to where the motion explodes."""


def test_a_search_that_diverges_next_to_eulers_steady_state_begins_anew() -> None:
    astray = Case(friction_ratio=1.0, frequency_ratio=0.671429)
    found, beside = run_batch([Run(SOFT, own, 400) for own in (astray, Case(friction_ratio=1.0, frequency_ratio=0.9))])
    assert found.status is beside.status is Status.PERIODIC
    near = run_batch([Run(SOFT, Case(friction_ratio=1.0, frequency_ratio=eta), 400) for eta in (0.6709, 0.6719)])
    assert found.transmittance == pytest.approx(sum(own.transmittance for own in near) / 2, rel=1e-3)
