"""What people see: tables that are cut off nowhere, progress in lines, and first compilations, said once."""

import io
import os
import subprocess
import sys
from pathlib import Path

import pytest
from rich.console import Console

from multibody_xval.reports.cli.compiling import NOTICE
from multibody_xval.scenarios.terminal_table import print_table, tracked

NAMES = ["exudyn-regularised:contact:default", "mujoco"]
NUMBERS = [[f"{row}.{column:04d}e-12" for column in range(14)] for row in range(2)]
HEADINGS = ["engine:formulation:preset", *(f"largest error no {column}" for column in range(14))]


ROOT = Path(__file__).parents[2]

SCRIPT = """
from reference_lcp.chain.mass_in_mass import Chain
from multibody_xval.reports.cli.compiling import announce_compilation
announce_compilation()
announce_compilation()
print(Chain.from_ratios().highest_natural_frequency)
"""

LIST_OF_COMPILED = """
from numba.core import event
with event.install_recorder("numba:compile") as recorder:
    from reference_lcp import Chain, HarmonicBase, steady_state
    chain = Chain.from_ratios(friction_ratio=0.3)
    steady_state(chain, HarmonicBase.from_ratio(chain, 0.9), with_error_bar=False)
for _, compiled in recorder.buffer:
    if compiled.is_start:
        print(compiled.data["dispatcher"].py_func.__module__, compiled.data["dispatcher"].py_func.__name__)
"""


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


@pytest.mark.parametrize(("missing", "tables"), [(0, 1), (1, 2)])
def test_a_table_as_wide_as_the_terminal_is_one_table(missing: int, tables: int) -> None:
    columns = ["mujoco", "1.2345678", "8.7654321"]
    width = sum(len(cell) + 2 for cell in columns) + 1
    lines = printed(["name", "a", "b"], [columns], width - missing)
    assert sum("mujoco" in line for line in lines) == tables


def test_texts_that_fit_are_not_wrapped() -> None:
    one, other = "as long as a sentence that is not short", "likewise, and longer by some words than the first one is"
    width = len("mujoco") + len(one) + len(other) + 7
    lines = printed(["name", "a", "b"], [["mujoco", one, other]], width)
    assert len([line for line in lines if one in line and other in line]) == 1


def test_what_controls_a_terminal_is_shown() -> None:
    assert any("\\x1b[31m [red]" in line for line in printed(["name", "n"], [["\x1b[31m [red]", "1"]], 80))


def test_items_are_all_given_and_no_bar_is_drawn_without_a_terminal(capsys) -> None:
    assert list(tracked(["a", "b"], "letters")) == ["a", "b"]
    assert capsys.readouterr().err == ""


def terminal_lines(cache: Path, *arguments: str) -> list[str]:
    """Run Python with its error stream in a terminal, and give the lines that arrive there."""
    reader, terminal = os.openpty()
    with subprocess.Popen(
        [sys.executable, *arguments], cwd=ROOT, env={**os.environ, "NUMBA_CACHE_DIR": str(cache)},
        stdout=subprocess.DEVNULL, stderr=terminal,
    ) as process:  # fmt: skip
        os.close(terminal)
        written = b""
        with os.fdopen(reader, "rb", buffering=0) as stream:
            try:
                while part := stream.read(4096):  # while it runs: a terminal that nobody reads is soon full
                    written += part
            except OSError:  # Linux ends a terminal that nobody holds like this
                pass
    assert process.returncode == 0
    return written.decode().splitlines()


@pytest.mark.slow
def test_a_terminal_is_told_of_the_first_compilation_once(tmp_path) -> None:
    assert terminal_lines(tmp_path, "-c", SCRIPT) == [NOTICE]
    assert terminal_lines(tmp_path, "-c", SCRIPT) == []


def test_a_pipe_is_not_told(tmp_path) -> None:
    done = subprocess.run(
        [sys.executable, "-c", SCRIPT], cwd=ROOT, env={**os.environ, "NUMBA_CACHE_DIR": str(tmp_path)},
        capture_output=True, text=True, check=True,
    )  # fmt: skip
    assert done.stderr == ""


@pytest.mark.slow  # compiles everything
def test_a_command_says_before_its_results_that_it_compiles(tmp_path) -> None:
    assert terminal_lines(tmp_path, "-m", "multibody_xval", "reference")[0] == NOTICE
    assert NOTICE not in terminal_lines(tmp_path, "-m", "multibody_xval", "reference")


@pytest.mark.slow  # compiles everything
def test_no_message_about_shapes_is_compiled_into_the_solvers(tmp_path) -> None:
    """An assignment of slices brings numba's formatting of texts with it, which takes longer than a solver."""
    done = subprocess.run(
        [sys.executable, "-c", LIST_OF_COMPILED], cwd=ROOT, env={**os.environ, "NUMBA_CACHE_DIR": str(tmp_path)},
        capture_output=True, text=True, check=True,
    )  # fmt: skip
    compiled = done.stdout.splitlines()
    assert "reference_lcp.schemes.euler_kernel advance" in compiled
    assert not [line for line in compiled if line.startswith("numba.cpython.unicode")]
