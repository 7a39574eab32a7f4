"""A base that follows a record: the example, and a user's own file."""

import math
from dataclasses import replace

import numpy as np
import pytest

from multibody_xval.scenarios.cases.motions import ChainMotion
from multibody_xval.scenarios.catalogue.chains.records import EXAMPLE, RECORD, following
from multibody_xval.scenarios.catalogue.numbers import numbers
from multibody_xval.scenarios.model import Run
from multibody_xval.scenarios.ruler.judge import AGREES
from multibody_xval.scenarios.store import Stored
from reference_lcp import ParameterError, RecordedBase
from tests.scenarios.catalogue.example_record import PEAK, example_samples
from tests.scenarios.in_this_process import SHARES, only, result_of


def test_example_record_is_its_formula_and_small() -> None:
    assert EXAMPLE.stat().st_size < 20_000
    record = RecordedBase.from_csv(EXAMPLE)
    times, displacements = example_samples()
    assert record == RecordedBase(tuple(times.tolist()), tuple(displacements.tolist()))
    assert record.amplitude == PEAK
    assert abs(displacements[-1]) < 1e-9


def test_own_record_is_scaled_to_the_amplitude_of_the_friction_ratio(tmp_path) -> None:
    file = tmp_path / "own.csv"
    times = 0.02 * np.arange(101)
    own = 3.0 * np.sin(2 * math.pi * 5 * times) * np.sin(math.pi * times / 2) ** 2
    file.write_text("\n".join(f"{a},{b}" for a, b in zip(times, own, strict=True)))
    period = 2 * math.pi / math.sqrt(1000)
    for case in following(file).cases.values():
        assert case.scale == pytest.approx(0.01)
        assert case.time == pytest.approx((math.ceil(2.0 / period) + 200) * period)
    assert list(following(file).cases) == list(RECORD.cases)
    assert following(file).cases != RECORD.cases


def test_own_record_that_is_missing_or_too_coarse_for_the_bands_is_refused(tmp_path) -> None:
    file = tmp_path / "own.csv"
    with pytest.raises(ParameterError, match=r"own\.csv cannot be read"):
        following(file)
    file.write_text("\n".join(f"{0.06 * k:.4f},{0.01 * math.sin(k)}" for k in range(50)))
    with pytest.raises(ParameterError, match=r"too coarse: samples are up to 0\.06 s apart; allowed: <= 0\.0496"):
        following(file)


def test_stored_results_of_a_record_are_judged_by_the_file_that_is_named() -> None:
    """A stored run knows the record by its hash alone."""
    scenario = only(RECORD, "= 0.3")
    results = [Stored(run, "1", result_of(run)) for run in scenario.runs([SHARES])]
    stored = [own._replace(run=Run.from_text(own.run.text)) for own in results]
    assert stored[-1].run == results[-1].run
    table = numbers(scenario, stored)
    assert set(table[table.engine == "mujoco"].verdict) == {AGREES}
    assert table.equals(numbers(scenario, results))
    other = replace(scenario, cases={"another": replace(results[-1].run.of(ChainMotion), friction_ratio=0.2)})
    assert numbers(other, stored).empty
