"""The README is short, its examples and commands run as they stand, and its numbers are those of the tables."""

import os
import re
import shlex
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

from multibody_xval.engines import engine
from multibody_xval.engines.interface.variant import Variant
from multibody_xval.reports.cli import console_script
from multibody_xval.reports.cli.ending import run_command
from multibody_xval.reports.formatting import MISSING, significant
from multibody_xval.reports.page import tables
from multibody_xval.scenarios import report_plan
from multibody_xval.scenarios.compute.batch import run_batch
from multibody_xval.scenarios.plan import runs_at
from multibody_xval.scenarios.report_plan import HEADLINE, HEADLINE_STEPS, PRESETS
from multibody_xval.scenarios.result_tables import now, points
from multibody_xval.scenarios.ruler.judge import OTHER_SCHEMES, judged

ROOT = Path(__file__).parents[1]
README, ACCURACY = ((ROOT / name).read_text(encoding="utf-8") for name in ("README.md", "docs/accuracy.md"))
EXAMPLES = re.findall(r"```python\n(.*?)```", README, flags=re.DOTALL)
LINES = [line for block in re.findall(r"```console\n(.*?)```", README, flags=re.DOTALL) for line in block.splitlines()]
SUITE = [line for line in LINES if line.startswith("multibody-xval ")]


@pytest.mark.slow
@pytest.mark.parametrize("example", EXAMPLES)
def test_every_example_runs_by_itself(example, tmp_path: Path) -> None:
    """In a process of its own, as a file in an empty folder."""
    (tmp_path / "example.py").write_text(example, encoding="utf-8")
    done = subprocess.run(
        [sys.executable, "example.py"], env={**os.environ, "MPLBACKEND": "Agg", "PYTHONPATH": str(ROOT)},
        cwd=tmp_path, capture_output=True, text=True, check=False,
    )  # fmt: skip
    assert done.returncode == 0, done.stderr
    assert "agree" in done.stdout
    assert (tmp_path / "my_report" / "index.html").stat().st_size > 10_000


@pytest.fixture
def two_points(monkeypatch: pytest.MonkeyPatch):
    """The grid of `report --quick` has two points."""
    monkeypatch.setattr(report_plan, "QUICK_FRICTION_RATIOS", (0.3,))
    monkeypatch.setattr(report_plan, "QUICK_FREQUENCY_RATIOS", (0.6, 0.9))
    report_plan.grid.cache_clear()
    yield
    report_plan.grid.cache_clear()


@pytest.mark.slow
@pytest.mark.usefixtures("two_points")
def test_every_command_runs_in_order(tmp_path: Path, monkeypatch, capsys: pytest.CaptureFixture[str]) -> None:
    """In one folder, as a reader would type them; reports have two points, since `.ci/run` writes one with all."""
    monkeypatch.chdir(tmp_path)
    assert len(SUITE) >= 5
    for line in SUITE:
        command, _, file = line.partition(" > ")
        if "compare" in command:
            for folder in ("before", "now"):
                shutil.copytree("report", folder)
        _, *arguments = shlex.split(command)
        capsys.readouterr()
        assert run_command(console_script.app, arguments) == 0, line
        if file:
            Path(file).write_text(capsys.readouterr().out)


UNSTEADY = "not periodic"

NO_CURE = f" ({tables.NO_CURE})"
"""After an error that a recipe leaves."""


def cell(size: float, known: int, every: int) -> str:
    """Give the largest error in two digits, with a star where points are not known, as the README has it."""
    if 0 < 3 * known < every:
        return UNSTEADY
    return significant(size) + "*" * (known < every) if known else MISSING


def measured() -> dict[tuple[str, str, str], str]:
    """Give the text of the largest error by engine, formulation and preset, from the measured table."""
    rows = [[cell.strip() for cell in line.strip("|").split("|")] for line in ACCURACY.splitlines()]
    own = [row for row in rows if len(row) > 6 and row[1] in {"joint", "contact"} and row[0] != "reference"]
    return {(row[0], row[1], row[2]): cell(float(row[5]), *map(int, row[-1].split("/"))) for row in own}


def is_no_cure(name: tuple[str, str, str], text: str) -> bool:
    """Tell whether a recipe leaves more than twice the error of the reference with as many steps, or never settles."""
    if name[2] != "recommended" or text == MISSING:
        return False
    (reference,) = re.findall(r"^\| reference \| joint \| tuned \| [^|]* \| [^|]* \| ([\d.]+)", ACCURACY, re.MULTILINE)
    return text == UNSTEADY or float(text.rstrip("*")) > OTHER_SCHEMES * float(reference)


def measured_errors() -> dict[tuple[str, str], str]:
    """Give the text of each cell of the README's table by engine and formulation."""
    cells = {name: text.replace("*", r"\*") + NO_CURE * is_no_cure(name, text) for name, text in measured().items()}
    pairs = {name[:2] for name in cells}
    return {pair: " → ".join(cells.get((*pair, preset), "–") for preset in PRESETS) for pair in pairs}


def test_errors_in_the_table_of_results_are_those_of_the_measured_table() -> None:
    measured = measured_errors()
    titles = {engine(name).capabilities.title: name for name, _ in measured}
    rows = [[cell.strip() for cell in line.strip("|").split("|")] for line in README.splitlines() if " → " in line]
    shown = {row[0]: row[1:3] for row in rows if row[0] in titles}
    assert set(shown) == set(titles)
    for title, cells in shown.items():
        expected = [measured.get((titles[title], formulation), "–") for formulation in ("joint", "contact")]
        assert cells == expected, title


def test_numbers_of_the_first_sentence_are_those_of_the_measured_table() -> None:
    default, recommended, tuned = measured_errors()["mujoco", "joint"].split(" → ")
    assert recommended == tuned
    shown, factor = " ".join(README.split()), 10 ** (float(default) / 20)
    assert f"changes the vibration amplitude by up to {default} dB (a factor of {factor:.2g})" in shown
    assert f"the error is {tuned} dB ({100 * (10 ** (float(tuned) / 20) - 1):.2g} %)" in shown


def test_the_largest_error_of_the_map_is_at_one_of_the_headlines_points() -> None:
    """So that five points of a report give the number of the whole map."""
    quoted = {name for name, text in measured().items() if name[2] in PRESETS and text != UNSTEADY}
    worst = re.findall(r"^- ([\w:@=-]+): worst at \(([\d.]+), ([\d.]+)\)", ACCURACY, re.MULTILINE)
    variants = {Variant.parse(name): (float(friction), float(eta)) for name, friction, eta in worst}
    places = [at for own, at in variants.items() if (own.engine, own.formulation, own.preset_name) in quoted]
    assert len(places) > 60
    assert set(places) <= {(case.friction_ratio, case.frequency_ratio) for case in HEADLINE}


@pytest.mark.slow
@pytest.mark.needs("mujoco")
def test_readme_page_and_documentation_have_one_number() -> None:
    variants = [Variant("mujoco", "joint", preset) for preset in ("default", "tuned")]
    table = points(now({run: run_batch([run])[0] for run in runs_at(variants, HEADLINE, HEADLINE_STEPS)}))
    rows = tables.at_headline(tables.engines_only(tables.labelled(judged(table))))
    (line,) = tables.headline(tables.largest_errors(rows)).to_dict("records")
    cell = measured_errors()["mujoco", "joint"].split(" → ")
    shown = [line[title].partition(" (")[0] for title in ("default options", "tuned to the chain")]
    assert shown == [text.removesuffix(r"\*") for text in (cell[0], cell[2])]
