"""Tables: in full for programs, cut off nowhere for people, and no text is obeyed; first compilations are said."""

import csv
import io
import json
import math
import os
import subprocess
import sys
from pathlib import Path

import pandas as pd
import pytest
from rich.console import Console

from multibody_xval.reports.cli.compiling import NOTICE
from multibody_xval.scenarios.table_text import csv_cell, csv_text, json_text, markdown_lines, print_table, records
from multibody_xval.scenarios.terminal_table import print_table as print_rows

ROOT = Path(__file__).parents[2]

COLUMNS = ["name", "error_db", "points"]
TABLE = pd.DataFrame([("a|b", 1 / 3, 7), ("c, d", math.nan, None)], columns=COLUMNS, dtype=object)


def test_every_format_has_all_digits_and_says_what_is_missing() -> None:
    rows = list(csv.reader(io.StringIO(csv_text(TABLE))))
    assert rows == [COLUMNS, ["a|b", repr(1 / 3), "7"], ["c, d", "nan", "nan"]]
    assert csv_text(TABLE[1:2], missing="").splitlines()[1] == '"c, d",,'
    read = json.loads(json_text(records(TABLE)))
    assert [list(row.values()) for row in read] == [["a|b", 1 / 3, 7], ["c, d", None, None]]
    assert json.loads(json_text({"limit": math.inf})) == {"limit": None}
    assert markdown_lines(TABLE[:1].astype(str))[2].startswith("| a\\|b | 0.33")


def test_a_text_that_a_spreadsheet_would_compute_is_a_text_and_numbers_are_numbers() -> None:
    assert [csv_cell(text)[0] for text in ("=1+1", "+1", "-1", "@SUM(A1)", "\t=1", "\r=1")] == [*"''''", *"\\\\"]
    as_they_are = [-1.5, -3, None, True, "1 = 2", "–", "", "'=1"]
    assert list(map(csv_cell, as_they_are)) == as_they_are


HOSTILE = '=HYPERLINK("http://x")\x1b]0;owned\x07\r\n[red]\u202e'
"""What a spreadsheet would compute, a terminal obey, rich colour, and a reader see backwards."""


def test_no_control_character_of_a_stranger_reaches_a_terminal_or_a_file(capsys) -> None:
    whole = pd.DataFrame([(HOSTILE, -0.25, 1)], columns=COLUMNS, dtype=object)
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


def lines_of(headings: list[str], rows: list[list[str]], width: int) -> list[str]:
    console = Console(file=io.StringIO(), width=width)
    print_rows(headings, rows, console=console)
    return console.file.getvalue().splitlines()


NAMES = ["exudyn-regularised:contact:default", "mujoco"]
NUMBERS = [[f"{row}.{column:04d}e-12" for column in range(14)] for row in range(2)]
HEADINGS = ["engine:formulation:preset", *(f"largest error no {column}" for column in range(14))]


@pytest.mark.parametrize(("width", "tables"), [(60, 14), (80, 5), (120, 3), (500, 1)])
def test_no_line_is_wider_than_the_terminal_and_no_number_is_cut_off(width: int, tables: int) -> None:
    """Columns that do not fit follow in a table below, with the first column again."""
    lines = lines_of(HEADINGS, [[name, *row] for name, row in zip(NAMES, NUMBERS, strict=True)], width)
    assert max(map(len, lines)) <= width
    text = "\n".join(lines)
    assert all(number in text for row in NUMBERS for number in row)
    assert text.count("mujoco") == text.count(NAMES[0]) == tables


def test_long_texts_and_names_with_many_options_are_wrapped_and_all_of_them_is_there() -> None:
    reason = "does not converge at the points of the map where the contact sticks for most of the period"
    lines = lines_of(["name", "n", "reason"], [["mujoco", "3", reason]], 60)
    assert max(map(len, lines)) <= 60
    assert " ".join(" ".join(lines).replace("mujoco", "").replace("3", "").split()).endswith(reason)
    name = "exudyn-regularised:contact:default:relative_tolerance=1e-09:substeps=64:zone=0.0025"
    lines = lines_of(["engine:formulation:preset", "error"], [[name, "1.234e-05"]], 80)
    assert max(map(len, lines)) <= 80
    assert "1.234e-05" in "\n".join(lines)
    assert "".join(line.replace("1.234e-05", "").strip() for line in lines[3:]) == name


COMPILED = """
import sys
from numba.core import event
from multibody_xval.reports.cli.console_script import app
from multibody_xval.reports.cli.ending import run_command
sys.stderr.isatty = lambda: True
with event.install_recorder("numba:compile") as recorder:
    assert run_command(app, ["reference"]) == 0
for module in sorted({own.data["dispatcher"].py_func.__module__ for _, own in recorder.buffer}):
    print(module)
"""
"""Runs a command as if in a terminal, and prints the modules of what has been compiled for it."""


@pytest.mark.slow  # compiles everything
def test_a_terminal_is_told_of_the_first_compilation_once_and_no_message_about_shapes_is_compiled(tmp_path) -> None:
    """An assignment of slices brings numba's formatting of texts with it, which takes longer than a solver."""
    words, environment = [sys.executable, "-c", COMPILED], {**os.environ, "NUMBA_CACHE_DIR": str(tmp_path)}
    first, second = (
        subprocess.run(words, cwd=ROOT, env=environment, capture_output=True, text=True, check=True) for _ in range(2)
    )
    assert first.stderr.splitlines()[0] == NOTICE
    assert NOTICE not in second.stderr
    compiled = first.stdout.splitlines()
    assert "reference_lcp.schemes.euler_kernel" in compiled
    assert not [module for module in compiled if module.startswith("numba.cpython.unicode")]
