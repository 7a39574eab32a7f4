"""Records of a base that a user brings as a table."""

import re

import pytest

from multibody_xval.scenarios.catalogue.chains.record_file import read_record
from reference_lcp import ParameterError, RecordedBase


def test_table_is_read_with_heading_comments_and_scale(tmp_path) -> None:
    file = tmp_path / "record.csv"
    file.write_text("time [s],displacement [m]\n# a comment, with a comma\n0,0\n\n0.1,1e-3\n0.2, 2e-3\n0.4,-1e-3\n")
    assert read_record(file, 4e-3) == RecordedBase((0.0, 0.1, 0.2, 0.4), (0.0, 2e-3, 4e-3, -2e-3))


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
        read_record(file)


def test_files_that_cannot_be_read_are_refused(tmp_path) -> None:
    binary = tmp_path / "binary.csv"
    binary.write_bytes(b"\xff\xfe\x00\x01")
    with pytest.raises(ParameterError, match=r"record .*missing\.csv cannot be read: No such file"):
        read_record(tmp_path / "missing.csv")
    with pytest.raises(ParameterError, match=r"record .* cannot be read: Is a directory"):
        read_record(tmp_path)
    with pytest.raises(ParameterError, match=r"record .*binary\.csv cannot be read: 'utf-8' codec"):
        read_record(binary)
