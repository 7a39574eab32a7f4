"""A base that follows a record: the example, and a user's own file."""

import math
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from multibody_xval.scenarios.cases.motions import ChainMotion
from multibody_xval.scenarios.catalogue.chains.record_file import read_record
from multibody_xval.scenarios.catalogue.chains.records import EXAMPLE, RECORD, following
from multibody_xval.scenarios.catalogue.numbers import numbers
from multibody_xval.scenarios.model import Run
from multibody_xval.scenarios.ruler.judge import AGREES
from multibody_xval.scenarios.store import Stored
from reference_lcp import ParameterError, RecordedBase
from tests.scenarios.catalogue.example_record import PEAK, example_samples, write_example
from tests.scenarios.in_this_process import SHARES, only, result_of


def test_example_record_is_its_formula_and_small(tmp_path) -> None:
    write_example(tmp_path / "again.csv")
    assert (tmp_path / "again.csv").read_text() == EXAMPLE.read_text()
    assert EXAMPLE.stat().st_size < 20_000
    record = read_record(EXAMPLE)
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


def written(tmp_path, spacing):
    file = tmp_path / "own.csv"
    file.write_text("\n".join(f"{spacing * k:.4f},{0.01 * math.sin(k)}" for k in range(50)))
    return file


def test_own_record_too_coarse_for_the_bands_is_refused(tmp_path) -> None:
    with pytest.raises(ParameterError, match=r"too coarse: samples are up to 0\.06 s apart; allowed: <= 0\.0496"):
        following(written(tmp_path, 0.06))


@pytest.mark.parametrize(("spacing", "steps"), [(0.02, 200), (0.003, 280), (0.001, 800)])
def test_steps_are_as_short_as_the_samples_of_a_record_are_near(tmp_path, spacing, steps) -> None:
    """A period 2π / ω_r takes 0.1987 s; ten rows of it are kept, and a fourth of the steps meets every sample."""
    scenario = following(written(tmp_path, spacing))
    (run, *_) = scenario.own_runs(SHARES).values()
    case = run.of(ChainMotion)
    assert 10 * run.steps == steps * case.rows
    assert case.lane(run.steps // 4).time_step <= spacing


def test_missing_record_is_named_before_any_work() -> None:
    with pytest.raises(ParameterError, match=r"record nowhere\.csv cannot be read"):
        following(Path("nowhere.csv"))


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
