"""A base that follows a record: the example that ships with the suite, and a table that a user brings."""

import math
import re
from dataclasses import replace

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
from tests.scenarios.in_this_process import SHARES, only, result_of

PEAK = 0.01
"""The largest displacement of the example [m]."""


def example_samples() -> tuple[np.ndarray, np.ndarray]:
    """Times [s] and displacements [m] of the example, shape (600,), rounded as in the file.

    Noise of evenly drawn phases with the spectrum of Kanai and Tajimi, (1 + 4 ζ_g² r²) / ((1 − r²)² + 4 ζ_g² r²)
    with r = ω / ω_g, of a firm soil (H. Tajimi, Proc. 2nd World Conf. Earthquake Eng., 1960), here of the displacement,
    between 2 and 12 Hz, under the envelope (t/2 s) exp(1 − t/2 s) (1 − (t/T)⁴)², which begins and ends at rest. Slower
    shaking would set the whole chain swinging, for much longer than the record lasts.
    """
    time, omega = 0.02 * np.arange(600), 2 * np.pi * np.arange(2.0, 12.0, 0.05)
    r, damping = omega / (2 * np.pi * 4.0), 0.6
    ground = (2 * damping * r) ** 2
    amplitude = np.sqrt((1 + ground) / ((1 - r**2) ** 2 + ground))
    phase = 2 * np.pi * np.random.Generator(np.random.PCG64(20)).random(omega.size)
    envelope = time / 2 * np.exp(1 - time / 2) * (1 - (time / time[-1]) ** 4) ** 2
    shaking = envelope * (np.sin(np.outer(time, omega) + phase) @ amplitude)
    return np.round(time, 2), np.round(PEAK * shaking / np.max(np.abs(shaking)), 8)


def test_example_record_is_its_formula_and_small() -> None:
    assert EXAMPLE.stat().st_size < 20_000
    record, (times, displacements) = read_record(EXAMPLE), example_samples()
    assert record == RecordedBase(tuple(times.tolist()), tuple(displacements.tolist()))
    assert record.amplitude == PEAK


def test_stored_results_of_a_record_are_judged_by_the_file_that_is_named() -> None:
    """A stored run knows the record by its hash alone."""
    scenario = only(RECORD, "= 0.3")
    results = [Stored(run, "1", result_of(run)) for run in scenario.runs([SHARES])]
    stored = [own._replace(run=Run.from_text(own.run.text)) for own in results]
    table = numbers(scenario, stored)
    assert set(table[table.engine == "mujoco"].verdict) == {AGREES}
    other = replace(scenario, cases={"another": replace(results[-1].run.of(ChainMotion), friction_ratio=0.2)})
    assert numbers(other, stored).empty


def test_table_is_read_with_heading_comments_and_scale(tmp_path) -> None:
    file = tmp_path / "record.csv"
    file.write_text("time [s],displacement [m]\n# a comment, with a comma\n0,0\n\n0.1,1e-3\n0.2, 2e-3\n0.4,-1e-3\n")
    assert read_record(file, 4e-3) == RecordedBase((0.0, 0.1, 0.2, 0.4), (0.0, 2e-3, 4e-3, -2e-3))
    file.write_text("\n".join(f"{0.02 * k:.4f},{3 * math.sin(k) * math.sin(math.pi * k / 100)}" for k in range(101)))
    period = 2 * math.pi / math.sqrt(1000)
    for case in following(file).cases.values():
        assert case.scale == pytest.approx(0.01)
        assert case.time == pytest.approx((math.ceil(2.0 / period) + 200) * period)


GOOD = b"0,0\n0.1,1\n0.2,2\n0.3,1\n"
COARSE = "\n".join(f"{0.06 * k:.4f},{0.01 * math.sin(k)}" for k in range(50)).encode()


@pytest.mark.parametrize(
    ("content", "message"),
    [
        (None, "record {file} cannot be read: No such file"),
        (b"\xff\xfe\x00\x01", "record {file} cannot be read: 'utf-8' codec"),
        (GOOD + b"0.4\n", "line 5 of record {file} has 1 columns; allowed: 2, time [s] and displacement [m]"),
        (GOOD + b"0.4,nan\n", "'nan' in line 5 of record {file} is not a number; allowed: finite numbers"),
        (GOOD + b"0.3,1\n", "record {file}: time = 0.3 s in sample 5 of the record; allowed: > 0.3 s"),
        (b"0,1\n1,1\n2,1\n3,1\n", "displacement = 1 m throughout; allowed: a base that moves"),
        (COARSE, "too coarse: samples are up to 0.06 s apart; allowed: <= 0.0496"),
    ],
)
def test_mistakes_in_a_table_are_named_with_file_and_line(tmp_path, content, message) -> None:
    file = tmp_path / "record.csv"
    if content is not None:
        file.write_bytes(content)
    with pytest.raises(ParameterError, match=re.escape(message.format(file=file))):
        following(file)
