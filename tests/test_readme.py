"""The README's examples and commands run as they stand, and its numbers are those of the tables."""

import re
import shlex
from pathlib import Path

import pytest

from reference_lcp.console import run_command
from tests.test_help import COMMANDS
from tests.test_mistakes import APPS

ROOT = Path(__file__).parents[1]
README = (ROOT / "README.md").read_text()
EXAMPLES = re.findall(r"```python\n(.*?)```", README, flags=re.DOTALL)
LINES = [line for block in re.findall(r"```console\n(.*?)```", README, flags=re.DOTALL) for line in block.splitlines()]
SUITE = [line for line in LINES if line.startswith("python -m ") and "sphinx" not in line]

LONG = ("python -m scenarios run all", "python -m scenarios run accuracy")
"""What takes minutes on every engine: run by CI on a small case, and by who wants the tables."""


def test_examples_run_in_order(capsys: pytest.CaptureFixture[str], tmp_path: Path, monkeypatch) -> None:
    monkeypatch.chdir(tmp_path)
    names: dict[str, object] = {"__name__": "__main__"}
    for example in EXAMPLES:
        exec(compile(example, "README.md", "exec"), names)
    printed = capsys.readouterr().out
    assert re.search(r"-9\.56\d ± 0\.00\d dB, residual \d+e-\d+", printed)
    assert "agree, difference" in printed
    assert (tmp_path / "my_report" / "index.html").stat().st_size > 10_000


def test_three_uses_have_an_example_each() -> None:
    assert len(EXAMPLES) == 3
    assert all(len(example.strip().splitlines()) <= 14 for example in EXAMPLES)


def test_every_command_is_one_of_the_suite() -> None:
    for line in SUITE:
        words = shlex.split(line.split(" > ")[0])[:5]
        assert any(" ".join(words[:n]) in COMMANDS for n in (3, 4, 5)), line


@pytest.mark.slow
def test_every_command_runs_in_order(tmp_path: Path, monkeypatch, capsys: pytest.CaptureFixture[str]) -> None:
    """In one folder, as a reader would type them; what needs a first run of the report has a quick one."""
    monkeypatch.chdir(tmp_path)
    assert run_command(APPS["reports"], ["--quick", "--engine", "mujoco"]) == 0
    for folder in ("before", "now"):
        (tmp_path / folder).mkdir()
        (tmp_path / folder / "results.sqlite").write_bytes((tmp_path / "report" / "results.sqlite").read_bytes())
    for line in SUITE:
        if line.startswith(LONG):
            continue
        command, _, file = line.partition(" > ")
        _, _, name, *arguments = shlex.split(command)
        capsys.readouterr()
        assert run_command(APPS[name], arguments) == 0, line
        if file:
            (tmp_path / file).write_text(capsys.readouterr().out)


def test_errors_in_the_table_of_engines_are_those_of_the_measured_table() -> None:
    measured = {}
    for line in (ROOT / "docs" / "accuracy.md").read_text().splitlines():
        cells = [cell.strip() for cell in line.strip("|").split("|")]
        if len(cells) > 6 and cells[1] == "joint":
            measured[cells[0], cells[2]] = cells[5]
    rows = re.findall(r"^\| ([A-Z]?[^|]+?) \|.*\| ([\d.]+) → ([\d.]+) dB \|", README, flags=re.MULTILINE)
    names = {row[0].split(" (")[0].replace(", ", "-").lower(): row[1:] for row in rows}
    assert len(names) == 11
    for name, (default, tuned) in names.items():
        assert (default, tuned) == (measured[name, "default"], measured[name, "tuned"]), name
