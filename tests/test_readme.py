"""The README is short, its examples print what it shows, and its numbers are those of the tables; so do all pages."""

import os
import re
import subprocess
import sys
from pathlib import Path

import pandas as pd
import pytest

from multibody_xval.engines.interface.variant import Variant
from multibody_xval.reports.page import tables
from multibody_xval.scenarios.compute.batch import run_batch
from multibody_xval.scenarios.plan import runs_at
from multibody_xval.scenarios.report_plan import HEADLINE, HEADLINE_STEPS, PRESETS
from multibody_xval.scenarios.result_tables import now, points
from multibody_xval.scenarios.ruler.judge import judged

from .programs import program

ROOT = Path(__file__).parents[1]
README = (ROOT / "README.md").read_text(encoding="utf-8")
ACCURACY = pd.read_csv(ROOT / "docs/results/accuracy.csv").set_index(["engine", "formulation", "preset"])
ERROR, WORST = "map, 800 [dB]", "worst at friction ratio, frequency ratio"

WITH_EXAMPLES = [
    path
    for path in [ROOT / "README.md", *sorted((ROOT / "docs").rglob("*.md"))]
    if "<!-- run -->" in path.read_text("utf-8")
]


def test_the_readme_is_short_and_all_its_commands_are_run() -> None:
    assert len(README.splitlines()) <= 110
    of_a_fresh_machine, *others = re.findall(r"(.*)\n```(?:console|python)\n(.*)", README)
    assert of_a_fresh_machine[1].startswith("python3 -m venv")
    assert len(others) >= 5
    assert {before for before, _ in others} == {"<!-- run -->"}


@pytest.mark.slow
@pytest.mark.needs("mujoco")
@pytest.mark.parametrize("page", WITH_EXAMPLES, ids=lambda page: page.name)
def test_examples_print_what_the_page_shows(page: Path) -> None:
    """`python docs/outputs.py PAGE` writes it anew."""
    command = [sys.executable, str(ROOT / "docs/outputs.py"), "--check", str(page)]
    done = subprocess.run(
        command, env=os.environ | {"PYTHONPATH": str(ROOT)}, capture_output=True, text=True, check=False
    )
    assert done.returncode == 0, done.stdout + done.stderr


def test_an_output_with_another_word_or_number_is_found() -> None:
    alike = program("outputs").alike
    assert alike("drift 4,696 µm/s (30 s; page)", "drift  4,700 µm/s (31.5 s; page)")
    assert not alike("drift 4,696 µm/s", "drift 4,996 µm/s")
    assert not alike("drift −4,696 µm/s", "drift 4,696 µm/s")
    assert not alike("drift 4,696 µm/s", "drift 4,696 mm/s")


def test_mujoco_s_numbers_in_the_readme_are_those_of_the_measured_table() -> None:
    default, recipe = (ACCURACY.loc[("mujoco", "joint", preset), ERROR] for preset in ("default", "recommended"))
    text = " ".join(README.split())
    assert (
        f"{default:.2g} dB off with default options (a factor of {10 ** (default / 20):.2g}), {recipe:.2g} with" in text
    )
    scheme = ACCURACY.loc[("reference", "joint", "tuned"), ERROR]
    at = text.index(f"{scheme:.2g} dB, the error of the time step")
    assert f"is {100 * (10 ** (scheme / 20) - 1):.2g} %" in text[at:]


def test_the_largest_error_of_the_map_is_at_one_of_the_headlines_points() -> None:
    """So that five points of a report give the number of the whole map."""
    own = ACCURACY[ACCURACY[WORST].notna() & (ACCURACY.index.get_level_values("engine") != "reference")]
    own = own[own.index.get_level_values("preset").isin(PRESETS)]
    known = own.periodic.str.split("/", expand=True).astype(int)
    places = {tuple(map(float, at.split(", "))) for at in own[WORST][3 * known[0] >= known[1]]}
    assert len(own) > 60
    assert places <= {(case.friction_ratio, case.frequency_ratio) for case in HEADLINE}


@pytest.mark.slow
@pytest.mark.needs("mujoco")
def test_page_of_a_report_and_documentation_have_one_number() -> None:
    variants = [Variant("mujoco", "joint", preset) for preset in ("default", "tuned")]
    table = points(now({run: run_batch([run])[0] for run in runs_at(variants, HEADLINE, HEADLINE_STEPS)}))
    rows = tables.at_headline(tables.engines_only(tables.labelled(judged(table))))
    (line,) = tables.headline(tables.largest_errors(rows)).to_dict("records")
    (row,) = (line for line in program("tables").errors() if line.startswith("| MuJoCo |"))
    shown = [cell.strip() for cell in row.split("|")]
    assert [line[title].partition(" (")[0] for title in ("default options", "tuned to the chain")] == [
        shown[2],
        shown[4],
    ]
