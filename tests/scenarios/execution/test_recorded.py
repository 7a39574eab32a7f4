"""Recorded periods: they say the same as other results, and are run, kept and blocked as others are."""

import numpy as np
import pytest

from engines.interface.variant import Variant
from scenarios.execution.computation.batch import run_batch
from scenarios.execution.evaluator import Evaluator, StoredResults
from scenarios.execution.executor import InProcessExecutor
from scenarios.execution.storage.store import ResultStore
from scenarios.tasks.parameters import ChainRatios
from scenarios.tasks.recorded import RecordedPeriod, RecordedPeriodTask
from scenarios.tasks.result import Result
from scenarios.tasks.task import SteadyStateTask


def plain(frequency_ratio: float = 0.9, variant: str = "reference") -> SteadyStateTask:
    ratios = ChainRatios(cells=2)
    return SteadyStateTask(
        variant=Variant.parse(variant), friction_ratio=0.3, frequency_ratio=frequency_ratio, ratios=ratios
    )


def recorded(frequency_ratio: float = 0.9, variant: str = "reference") -> RecordedPeriodTask:
    return RecordedPeriodTask.of(plain(frequency_ratio, variant))


@pytest.fixture
def store(tmp_path):
    with ResultStore(tmp_path / "results.sqlite") as opened:
        yield opened


@pytest.mark.parametrize("variant", ["reference", "reference:joint:exact"])
def test_a_period_says_what_the_result_says(variant) -> None:
    (result,), (full,) = run_batch([plain(variant=variant)]), run_batch([recorded(variant=variant)])
    period = RecordedPeriod.of_result(full)
    steps = period.phase.size
    # the exact result knows its events between the rows: each end of a stick is one row off at most
    apart = 4 / steps if "exact" in variant else 1e-12
    np.testing.assert_allclose(np.mean(period.modes == 0, axis=0), result.stuck_fraction, atol=apart)
    amplitude = 2 * np.abs(np.mean(period.outer[:, -1] * np.exp(-2j * np.pi * period.phase)))
    sampling_db = 1e-3 if "exact" in variant else 1e-9
    assert 20 * np.log10(amplitude) == pytest.approx(result.transmittance_db, abs=sampling_db)
    assert full.transmittance_db == result.transmittance_db
    assert np.all(np.abs(period.friction) <= 1 + 1e-9)
    slips = period.modes != 0
    np.testing.assert_allclose(period.friction[slips], -period.modes[slips], atol=1e-6)


def test_a_period_is_kept_bit_for_bit_beside_the_result_without_one(store) -> None:
    (full,) = run_batch([recorded()])
    assert store.find(recorded()) is None
    store.keep([(recorded(), full)])
    period, again = RecordedPeriod.of_result(full), RecordedPeriod.of_result(store.find(recorded()))
    for name in ("outer", "inner", "friction", "modes"):
        np.testing.assert_array_equal(getattr(again, name), getattr(period, name))
        assert getattr(again, name).shape == (400, 2)
    assert store.find(recorded(0.8)) is None
    assert store.find(plain()) is None


def test_what_is_known_is_not_computed_again(store, monkeypatch) -> None:
    (first,) = Evaluator(store, InProcessExecutor()).evaluate([recorded()])

    def refuse(*_: object) -> None:
        raise AssertionError("something was computed again")

    monkeypatch.setattr(Variant, "build", refuse)
    assert Evaluator(store, InProcessExecutor()).evaluate([recorded()]) == [first]


def test_what_is_not_known_is_missing_where_nothing_may_be_computed(store) -> None:
    (result,) = StoredResults(store).evaluate([recorded()])
    assert RecordedPeriod.of_result(result).reason == "not evaluated so far"


def test_a_search_without_a_steady_state_says_how_it_ended() -> None:
    result = Result(status="period limit", periods=400, residual=2e-3)
    period = RecordedPeriod.of_result(result)
    assert not period.known
    assert period.reason == "period limit after 400 periods, residual 2.0e-03"


def test_an_engine_that_raises_gives_its_reason(monkeypatch) -> None:
    def fail(*_: object) -> None:
        raise RuntimeError("no such shape")

    monkeypatch.setattr(Variant, "build", fail)
    (result,) = run_batch([recorded()])
    assert RecordedPeriod.of_result(result).reason == "RuntimeError: no such shape"
