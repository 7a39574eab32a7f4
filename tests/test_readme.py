"""The README's examples and commands run as they stand, and its numbers are those of the tables."""

import re
import shlex
from pathlib import Path

import matplotlib.pyplot as plt
import pytest

from reference_lcp.console import run_command
from reports.cli import console_script
from tests.test_help import COMMANDS

ROOT = Path(__file__).parents[1]
README = (ROOT / "README.md").read_text()
EXAMPLES = re.findall(r"```python\n(.*?)```", README, flags=re.DOTALL)
LINES = [line for block in re.findall(r"```console\n(.*?)```", README, flags=re.DOTALL) for line in block.splitlines()]
SUITE = [line for line in LINES if line.startswith("multibody-xval ")]

LONG = ("multibody-xval run all", "multibody-xval run accuracy")
"""What takes minutes on every engine: run by CI on a small case, and by who wants the tables."""


def test_every_example_runs_by_itself(capsys: pytest.CaptureFixture[str], tmp_path: Path, monkeypatch) -> None:
    printed = []
    for number, example in enumerate(EXAMPLES):
        folder = tmp_path / str(number)
        folder.mkdir()
        monkeypatch.chdir(folder)
        exec(compile(example, "README.md", "exec"), {"__name__": "__main__"})
        printed.append(capsys.readouterr().out)
    plt.close("all")
    steady, checked, _ = printed
    assert re.search(r"-9\.56\d ± 0\.00\d dB, residual \d+e-\d+", steady)
    assert "agree, difference" in checked
    assert (tmp_path / "2" / "my_report" / "index.html").stat().st_size > 10_000


def test_three_uses_have_an_example_each() -> None:
    assert len(EXAMPLES) == 3
    assert all(len(example.strip().splitlines()) <= 14 for example in EXAMPLES)
    assert not any(word in "".join(EXAMPLES) for word in ("__main__", "with ", "Evaluator", "Executor", "Store("))


def test_every_command_is_one_of_the_suite() -> None:
    assert {line.split()[1] for line in SUITE} >= {*console_script.COMMANDS} - {"engines"}
    for line in SUITE:
        _, name, *words = shlex.split(line.split(" > ")[0])
        path = ["python", "-m", *console_script.COMMANDS[name][0].split(), *words]
        assert any(" ".join(path[:n]) in COMMANDS for n in (3, 4, 5)), line


@pytest.mark.slow
def test_every_command_runs_in_order(tmp_path: Path, monkeypatch, capsys: pytest.CaptureFixture[str]) -> None:
    """In one folder, as a reader would type them; what needs a first run of the report has a quick one."""
    monkeypatch.chdir(tmp_path)
    assert run_command(console_script.app, ["report", "--quick", "--engine", "mujoco"]) == 0
    for folder in ("before", "now"):
        (tmp_path / folder).mkdir()
        (tmp_path / folder / "results.sqlite").write_bytes((tmp_path / "report" / "results.sqlite").read_bytes())
    for line in SUITE:
        if line.startswith(LONG):
            continue
        command, _, file = line.partition(" > ")
        _, *arguments = shlex.split(command)
        capsys.readouterr()
        assert run_command(console_script.app, arguments) == 0, line
        if file:
            (tmp_path / file).write_text(capsys.readouterr().out)


def test_errors_in_the_table_of_engines_are_those_of_the_measured_table() -> None:
    measured = {}
    for line in (ROOT / "docs" / "accuracy.md").read_text().splitlines():
        cells = [cell.strip() for cell in line.strip("|").split("|")]
        if len(cells) > 6 and cells[1] == "joint":
            measured[cells[0], cells[2]] = cells[5]
    rows = re.findall(r"^\| ([A-Z]?[^|]+?) \|.*\| ([\d.]+) → ([\d.]+) dB \|", README, flags=re.MULTILINE)
    names = {row[0].split(" (")[0].replace(", ", "-").replace(" ", "-").lower(): row[1:] for row in rows}
    assert len(names) == 18
    for name, (default, tuned) in names.items():
        assert (default, tuned) == (measured[name, "default"], measured[name, "tuned"]), name
