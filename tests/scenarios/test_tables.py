"""Tables: in full for programs, cut off nowhere for people; first compilations are said."""

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
from multibody_xval.scenarios.table_text import csv_cell, csv_text, json_text, markdown_lines, records
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


def lines_of(headings: list[str], rows: list[list[str]], width: int) -> list[str]:
    console = Console(file=io.StringIO(), width=width)
    print_rows(headings, rows, console=console)
    return console.file.getvalue().splitlines()


NAMES = ["exudyn-regularised:contact:default", "mujoco"]
NUMBERS = [[f"{row}.{column:04d}e-12" for column in range(14)] for row in range(2)]
HEADINGS = ["engine:formulation:preset", *(f"largest error no {column}" for column in range(14))]
OPTIONS = "exudyn-regularised:contact:default:relative_tolerance=1e-09:substeps=64:zone=0.0025"


@pytest.mark.parametrize(("width", "tables"), [(60, 14), (500, 1)])
def test_no_line_is_wider_than_the_terminal_and_nothing_is_cut_off(width: int, tables: int) -> None:
    """Columns that do not fit follow in a table below, with the first column again; long names are wrapped."""
    lines = lines_of(HEADINGS, [[name, *row] for name, row in zip(NAMES, NUMBERS, strict=True)], width)
    assert max(map(len, lines)) <= width
    text = "\n".join(lines)
    assert all(number in text for row in NUMBERS for number in row)
    assert text.count("mujoco") == text.count(NAMES[0]) == tables
    lines = lines_of(["engine:formulation:preset", "error"], [[OPTIONS, "1.234e-05"]], 80)
    assert max(map(len, lines)) <= 80
    assert "".join(line.strip() for line in lines[3:]).replace(" ", "").replace("1.234e-05", "") == OPTIONS


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
