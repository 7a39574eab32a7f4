"""Exit codes of commands: what is wrong is one line, before any work."""

import os
import re
import subprocess
import sys
from pathlib import Path

import pytest

from multibody_xval.engines.mujoco import MuJoCo
from multibody_xval.reports.cli.console_script import app
from multibody_xval.reports.cli.ending import run_command
from multibody_xval.reports.cli.exit_code import ExitCode
from multibody_xval.scenarios.sweeps.file import EXAMPLE
from tests.scenarios.stores import CASE, OTHER, with_bound, write_store

ROOT = Path(__file__).parents[1]

REFERENCE = "reference --cells 1 --frequency-ratio 0.9"


def code_of(line: str) -> int:
    """Run a command line without the name of the program."""
    name, *arguments = line.split()
    return run_command(app, [name, *arguments])


@pytest.fixture
def stores(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Two stores, of which the second has lost a result."""
    monkeypatch.chdir(tmp_path)
    both = {CASE: with_bound(1.0), OTHER: with_bound(1.0, OTHER)}
    for name, results in (("before", both), ("now", {OTHER: both[OTHER]})):
        write_store(Path(f"{name}.sqlite"), results)


@pytest.mark.parametrize(
    ("line", "code"),
    [
        (REFERENCE, ExitCode.DONE),
        (f"{REFERENCE} --max-periods 1", ExitCode.FAILED),
        ("compare before.sqlite before.sqlite", ExitCode.DONE),
        ("compare before.sqlite now.sqlite", ExitCode.FAILED),
        ("compare before.sqlite none.sqlite", ExitCode.WRONG_INPUT),
        ("sweep sweep.toml --no-run --retry-failed", ExitCode.WRONG_INPUT),
    ],
)
def test_commands_end_with_their_codes(stores, line, code, capsys) -> None:
    assert code_of(line) == code
    assert len(capsys.readouterr().err.splitlines()) == (code == ExitCode.WRONG_INPUT)


def written_to(output: int) -> tuple[int, str]:
    """Run a command whose standard output is this; give its exit code and what it complains of."""
    words = [sys.executable, "-m", "multibody_xval", "--help"]
    done = subprocess.run(words, cwd=ROOT, stdout=output, stderr=subprocess.PIPE, text=True, check=False)
    return done.returncode, done.stderr


def test_a_reader_that_has_enough_ends_a_command_silently_and_a_full_disk_with_a_line() -> None:
    reader, writer = os.pipe()
    os.close(reader)
    assert written_to(writer) == (ExitCode.READER_GONE, "")
    os.close(writer)
    with Path("/dev/full").open("w") as full:
        code, error = written_to(full.fileno())
    assert code == ExitCode.RUN_FAILED
    assert error == "error: standard output cannot be written: No space left on device\n"


NAMED = [
    "report --engine mujoco:joint:default", "reproduce mujoco:joint:default static-hold",
    "run all --engine reference --engine mujoco", "run accuracy --engine mujoco", "sweep named.toml",
]  # fmt: skip


@pytest.mark.parametrize("line", NAMED)
def test_an_engine_that_is_named_and_missing_is_wrong_input_before_any_work(stores, monkeypatch, capsys, line) -> None:
    Path("named.toml").write_text(EXAMPLE)
    before = set(Path().iterdir())
    monkeypatch.setattr(MuJoCo, "unavailable_reason", lambda _: "no wheel")
    assert code_of(line) == ExitCode.WRONG_INPUT
    assert "engine = mujoco is not installed: no wheel" in capsys.readouterr().err
    assert set(Path().iterdir()) == before


class Panic(BaseException):
    """As engines in Rust raise it: no `Exception`."""


@pytest.mark.parametrize("kind", [ZeroDivisionError, Panic, SystemExit])
def test_a_fault_of_the_suite_has_a_code_of_its_own_one_line_and_its_details(monkeypatch, capsys, kind) -> None:
    def faulty(_name: str) -> None:
        raise kind("a\nfault\x1b[2J")

    monkeypatch.setattr("multibody_xval.engines.interface.registry.broken_reason", faulty)
    assert run_command(app, ["engines"]) == ExitCode.UNEXPECTED
    line = rf"error: a fault of the suite, {kind.__name__}: a fault\\x1b\[2J; details, .*: (\S+)\n"
    details = Path(re.fullmatch(line, capsys.readouterr().err)[1])
    assert "in faulty" in details.read_text()
    details.unlink()
