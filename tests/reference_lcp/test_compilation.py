"""The first compilation is said in a terminal, once, and nowhere else."""

import os
import subprocess
import sys
from pathlib import Path

import pytest

from reference_lcp.compilation import NOTICE

ROOT = Path(__file__).parents[2]

SCRIPT = """
from reference_lcp.chain.mass_in_mass import Chain
from reference_lcp.compilation import announce_compilation
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
    assert terminal_lines(tmp_path, "-m", "reference_lcp")[0] == NOTICE
    assert NOTICE not in terminal_lines(tmp_path, "-m", "reference_lcp")


@pytest.mark.slow  # compiles everything
def test_no_message_about_shapes_is_compiled_into_the_solvers(tmp_path) -> None:
    """An assignment of slices brings numba's formatting of texts with it, which takes longer than a solver."""
    done = subprocess.run(
        [sys.executable, "-c", LIST_OF_COMPILED], cwd=ROOT, env={**os.environ, "NUMBA_CACHE_DIR": str(tmp_path)},
        capture_output=True, text=True, check=True,
    )  # fmt: skip
    compiled = done.stdout.splitlines()
    assert "reference_lcp.stepping.euler_kernel advance" in compiled
    assert not [line for line in compiled if line.startswith("numba.cpython.unicode")]
