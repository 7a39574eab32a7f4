"""The paper's claims: on bands made by hand, on the reference, and on engines whose friction is wrong."""

import math
from dataclasses import replace
from pathlib import Path

import pytest
from scipy.optimize import brentq

from multibody_xval.engines.interface.variant import Variant
from multibody_xval.scenarios.runs.evaluator import StoredResults
from multibody_xval.scenarios.runs.parameters import ChainRatios
from multibody_xval.scenarios.runs.result import Result, ResultStatus
from multibody_xval.scenarios.runs.store import opened_store
from multibody_xval.scenarios.studies import claims
from multibody_xval.scenarios.studies.claims import (
    CLAIM_COLUMNS,
    MOVED,
    Answer,
    Band,
    Conclusions,
    answers,
    claims_sweep,
    evaluated_conclusions,
    sentence,
)
from multibody_xval.scenarios.studies.figure3 import (
    FRICTION_RATIOS,
    claim_frequency_ratios,
    default_frequency_ratios,
    figure3,
)
from multibody_xval.scenarios.sweeps.attenuation_band import EDGE_RESOLUTION, BandDefinition, Edge
from multibody_xval.scenarios.sweeps.edges import refined_edges
from multibody_xval.scenarios.sweeps.refinement import for_the_band, refined
from multibody_xval.scenarios.tables import markdown_lines, text_table
from multibody_xval.scenarios.verdicts.steady_case import REFERENCE
from reference_lcp.chain.drives import HarmonicBase
from reference_lcp.chain.linear_response import frictionless_transmittance, stuck_response
from tests.scenarios.in_process import evaluator, rub_harder
from tests.scenarios.runs.builders import certified

ROOT = Path(__file__).parents[3]

MUJOCO = Variant.parse("mujoco:joint:default")

LOWER = {0.0: 0.8526, 0.1: 0.7532, 0.3: 0.6373, 0.6: 0.7560, 1.0: 0.9988, 5.0: 1.1726}
STUCK = {0.0: 0.0, 0.1: 0.48, 0.3: 0.48, 0.6: 0.52, 1.0: 0.99, 5.0: 1.0}
MADE = {f: Band(LOWER[f], math.inf if f else math.sqrt(2), 3.0, STUCK[f]) for f in FRICTION_RATIOS}
EXPECTED = [Answer.HOLDS, Answer.READING, Answer.HOLDS]

STEP_ERROR = 2e-4
"""Of an edge in η_r with 400 steps a period: that of frictionless edges is 1e-4 and less."""


def outcomes(bands: dict[float, Band]) -> list[Answer]:
    return [claim.answer for claim in answers(bands)]


def of(variant: Variant, bands: dict[float, Band]) -> Conclusions:
    return Conclusions(variant, bands, answers(bands))


@pytest.fixture(scope="module")
def reference() -> Conclusions:
    with opened_store(None) as store, evaluator(store) as running:
        (found,) = evaluated_conclusions(figure3(), [], running)
    return found


def test_claims_hold_for_the_reference_with_the_published_edges(reference: Conclusions) -> None:
    assert [claim.answer for claim in reference.claims] == EXPECTED
    assert {f: reference.bands[f].lower for f in FRICTION_RATIOS} == pytest.approx(LOWER, abs=STEP_ERROR)
    assert [reference.bands[f].upper for f in FRICTION_RATIOS[1:]] == [math.inf] * 5
    assert "none up to 3 at 0.1, 0.3, 0.6" in reference.claims[0].numbers


def test_frictionless_band_ends_where_the_linear_response_is_0_db(reference: Conclusions) -> None:
    chain = ChainRatios().chain(0.0)

    def level(eta: float) -> float:
        return frictionless_transmittance(chain, HarmonicBase.from_ratio(chain, eta)) - 1

    edges = brentq(level, 0.8505, 0.8686), brentq(level, 1.4, 1.422)
    assert (reference.bands[0.0].lower, reference.bands[0.0].upper) == pytest.approx(edges, abs=STEP_ERROR)
    assert reference.bands[0.0].share == pytest.approx((edges[1] - edges[0]) / 1.3, abs=STEP_ERROR)


def test_first_cut_off_of_locked_cells_is_that_of_a_chain_of_single_masses(reference: Conclusions) -> None:
    """At a friction ratio of 5 no contact slips at the edge, so that it is that of the linear locked chain."""
    chain = ChainRatios().chain(5.0)

    def level(eta: float) -> float:
        drive = HarmonicBase.from_ratio(chain, eta)
        return abs(stuck_response(chain, drive)[chain.cells - 1]) / drive.displacement_scale(chain) - 1

    assert reference.bands[5.0].stuck == 1.0
    assert reference.bands[5.0].lower == pytest.approx(brentq(level, 1.16, 1.2), abs=STEP_ERROR)


@pytest.mark.slow
def test_with_friction_30_percent_too_small_cells_do_not_lock(monkeypatch, reference: Conclusions) -> None:
    """At a friction ratio of 1 it has that of 0.7; without friction it is right."""
    rub_harder(monkeypatch, 0.7)
    with opened_store(None) as store, evaluator(store) as running:
        right, wrong = evaluated_conclusions(figure3(), [Variant("mujoco")], running)
    assert right.claims == reference.claims
    assert wrong.bands[0.0].lower == pytest.approx(right.bands[0.0].lower, abs=1e-9)
    assert [claim.answer for claim in wrong.claims] == [Answer.HOLDS, Answer.FAILS, Answer.HOLDS]
    start = "With MuJoCo tuned one would conclude, otherwise than with the reference, that cells do not lock at 1; its"
    assert sentence(wrong, right).startswith(start)


@pytest.mark.parametrize("led", [True, False])
def test_edges_are_an_engines_own_whether_it_obeys_its_law_or_not(monkeypatch, led: bool) -> None:
    """Where it does not, its law leads it nowhere: it is evaluated on the whole grid."""
    monkeypatch.setattr(claims, "FRICTION_RATIOS", (0.0, 0.3))
    if not led:
        rub_harder(monkeypatch, 0.7)
    planned = claims_sweep(figure3(), [MUJOCO])
    with opened_store(None) as store, evaluator(store) as running:
        _, found = evaluated_conclusions(figure3(), [MUJOCO], running)
        grid = [planned.task(*place) for place in planned.grid_points() if place[0] == MUJOCO]
        assert (len(running.new_tasks(grid)) > len(grid) / 2) == led
        results = refined(planned, list(planned.grid_points()), for_the_band(planned), running)
        own = refined_edges(planned, results, running).crossings
    for case in planned.cases:
        lower = own[MUJOCO, case, Edge.LOWER].frequency_ratio
        assert found.bands[case.friction_ratio].lower == pytest.approx(lower, abs=2 * EDGE_RESOLUTION)


def test_a_law_leads_where_curves_are_not_known_already_and_leads_no_bristle() -> None:
    bristle = Variant.parse("exudyn-bristle:joint:recommended")
    shared = Variant.parse("pybullet:contact:recommended")
    leading = claims.leading_laws(figure3(), [REFERENCE, MUJOCO, bristle, shared])
    assert leading == {MUJOCO: MUJOCO.law, shared: REFERENCE}
    assert claims.leading_laws(figure3([MUJOCO]), [MUJOCO]) == {}


def test_points_of_claims_are_points_of_the_default_grid() -> None:
    assert set(claim_frequency_ratios(ChainRatios())) <= set(default_frequency_ratios(ChainRatios()))


def test_without_results_no_claim_is_decided() -> None:
    with opened_store(None) as store, StoredResults(store) as known:
        (found,) = evaluated_conclusions(figure3(), [], known)
    assert [claim.answer for claim in found.claims] == [Answer.OPEN] * 3
    assert "nothing can be concluded: missing: the band at friction ratio 0, 0.1, 0.3, 0.6" in sentence(found, found)


def test_claims_hold_for_bands_made_by_hand() -> None:
    assert outcomes(MADE) == EXPECTED


@pytest.mark.parametrize(
    ("friction", "number", "text"),
    [
        (0.1, 0, "missing: the band at friction ratio 0.1"),
        (5.0, 1, "missing: the band at friction ratio 5"),
        (5.0, 2, "missing: the band at friction ratio 5"),
    ],
)
def test_a_claim_whose_points_are_missing_is_open_and_says_which(friction: float, number: int, text: str) -> None:
    bands = {f: band for f, band in MADE.items() if f != friction}
    assert answers(bands)[number].answer is Answer.OPEN
    assert answers(bands)[number].numbers == text


def test_locking_is_open_without_the_steady_state_at_the_resonator() -> None:
    claim = answers(MADE | {1.0: replace(MADE[1.0], stuck=math.nan)})[1]
    assert (claim.answer, claim.numbers) == (
        Answer.OPEN,
        "missing: the steady state at η_r = 1 at friction ratio 1",
    )


@pytest.mark.parametrize(
    ("changed", "number", "answer", "text"),
    [
        ({0.6: replace(MADE[0.6], lower=0.86)}, 0, Answer.READING, "by the covered share alone"),
        ({0.6: replace(MADE[0.6], lower=1.3)}, 0, Answer.FAILS, "not wider than without friction at 0.6"),
        ({0.6: replace(MADE[0.6], upper=0.9)}, 0, Answer.READING, "by the lower edge alone"),
        ({5.0: replace(MADE[5.0], stuck=0.6)}, 1, Answer.FAILS, "cells do not lock at 5"),
        ({5.0: replace(MADE[5.0], lower=0.9988)}, 1, Answer.FAILS, "the first cut-off does not move up"),
        ({0.1: replace(MADE[0.1], lower=0.6)}, 2, Answer.FAILS, "the band is widest at 0.1"),
        ({0.1: replace(MADE[0.1], lower=LOWER[0.3] + MOVED / 2)}, 2, Answer.FAILS, "no wider at 0.3 than elsewhere"),
    ],
)
def test_a_band_that_is_elsewhere_changes_the_answer(
    changed: dict[float, Band], number: int, answer: Answer, text: str
) -> None:
    claim = answers(MADE | changed)[number]
    assert claim.answer is answer
    assert text in claim.concluded


@pytest.mark.parametrize(("deepest", "known"), [(-20.0, True), (-5.0, False)])
def test_a_point_without_a_steady_state_leaves_a_band_open_unless_others_are_deep(deepest: float, known: bool) -> None:
    """Where no other point is below -10 dB there may be a band, and there may be none."""
    lost = Result(status=ResultStatus.PERIOD_LIMIT, transmittance_db=-30.0, residual=1.0)
    curve = {0.3: certified(transmittance_db=1.0), 1.2: certified(transmittance_db=deepest), 1.4: lost}
    curve |= {1.6: certified(transmittance_db=-3.0)}
    band = claims._band(curve, 0.8, None, BandDefinition())
    assert (band is not None) is known
    without = claims._band({eta: own for eta, own in curve.items() if own is not lost}, 0.8, None, BandDefinition())
    assert without is not None
    assert without.lower == (0.8 if known else math.inf)


def test_a_band_covers_a_share_whatever_its_ends() -> None:
    assert Band(0.95, math.inf, 3.0).share == pytest.approx(0.5)
    assert Band(-math.inf, math.inf, 3.0).share == 1.0
    assert Band(math.inf, math.inf, 3.0).share == 0.0
    assert Band(0.95, 1.6, 3.0).share == Band(0.95, 2.0, 3.0).share


def test_a_sentence_says_how_far_the_lower_edge_is_off() -> None:
    off = of(Variant("mujoco", preset_name="default"), MADE | {0.1: replace(MADE[0.1], lower=0.7632)})
    expected = (
        "With MuJoCo as installed one would conclude the same as with the reference; its lower edge is off by up to "
        "0.01 (friction ratio 0.1: 0.7632 instead of 0.7532)."
    )
    assert sentence(off, of(REFERENCE, MADE)) == expected


def test_page_of_the_documentation_and_readme_have_the_numbers_of_the_reference(reference: Conclusions) -> None:
    page = (ROOT / "docs/claims.md").read_text(encoding="utf-8")
    assert markdown_lines(text_table(CLAIM_COLUMNS, [reference]))[2] in page
    assert all(claim.numbers in page for claim in reference.claims)
    readme = " ".join((ROOT / "README.md").read_text(encoding="utf-8").split())
    low, lowest, high = (reference.bands[f].lower for f in (0.0, 0.3, 5.0))
    assert f"its lower edge falls from {low:.3f} to {lowest:.3f}" in readme
    installed = page.partition("| mujoco:joint:default |")[2].partition("|\n")[0].split("|")[-1]
    assert f"with {float(installed):.2f} instead of {high:.2f}" in readme


def test_a_sentence_says_which_claims_are_open_and_why() -> None:
    own = of(Variant("mujoco"), {f: band for f, band in MADE.items() if f != 5.0})
    expected = (
        "With MuJoCo tuned one would conclude the same as with the reference. Claim b is not decided; missing: the "
        "band at friction ratio 5. Claim c is not decided; missing: the band at friction ratio 5."
    )
    assert sentence(own, of(REFERENCE, MADE)) == expected
