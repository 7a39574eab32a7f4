"""The README is short, its examples and commands run as they stand, and its numbers are those of the tables."""

import os
import re
import shlex
import subprocess
import sys
from pathlib import Path

import pytest

from engines import engine
from reference_lcp.process import run_command
from reports.cli import console_script
from tests.test_help import COMMANDS

ROOT = Path(__file__).parents[1]
README = (ROOT / "README.md").read_text(encoding="utf-8")
EXAMPLES = re.findall(r"```python\n(.*?)```", README, flags=re.DOTALL)
LINES = [line for block in re.findall(r"```console\n(.*?)```", README, flags=re.DOTALL) for line in block.splitlines()]
SUITE = [line for line in LINES if line.startswith("multibody-xval ")]

MOST_LINES = 120
"""Two screens."""


def test_readme_fits_two_screens() -> None:
    assert len(README.splitlines()) <= MOST_LINES


def run_alone(example: str, folder: Path) -> str:
    """Run an example in a process of its own, as a file in an empty folder; give what it prints."""
    file = folder / "example.py"
    file.write_text(example, encoding="utf-8")
    environment = {**os.environ, "MPLBACKEND": "Agg", "PYTHONPATH": str(ROOT)}
    done = subprocess.run(
        [sys.executable, file.name], cwd=folder, env=environment, capture_output=True, text=True, check=False
    )
    assert done.returncode == 0, done.stderr
    return done.stdout


@pytest.mark.parametrize("example", EXAMPLES)
def test_every_example_runs_by_itself(example, tmp_path: Path) -> None:
    printed = run_alone(example, tmp_path)
    assert "agree" in printed
    assert (tmp_path / "my_report" / "index.html").stat().st_size > 10_000


def test_an_example_that_needs_another_one_is_found(tmp_path: Path) -> None:
    with pytest.raises(AssertionError, match="NameError"):
        run_alone("print(data)\n", tmp_path)


def test_examples_are_short_and_need_no_inner_modules() -> None:
    assert EXAMPLES
    assert all(len(example.strip().splitlines()) <= 14 for example in EXAMPLES)
    assert not any(word in "".join(EXAMPLES) for word in ("__main__", "with ", "Evaluator", "Executor", "Store("))


def test_two_lines_set_up_a_fresh_machine_and_ci_runs_them_as_they_stand() -> None:
    report, tests = [line for line in LINES if line.startswith("python3 -m venv ")]
    assert report.endswith("pip install . && multibody-xval report --quick")
    assert tests.endswith("pip install '.[test]' && python -m pytest")
    assert "grep '^python3 -m venv' README.md" in (ROOT / ".ci" / "run").read_text(encoding="utf-8")


def test_every_command_is_one_of_the_suite() -> None:
    assert len(SUITE) >= 8
    for line in SUITE:
        words = shlex.split(line.split(" > ")[0])
        assert any(" ".join(words[:n]) in COMMANDS for n in (2, 3, 4)), line


@pytest.mark.slow
def test_every_command_runs_in_order(tmp_path: Path, monkeypatch, capsys: pytest.CaptureFixture[str]) -> None:
    """In one folder, as a reader would type them."""
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("MULTIBODY_XVAL_ENVIRONMENTS", str(tmp_path / "environments"))
    for line in SUITE:
        command, _, file = line.partition(" > ")
        if "compare" in command:
            for folder in ("before", "now"):
                (tmp_path / folder).mkdir()
                (tmp_path / folder / "results.sqlite").write_bytes(
                    (tmp_path / "report" / "results.sqlite").read_bytes()
                )
        _, *arguments = shlex.split(command)
        capsys.readouterr()
        assert run_command(console_script.app, arguments) == 0, line
        if file:
            (tmp_path / file).write_text(capsys.readouterr().out)


def test_links_lead_to_files() -> None:
    links = re.findall(r"\]\(([^)#]+)\)", README)
    assert len(links) > 8
    assert [link for link in links if not link.startswith("http") and not (ROOT / link).is_file()] == []


def measured_errors() -> dict[tuple[str, str], str]:
    """Give the text of each cell of the README's table by engine and formulation, from the measured table."""
    cells: dict[tuple[str, str, str], str] = {}
    for line in (ROOT / "docs" / "accuracy.md").read_text(encoding="utf-8").splitlines():
        row = [cell.strip() for cell in line.strip("|").split("|")]
        if len(row) > 6 and row[1] in {"joint", "contact"} and row[0] != "reference":
            certified, points = row[-3].split("/")
            error = row[5] + ("" if certified == points else r"\*")
            steady = 2 * int(certified) >= int(points)
            cells[row[0], row[1], row[2]] = error if steady else "unsteady"
    pairs = {name[:2] for name in cells}
    presets = ("default", "recommended", "tuned")
    return {pair: " → ".join(cells.get((*pair, preset), "–") for preset in presets) for pair in pairs}


def test_errors_in_the_table_of_results_are_those_of_the_measured_table() -> None:
    measured = measured_errors()
    titles = {engine(name).capabilities.title: name for name, _ in measured}
    rows = [[cell.strip() for cell in line.strip("|").split("|")] for line in README.splitlines() if " → " in line]
    shown = {row[0]: row[1:3] for row in rows if row[0] in titles}
    assert set(shown) == set(titles)
    for title, cells in shown.items():
        expected = [measured.get((titles[title], formulation), "–") for formulation in ("joint", "contact")]
        assert cells == expected, title


def test_number_of_the_first_sentence_is_that_of_the_measured_table() -> None:
    error = float(measured_errors()["mujoco", "joint"].split()[0])
    assert f"joint friction is {error:.1f} dB off" in " ".join(README.split())
