"""Recorded periods: they say the same as other results, and are run, kept and blocked as others are."""

from dataclasses import replace

import numpy as np
import pytest

from multibody_xval.scenarios.runs.executor import run_batch
from multibody_xval.scenarios.runs.recorded import RecordedPeriod
from multibody_xval.scenarios.runs.result import Result
from multibody_xval.scenarios.runs.task import Recorded, SteadyStateTask
from reference_lcp.chain.drives import HarmonicBase
from reference_lcp.chain.mass_in_mass import Chain
from reference_lcp.chain.simulation import Lane
from reference_lcp.schemes.euler import euler_simulation
from reference_lcp.steady.orbits import periodic_orbits
from tests.scenarios.runs.builders import steady


def period_task(frequency_ratio: float = 0.9, variant: str = "reference") -> SteadyStateTask:
    return steady(frequency_ratio, variant).recording(Recorded.PERIOD)


@pytest.mark.parametrize("variant", ["reference", "reference:joint:exact"])
def test_a_period_says_what_the_result_says(variant) -> None:
    (result,), (full,) = run_batch([steady(variant=variant)]), run_batch([period_task(variant=variant)])
    period = RecordedPeriod.of_result(full)
    steps = period.outer.shape[0]
    # the exact result knows its events between the rows: each end of a stick is one row off at most
    apart = 4 / steps if "exact" in variant else 1e-12
    np.testing.assert_allclose(np.mean(period.modes == 0, axis=0), result.stuck_fraction, atol=apart)
    amplitude = 2 * np.abs(np.mean(period.outer[:, -1] * np.exp(-2j * np.pi * np.arange(1, steps + 1) / steps)))
    sampling_db = 1e-3 if "exact" in variant else 1e-9
    assert 20 * np.log10(amplitude) == pytest.approx(result.transmittance_db, abs=sampling_db)
    assert full.transmittance_db == result.transmittance_db
    assert np.all(np.abs(period.friction) <= 1 + 1e-9)
    slips = period.modes != 0
    np.testing.assert_allclose(period.friction[slips], -period.modes[slips], atol=1e-6)


def test_a_period_is_kept_bit_for_bit_beside_the_result_without_one(store) -> None:
    (full,) = run_batch([period_task()])
    assert store.find(period_task()) is None
    store.keep([(period_task(), full)])
    period, again = RecordedPeriod.of_result(full), RecordedPeriod.of_result(store.find(period_task()))
    for name in ("outer", "inner", "friction", "modes"):
        np.testing.assert_array_equal(getattr(again, name), getattr(period, name))
        assert getattr(again, name).shape == (400, 2)
    assert store.find(period_task(0.8)) is None
    assert store.find(steady()) is None


@pytest.mark.parametrize(
    ("result", "reason"),
    [
        (Result.missing(), "not evaluated so far"),
        (Result.blocked("RuntimeError: no such shape", by_engine=True), "RuntimeError: no such shape"),
        (
            Result(status="period limit", periods=400, residual=2e-3),
            "period limit after 400 periods, residual 2.0e-03",
        ),
    ],
)
def test_a_period_that_is_not_there_has_the_reason(result, reason) -> None:
    period = RecordedPeriod.of_result(result)
    assert not period.known
    assert period.reason == reason


def test_friction_of_a_frictionless_contact_is_over_the_force_of_its_spring() -> None:
    chain = Chain.from_ratios(cells=2, friction_ratio=[0.3, 0.0], base_amplitude=0.02, chain_stiffness=500.0)
    orbit = periodic_orbits(
        euler_simulation([Lane.periodic(chain, HarmonicBase.from_ratio(chain, 0.9, 0.02), 400)]), 400
    )[0]
    forces = np.tile([1.5, 5.0], (400, 1))
    pressed = replace(orbit, trajectory=replace(orbit.trajectory, friction=forces))
    period = RecordedPeriod.of(pressed, 0.0)
    assert period.friction[0] == pytest.approx([1.5 / (0.3 * 500 * 0.02), 5.0 / (500 * 0.02)])
