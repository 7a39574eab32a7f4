"""The paper's claims: on the reference, with the published edges, and on bands made by hand."""

import math
from collections.abc import Mapping
from pathlib import Path

import pandas as pd
import pytest

from multibody_xval.scenarios.compute.batch import run_batch
from multibody_xval.scenarios.edges import edges, propose
from multibody_xval.scenarios.model import REFERENCE, Case, Config, Result, Run, Status, failed, linear_limits
from multibody_xval.scenarios.report_plan import FRICTION_RATIOS
from multibody_xval.scenarios.result_tables import CONFIG, points
from multibody_xval.scenarios.store import Stored
from multibody_xval.scenarios.studies import claims as study

ROOT = Path(__file__).parents[3]

TUNED, DEFAULT = Config("mujoco"), Config("mujoco", preset_name="default")

LOWER = {0.0: 0.8526, 0.1: 0.7532, 0.3: 0.6373, 0.6: 0.7560, 1.0: 0.9988, 5.0: 1.1726}
"""Published edges; those of free and of locked cells are where the linear chain's level is 0 dB."""
UPPER = {f: math.inf if f else math.sqrt(2) for f in FRICTION_RATIOS}
STUCK = {0.0: 0.0, 0.1: 0.48, 0.3: 0.48, 0.6: 0.52, 1.0: 0.99, 5.0: 1.0}
EXPECTED = [study.HOLDS, study.READING, study.HOLDS]

STEP_ERROR = 2e-4
"""Of an edge in η_r with 400 steps per period: that of frictionless edges is 1e-4 and less."""

Made = tuple[list[Stored], pd.DataFrame]


def made(
    config: Config = TUNED,
    lower: Mapping[float, float] = LOWER,
    upper: Mapping[float, float] = UPPER,
    stuck: Mapping[float, float] = STUCK,
    lost: float = math.nan,
) -> Made:
    """Give results of a configuration whose bands are these, and its edges; at one friction ratio every run failed."""
    stored, rows = [], []
    for case in study.claim_cases():
        f = case.friction_ratio
        within = lower[f] < case.frequency_ratio < upper[f]
        own = Result(status=Status.PERIODIC, transmittance=0.1 if within else 2.0, stuck=(stuck[f],) * 7)
        stored.append(Stored(Run(config, case, 400), "1", failed("crashed") if f == lost else own))
    key = (config.engine, config.formulation, config.preset_name, "1")
    for f in lower:
        curve = (*key, Case(friction_ratio=f, frequency_ratio=1.0), 400)
        found = [(name, ends[f]) for name, ends in (("lower", lower), ("upper", upper)) if math.isfinite(ends[f])]
        rows += [(*curve, name, eta, 1e-6, 0.0, 0, 0) for name, eta in found]
    names = ["version", "curve", "steps", "edge", "frequency_ratio", "width", "interpolation", "before", "lost"]
    return stored, pd.DataFrame(rows, columns=[*CONFIG, *names])


def tables(*own: Made) -> tuple[pd.DataFrame, pd.DataFrame]:
    """Give points and edges of several configurations."""
    return points([row for stored, _ in own for row in stored]), pd.concat([found for _, found in own])


def known(own: Made) -> pd.DataFrame:
    """Give the bands of a configuration by friction ratio."""
    return study.bands(*tables(own)).set_index("friction_ratio")


@pytest.fixture(scope="module")
def reference() -> tuple[pd.DataFrame, pd.DataFrame]:
    """Points and edges of the reference: what the claims need, run in this process."""
    runs = [Run(REFERENCE, case, 400) for case in study.claim_cases()]
    found: dict[Run, Result] = {}
    while runs:
        found.update(zip(runs, run_batch(runs), strict=True))
        table = points(Stored(run, "1", own) for run, own in found.items())
        runs = [run for run in propose(table) if run not in found and run.config == REFERENCE and run.steps == 400]
    return table, edges(table)


def test_claims_hold_for_the_reference_with_the_published_edges(reference) -> None:
    own = study.bands(*reference).set_index("friction_ratio")
    assert study.claims(*reference).answer.tolist() == EXPECTED
    assert own.lower.to_dict() == pytest.approx(LOWER, abs=STEP_ERROR)
    assert own.upper[list(FRICTION_RATIOS[1:])].tolist() == [math.inf] * 5
    for friction, limit in ((0.0, 0), (5.0, 1)):
        level = linear_limits(Case(friction_ratio=friction, frequency_ratio=own.lower[friction]))[limit]
        assert abs(level) == pytest.approx(1.0, abs=0.01)
    assert "none up to 3 at 0.1, 0.3, 0.6" in study.claims(*reference).numbers[0]


def test_a_claim_whose_points_are_missing_is_open_and_says_which() -> None:
    whole = known(made())
    assert [answer for answer, _, _ in study.answers(whole)] == EXPECTED
    for friction, number in ((0.1, 0), (5.0, 1), (5.0, 2)):
        text = f"missing: the band at friction ratio {friction:g}"
        assert study.answers(whole.drop(index=friction))[number] == (study.OPEN, text, "")


@pytest.mark.parametrize(
    ("name", "friction", "value", "number", "answer", "text"),
    [
        ("lower", 0.6, 0.86, 0, study.READING, "by the covered share alone"),
        ("lower", 0.6, 1.3, 0, study.FAILS, "not wider than without friction at 0.6"),
        ("stuck", 5.0, 0.6, 1, study.FAILS, "cells do not lock at 5"),
        ("lower", 5.0, 0.9988, 1, study.FAILS, "the first cut-off does not move up"),
        ("lower", 0.1, LOWER[0.3] + study.MOVED / 2, 2, study.FAILS, "no wider at 0.3 than elsewhere"),
    ],
)
def test_a_band_that_is_elsewhere_changes_the_answer(name, friction, value, number, answer, text) -> None:
    usual = {"lower": LOWER, "upper": UPPER, "stuck": STUCK}
    own = study.answers(known(made(**{name: {**usual[name], friction: value}})))[number]
    assert own[0] == answer
    assert text in own[2]


def test_a_sentence_says_how_far_the_lower_edge_is_off_and_which_claims_are_open() -> None:
    off, lost = made(DEFAULT, LOWER | {0.1: 0.7632}), made(lost=5.0)
    said = [study.conclusions(*tables(made(REFERENCE), own)).sentence.iloc[-1] for own in (off, lost)]
    assert "off by up to 0.01 (friction ratio 0.1: 0.7632 instead of 0.7532)." in said[0]
    assert "Claim b is not decided; missing: the band at friction ratio 5." in said[1]


def test_pages_of_the_documentation_have_the_numbers_of_the_reference(reference) -> None:
    page = (ROOT / "docs/results/chain.md").read_text(encoding="utf-8")
    assert "| " + " | ".join(study.shown(study.conclusions(*reference)).iloc[0]) + " |" in page
    assert all(numbers in page for numbers in study.claims(*reference).numbers)
    howto = " ".join((ROOT / "docs/how_to/figure3.md").read_text(encoding="utf-8").split())
    lower = study.bands(*reference).set_index("friction_ratio").lower.map("{:.4f}".format)
    assert f"falls from {lower[0.0]} to {lower[0.1]} (friction ratio 0.1), {lower[0.3]} (0.3) and {lower[0.6]}" in howto
    assert f"moves up to {lower[1.0]} and {lower[5.0]}" in howto
    default = page.partition("| mujoco:joint:default |")[2].partition("|\n")[0].split("|")[-1].strip()
    assert f"puts the highest band edge at {default} instead of {lower[5.0]}" in howto
