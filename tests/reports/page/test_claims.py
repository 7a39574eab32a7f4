"""The paper's claims on the page: what each variant would conclude, and which points are missing."""

import math
from dataclasses import replace

from multibody_xval.engines.interface.variant import Variant
from multibody_xval.reports.data.collect import Scope, collect
from multibody_xval.reports.data.report import Report
from multibody_xval.reports.page.render import page, sections
from multibody_xval.reports.page.sections.claims import Claims
from multibody_xval.scenarios.runs.evaluator import StoredResults
from multibody_xval.scenarios.runs.parameters import ChainRatios, Excitation
from multibody_xval.scenarios.runs.store import opened_store
from multibody_xval.scenarios.studies.claims import Band, Bands, Conclusions, answers
from multibody_xval.scenarios.studies.figure3 import FRICTION_RATIOS, figure3
from multibody_xval.scenarios.verdicts.steady_case import REFERENCE

LOWER = dict(zip(FRICTION_RATIOS, (0.85, 0.75, 0.64, 0.76, 1.0, 1.17), strict=True))
BANDS = {f: Band(LOWER[f], math.inf, 3.0, float(f >= 1)) for f in FRICTION_RATIOS}
AS_INSTALLED = Variant("mujoco", preset_name="default")


def shown(report: Report, bands: Bands) -> str:
    of = [Conclusions(REFERENCE, BANDS, answers(BANDS)), Conclusions(AS_INSTALLED, bands, answers(bands))]
    return page("Claims", [Claims(replace(report, conclusions=tuple(of)))]).html


def test_page_says_what_an_engine_as_installed_would_conclude(report: Report) -> None:
    text = shown(report, BANDS | {0.1: replace(BANDS[0.1], lower=0.6)})
    assert "With MuJoCo as installed one would conclude, otherwise than with the reference, that" in text
    assert "the band is widest at 0.1" in text
    assert "<td>does not hold</td>" in text


def test_page_says_which_points_of_a_claim_are_missing(report: Report) -> None:
    text = shown(report, {})
    assert "nothing can be concluded: missing: the band at friction ratio 0, 0.1, 0.3, 0.6" in text
    assert "<td>not decided</td>" in text


def test_a_report_without_answers_has_no_such_section(report: Report) -> None:
    assert not report.conclusions
    assert not any(isinstance(section, Claims) for section in sections(report))


def collected(**changed) -> tuple[Conclusions, ...]:
    sweep = figure3((), (0.3,), (0.6, 0.9), **changed)
    with opened_store(None) as store, StoredResults(store) as known:
        return collect(sweep, store, known, "report", scope=Scope()).conclusions


def test_claims_are_asked_of_the_canonical_chain_on_a_moving_base_only() -> None:
    assert [own.variant for own in collected()] == [REFERENCE]
    assert collected(ratios=ChainRatios(cells=3)) == ()
    assert collected(excitation=Excitation(kind="force")) == ()
