"""Motions in full: they say the same as answers, are kept, and engines that fail take nobody along."""

import os
from pathlib import Path

import numpy as np
import pytest

from engines.interface.variant import Variant
from reference_lcp.validation import ParameterError
from scenarios.execution import recorded as module
from scenarios.execution.local_processes import ProcessWorker
from scenarios.execution.recorded import PeriodStore, RecordedPeriod, period_of, periods_of, recorded_periods
from scenarios.execution.steady import answer_batch
from scenarios.execution.store import ResultStore
from scenarios.tasks.parameters import ChainRatios
from scenarios.tasks.task import SteadyStateTask


def question(frequency_ratio: float = 0.9, variant: str = "reference") -> SteadyStateTask:
    ratios = ChainRatios(cells=2)
    return SteadyStateTask(variant=Variant(variant), friction_ratio=0.3, frequency_ratio=frequency_ratio, ratios=ratios)


@pytest.fixture
def store(tmp_path: Path) -> PeriodStore:
    ResultStore(tmp_path / "results.sqlite").close()
    return PeriodStore(tmp_path / "results.sqlite")


def test_a_motion_says_what_the_answer_says() -> None:
    (answer,), (found,) = answer_batch([question()]), periods_of([question()])
    np.testing.assert_allclose(np.mean(found.modes == 0, axis=0), answer.stuck_fraction)
    amplitude = 2 * np.abs(np.mean(found.outer[:, -1] * np.exp(-2j * np.pi * found.phase)))
    assert 20 * np.log10(amplitude) == pytest.approx(answer.transmittance_db, abs=1e-9)
    assert np.all(np.abs(found.friction) <= 1 + 1e-9)
    slips = found.modes != 0
    np.testing.assert_allclose(found.friction[slips], -found.modes[slips], atol=1e-6)


def test_a_motion_is_kept_bit_for_bit_beside_the_answers(store: PeriodStore) -> None:
    (found,) = periods_of([question()])
    assert store.find(question()) is None
    store.keep(question(), found)
    again = store.find(question())
    assert again is not None
    for name in ("outer", "inner", "friction", "modes"):
        np.testing.assert_array_equal(getattr(again, name), getattr(found, name))
    assert store.find(question(0.8)) is None


def test_what_is_known_is_not_computed_again(store: PeriodStore, monkeypatch: pytest.MonkeyPatch) -> None:
    first = recorded_periods([question()], store, workers=1)[question()]

    def refuse(*_: object) -> None:
        raise AssertionError("something was computed again")

    monkeypatch.setattr(ProcessWorker, "submit", refuse)
    np.testing.assert_array_equal(recorded_periods([question()], store)[question()].outer, first.outer)


def test_what_is_not_known_is_missing_where_nobody_may_be_asked(store: PeriodStore) -> None:
    assert recorded_periods([question()], store, ask=False)[question()].reason == "not answered so far"


def test_a_motion_without_a_steady_state_is_not_kept(store: PeriodStore) -> None:
    store.keep(question(), RecordedPeriod("diverged"))
    assert store.find(question()) is None


def ends_at_high_frequency(batch: list[SteadyStateTask]) -> list[RecordedPeriod]:
    if batch[0].frequency_ratio > 1:
        os._exit(1)
    return periods_of(batch)


def test_a_process_that_dies_takes_no_other_motion_along(store: PeriodStore, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(module, "periods_of", ends_at_high_frequency)
    asked = [question(1.1), question(0.9)]
    found = recorded_periods(asked, store, workers=1)
    assert found[asked[0]].reason == "the worker process was killed"
    assert found[asked[1]].known


def test_an_engine_that_raises_gives_its_reason(monkeypatch: pytest.MonkeyPatch) -> None:
    def fail(*_: object) -> None:
        raise RuntimeError("no such shape")

    monkeypatch.setattr(Variant, "build", fail)
    assert periods_of([question()])[0].reason == "RuntimeError: no such shape"


@pytest.mark.parametrize("limit", [0.0, -1.0])
def test_a_wrong_time_limit_is_refused(store: PeriodStore, limit: float) -> None:
    with pytest.raises(ParameterError, match="time_limit"):
        recorded_periods([question()], store, time_limit=limit)
    with pytest.raises(ParameterError, match="time_limit"):
        period_of(question(), limit)
