"""Tables on a terminal: nothing is cut off, and nothing is wider than the terminal."""

import io

import pytest
from rich.console import Console

from reference_lcp.terminal_table import print_table

NAMES = ["exudyn-regularised:contact:default", "mujoco"]
NUMBERS = [[f"{row}.{column:04d}e-12" for column in range(14)] for row in range(2)]
HEADINGS = ["engine:formulation:preset", *(f"largest error no {column}" for column in range(14))]


def printed(headings, rows, width: int) -> list[str]:
    console = Console(file=io.StringIO(), width=width)
    print_table(headings, rows, console=console)
    return console.file.getvalue().splitlines()


@pytest.mark.parametrize("width", [60, 80, 120, 500])
def test_no_line_is_wider_than_the_terminal_and_no_number_is_cut_off(width: int) -> None:
    lines = printed(HEADINGS, [[name, *row] for name, row in zip(NAMES, NUMBERS, strict=True)], width)
    assert max(map(len, lines)) <= width
    text = "\n".join(lines)
    assert all(number in text for row in NUMBERS for number in row)
    assert text.count("mujoco") == text.count(NAMES[0])


def test_a_table_that_fits_is_one_table() -> None:
    lines = printed(HEADINGS, [[NAMES[0], *NUMBERS[0]]], 500)
    assert sum(NAMES[0] in line for line in lines) == 1


def test_texts_are_wrapped_at_spaces_and_all_of_them_is_there() -> None:
    reason = "does not converge at the points of the map where the contact sticks for most of the period"
    lines = printed(["name", "n", "reason"], [["mujoco", "3", reason]], 60)
    assert max(map(len, lines)) <= 60
    words = " ".join(lines).replace("mujoco", "").replace("3", "").split()
    assert " ".join(words).endswith(reason)


def test_a_name_with_many_options_is_wrapped_and_does_not_push_the_numbers_out() -> None:
    name = "exudyn-regularised:contact:default:relative_tolerance=1e-09:substeps=64:zone=0.0025"
    lines = printed(["engine:formulation:preset", "error"], [[name, "1.234e-05"]], 80)
    assert max(map(len, lines)) <= 80
    assert "1.234e-05" in "\n".join(lines)
    assert "".join(line.replace("1.234e-05", "").strip() for line in lines[3:]) == name


def test_what_controls_a_terminal_is_shown() -> None:
    assert any("\\x1b[31m [red]" in line for line in printed(["name", "n"], [["\x1b[31m [red]", "1"]], 80))
