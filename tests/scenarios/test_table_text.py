"""Tables: in full for programs, rounded for people, and nothing of a text is taken for markup."""

import csv
import io
import json
import math

import pandas as pd
import pytest

from multibody_xval.scenarios.table_text import csv_cell, csv_text, json_text, markdown_lines, print_table, records

NAMES = ["name", "error_db", "points"]
TABLE = pd.DataFrame([("a|b", 1 / 3, 7), ("c, d", math.nan, None)], columns=NAMES, dtype=object)


def test_every_format_has_all_digits_and_says_what_is_missing() -> None:
    assert list(csv.reader(io.StringIO(csv_text(TABLE)))) == [NAMES, ["a|b", repr(1 / 3), "7"], ["c, d", "nan", "nan"]]
    assert csv_text(TABLE[1:2], missing="").splitlines()[1] == '"c, d",,'
    read = json.loads(json_text(records(TABLE)))
    assert [list(row.values()) for row in read] == [["a|b", 1 / 3, 7], ["c, d", None, None]]
    assert json.loads(json_text({"limit": math.inf})) == {"limit": None}
    assert markdown_lines(TABLE[:1].astype(str))[2].startswith("| a\\|b | 0.33")


@pytest.mark.parametrize(
    ("value", "begin"),
    [
        *((text, f"'{text[0]}") for text in ("=1+1", "+1", "-1", "@SUM(A1)")),
        *((text, "\\") for text in ("\t=1", "\r=1")),
        *((value, value) for value in (-1.5, -3, None, True, "1 = 2", "–", "", "'=1")),
    ],
)
def test_a_text_that_a_spreadsheet_would_compute_is_a_text_and_numbers_are_numbers(value, begin) -> None:
    cell = csv_cell(value)
    assert cell == begin or cell.startswith(begin)


HOSTILE = '=HYPERLINK("http://x")\x1b]0;owned\x07\r\n[red]\u202e'
"""What a spreadsheet would compute, a terminal obey, rich colour, and a reader see backwards."""


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
