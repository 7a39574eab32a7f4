"""Tables: in full for programs, rounded for people, and nothing of a text is taken for markup."""

import csv
import io
import json
import math

import numpy as np
import pandas as pd
import pytest

from multibody_xval.scenarios.table_text import csv_cell, csv_text, json_text, markdown_lines, print_table, records

NAMES = ["name", "error_db", "points"]
ROWS = [("a|b [bold]", 1 / 3, 7), ("c, d", math.nan, None), ("e", np.float64(0.1), 2**60)]
TABLE = pd.DataFrame(ROWS, columns=NAMES, dtype=object)
TEXTS = pd.DataFrame(
    [("a|b [bold]", "0.33", "7"), ("c, d", "–", "–"), ("e", "0.10", str(2**60))], columns=["name", "error [dB]", "of"]
)


def test_csv_has_keys_every_digit_and_a_word_for_what_is_missing() -> None:
    read = list(csv.reader(io.StringIO(csv_text(TABLE))))
    assert read == [
        ["name", "error_db", "points"],
        ["a|b [bold]", repr(1 / 3), "7"],
        ["c, d", "nan", "nan"],
        ["e", "0.1", str(2**60)],
    ]
    assert csv_text(TABLE[1:2], missing="").splitlines()[1] == '"c, d",,'


def test_json_has_every_digit_and_null_for_what_is_missing() -> None:
    read = json.loads(json_text(records(TABLE)))
    assert [list(row.values()) for row in read] == [["a|b [bold]", 1 / 3, 7], ["c, d", None, None], ["e", 0.1, 2**60]]
    assert json.loads(json_text({"limit": math.inf, "rows": slice(1)})) == {
        "limit": None,
        "rows": "slice(None, 1, None)",
    }


def test_markdown_has_headings_rounded_numbers_and_no_column_too_many() -> None:
    assert markdown_lines(TEXTS) == [
        "| name | error [dB] | of |",
        "|---|---|---|",
        "| a\\|b [bold] | 0.33 | 7 |",
        "| c, d | – | – |",
        f"| e | 0.10 | {2**60} |",
    ]


@pytest.mark.parametrize("rows", [3, 0])
def test_terminal_shows_texts_as_they_are(rows, capsys) -> None:
    print_table(TEXTS[:rows])
    printed = capsys.readouterr().out
    for word in ("name", "error", "[dB]", "of"):
        assert word in printed
    assert ("a|b [bold]" in printed) == bool(rows)


HOSTILE = '=HYPERLINK("http://x")\x1b]0;owned\x07\r\n[red]\u202e'
"""What a spreadsheet would compute, a terminal obey, rich colour, and a reader see backwards."""


@pytest.mark.parametrize("text", ["=1+1", "+1", "-1", "@SUM(A1)"])
def test_a_text_that_a_spreadsheet_would_compute_begins_with_an_apostrophe(text) -> None:
    assert csv_cell(text) == f"'{text}"


@pytest.mark.parametrize("value", [-1.5, -3, math.nan, None, True, "1 = 2", "–", "", "'=1"])
def test_numbers_and_other_texts_stand_in_csv_as_they_are(value) -> None:
    assert csv_cell(value) is value or csv_cell(value) == value


@pytest.mark.parametrize("text", ["\t=1", "\r=1"])
def test_what_a_spreadsheet_would_skip_before_a_formula_is_visible(text) -> None:
    assert csv_cell(text)[0] == "\\"


def test_no_control_character_of_a_stranger_reaches_a_terminal_or_a_file(capsys) -> None:
    whole = pd.DataFrame([(HOSTILE, -0.25, 1)], columns=NAMES, dtype=object)
    shown = whole.astype(str)
    print_table(shown)
    printed = capsys.readouterr().out
    assert "=HYPERLINK(" in printed
    assert "[red]" in printed
    cell = list(csv.reader(io.StringIO(csv_text(whole))))[1]
    assert cell == ['\'=HYPERLINK("http://x")\\x1b]0;owned\\x07\\r\\n[red]\\u202e', "-0.25", "1"]
    for text in (printed, csv_text(whole), "\n".join(markdown_lines(shown))):
        assert not {"\x07", "\r", "\u202e"} & set(text)
        assert "\x1b]" not in text
        assert "\\x1b]0;owned" in text
