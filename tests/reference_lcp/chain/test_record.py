"""A base that follows a record: the spline through its samples, and everything that a file can have wrong."""

import re

import numpy as np
import pytest

from reference_lcp import ParameterError, RecordedBase

RECORD = RecordedBase((1.0, 1.5, 1.7, 2.6, 3.0), (0.2, 0.3, -0.1, 0.4, 0.25))


def test_record_passes_through_its_samples_from_its_first_one() -> None:
    """Time and displacement count from the first sample, where the chain is undeformed."""
    times = np.array(RECORD.times) - 1.0
    assert RECORD.displacement(times) == pytest.approx(np.array(RECORD.displacements) - 0.2, abs=1e-15)
    assert RECORD.amplitude == pytest.approx(0.3)
    assert RECORD.duration == pytest.approx(2.0)


def test_velocity_of_a_record_is_continuous_and_zero_outside() -> None:
    """The spline is clamped: nothing jumps where the base starts and stops."""
    time, h = np.linspace(-0.5, 2.5, 3001), 1e-6
    rate = (RECORD.displacement(time + h) - RECORD.displacement(time - h)) / (2 * h)
    assert RECORD.velocity(time) == pytest.approx(rate, abs=1e-4)
    assert np.max(np.abs(np.diff(RECORD.velocity(time)))) < 0.05
    assert np.all(RECORD.velocity(np.array([-1.0, 0.0, 2.0, 3.0])) == pytest.approx(0, abs=1e-14))
    assert RECORD.displacement(np.array([-1.0, 9.0])) == pytest.approx([0.0, 0.05])


def test_finely_sampled_sine_is_interpolated_to_fourth_order() -> None:
    """A cubic spline's error falls with the fourth power of the spacing: 16 times for half of it."""
    errors = []
    for samples in (41, 81):
        times = np.linspace(0, 2 * np.pi, samples)
        base = RecordedBase(tuple(times.tolist()), tuple((1 - np.cos(times)).tolist()))
        fine = np.linspace(0, 2 * np.pi, 2001)
        errors.append(np.max(np.abs(base.displacement(fine) - (1 - np.cos(fine)))))
    assert errors[0] / errors[1] == pytest.approx(16, rel=0.1)


def test_table_is_read_with_heading_comments_and_scale(tmp_path) -> None:
    file = tmp_path / "record.csv"
    file.write_text("time [s],displacement [m]\n# a comment, with a comma\n0,0\n\n0.1,1e-3\n0.2, 2e-3\n0.4,-1e-3\n")
    assert RecordedBase.from_csv(file, 2.0) == RecordedBase((0.0, 0.1, 0.2, 0.4), (0.0, 2e-3, 4e-3, -2e-3))


def test_records_differ_in_their_parameters_where_a_sample_does() -> None:
    other = RecordedBase(RECORD.times, (*RECORD.displacements[:-1], 0.25 + 1e-15))
    assert RECORD.parameters() != other.parameters()
    assert RECORD.parameters() == RecordedBase(RECORD.times, RECORD.displacements).parameters()


GOOD = "0,0\n0.1,1\n0.2,2\n0.3,1\n"


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("", "has 0 samples; allowed: at least 4"),
        ("0,0\n0.1,1\n0.2,2\n", "has 3 samples; allowed: at least 4"),
        (GOOD + "0.4\n", "line 5 of record {file} has 1 columns; allowed: 2, time [s] and displacement [m]"),
        (GOOD + "0.4,1,2\n", "line 5 of record {file} has 3 columns; allowed: 2"),
        ("time;displacement\n" + GOOD, "line 1 of record {file} has 1 columns; allowed: 2"),
        (GOOD + "0.4,nan\n", "'nan' in line 5 of record {file} is not a number; allowed: finite numbers"),
        (GOOD + "0.4,1e999\n", "'1e999' in line 5 of record {file} is not a number; allowed: finite numbers"),
        (GOOD + "0.4,three\n", "'three' in line 5 of record {file} is not a number"),
        (GOOD + "0.4,\n", "'' in line 5 of record {file} is not a number"),
        (GOOD + "0.3,1\n", "record {file}: time = 0.3 s in sample 5 of the record; allowed: > 0.3 s"),
        (GOOD + "0.25,1\n", "record {file}: time = 0.25 s in sample 5 of the record; allowed: > 0.3 s"),
        ("0,1\n1,1\n2,1\n3,1\n", "displacement = 1 m throughout; allowed: a base that moves"),
    ],
)
def test_mistakes_in_a_table_are_named_with_file_and_line(tmp_path, text, message) -> None:
    file = tmp_path / "record.csv"
    file.write_text(text)
    with pytest.raises(ParameterError, match=re.escape(message.format(file=file))):
        RecordedBase.from_csv(file)


def test_files_that_cannot_be_read_are_refused(tmp_path) -> None:
    binary = tmp_path / "binary.csv"
    binary.write_bytes(b"\xff\xfe\x00\x01")
    with pytest.raises(ParameterError, match=r"record .*missing\.csv cannot be read: No such file"):
        RecordedBase.from_csv(tmp_path / "missing.csv")
    with pytest.raises(ParameterError, match=r"record .* cannot be read: Is a directory"):
        RecordedBase.from_csv(tmp_path)
    with pytest.raises(ParameterError, match=r"record .*binary\.csv cannot be read: 'utf-8' codec"):
        RecordedBase.from_csv(binary)
    with pytest.raises(ParameterError, match="record scale = 0 is outside its range"):
        RecordedBase.from_csv(binary, 0.0)


def test_record_too_coarse_for_a_frequency_or_finer_than_a_step_is_refused() -> None:
    RECORD.check_resolves(np.pi / 0.9)
    with pytest.raises(ParameterError, match=r"samples are up to 0\.9 s apart; allowed: <= 0\.3142 s"):
        RECORD.check_resolves(10.0)
    RECORD.check_time_step(0.2)
    with pytest.raises(ParameterError, match=r"time_step = 0\.3 s would leave out samples .* allowed: <= 0\.2 s"):
        RECORD.check_time_step(0.3)


def test_samples_that_do_not_fit_together_are_refused() -> None:
    with pytest.raises(ParameterError, match="5 times and 4 displacements; allowed: as many of each"):
        RecordedBase(RECORD.times, RECORD.displacements[:4])
    with pytest.raises(ParameterError, match="time in sample 2 of the record = nan"):
        RecordedBase((0.0, np.nan, 1.0, 2.0), (0.0, 1.0, 2.0, 3.0))
