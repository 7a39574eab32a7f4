"""What a notebook writes: `sweep` and `check`, with lists and arrays, and mistakes that cost no time."""

import re

import numpy as np
import pytest

from multibody_xval.scenarios import check, functions, sweep
from multibody_xval.scenarios.sweeps.plan import UNCONFIRMED_POINTS
from reference_lcp import Chain, HarmonicForce, ParameterError, steady_state

pytestmark = pytest.mark.usefixtures("here")


def test_an_array_is_a_value_a_cell_of_the_references_own_chain() -> None:
    masses = np.array([1.0, 0.8, 1.2])
    data = sweep("reference", 0.0, 0.9, chain={"cells": 3, "mass_ratio": masses}, drive="force", amplitude=5.0)
    chain = Chain.from_ratios(friction_ratio=0.0, cells=3, mass_ratio=masses.tolist())
    state = steady_state(chain, HarmonicForce(5.0, 0.9 * chain.resonator_frequency), with_error_bar=False)
    assert float(data.transmittance_db.squeeze()) == pytest.approx(state.transmittance_db, abs=1e-6)


def test_a_large_sweep_is_refused_without_a_yes(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(functions, "swept", lambda planned, _means: planned.points)
    large = {"friction_ratio": (0.0, 1.0, 400), "frequency_ratio": (0.3, 1.6, 300)}
    assert UNCONFIRMED_POINTS < 400 * 300
    with pytest.raises(ParameterError, match=r"has 120,000 points, 3.33 h of .*allowed: <= 100,000 .*with yes=True"):
        sweep("reference", **large)
    assert sweep("reference", **large, yes=True) == 120_000


SWEEP = {"friction_ratio": 0.3, "frequency_ratio": 0.9}


@pytest.mark.parametrize(
    ("function", "arguments", "message"),
    [
        (check, {"scenario": "static-hole"}, "scenario = 'static-hole' is unknown; .* did you mean static-hold?"),
        (
            sweep,
            {"chain": {"masratio": 1.0}},
            "chain.masratio is unknown; allowed: cells, .*; did you mean mass_ratio?",
        ),
        (sweep, {"cells": 12}, "sweep has no argument 'cells'; allowed: in chain={'cells': ...}"),
        (sweep, {"friction_ratio": (0.1, 0.3)}, "(0.1, 0.3) is a tuple; allowed: [0.1, 0.3] for these values"),
    ],
)
def test_mistake_is_named_before_any_work(function, arguments, message, monkeypatch: pytest.MonkeyPatch) -> None:
    missing = "multibody_xval.scenarios.running.evaluate.run_missing"
    monkeypatch.setattr(missing, lambda *_, **__: pytest.fail("computed"))
    usual = {"engines": "mujoco", **({"scenario": "static-hold"} if function is check else SWEEP)}
    with pytest.raises(ParameterError, match=re.escape(message).replace(r"\.\*", ".*")):
        function(**usual | arguments)
