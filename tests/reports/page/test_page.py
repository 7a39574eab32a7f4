"""The page: complete, self-contained, escaped, honest about what is missing."""

import math
import re
from dataclasses import replace
from html.parser import HTMLParser

import numpy as np
import pytest

from multibody_xval.engines.interface.variant import Variant
from multibody_xval.reports.data.descriptions import band_definition, compared_with
from multibody_xval.reports.data.finding import finding
from multibody_xval.reports.data.options import error_text, headlines
from multibody_xval.reports.data.points import absent_edge
from multibody_xval.reports.data.report import Report, counted
from multibody_xval.reports.data.stick_slip import stick_slip_rows
from multibody_xval.reports.export.files import FILES, files_of
from multibody_xval.reports.figures.style import INK
from multibody_xval.reports.page.render import LARGEST_PAGE, sections
from multibody_xval.reports.page.sections.verdicts import OpenPoints, Verdicts
from multibody_xval.scenarios.runs.parameters import ChainRatios
from multibody_xval.scenarios.runs.result import Result
from multibody_xval.scenarios.studies.claims import Band, Conclusions, answers
from multibody_xval.scenarios.studies.figure3 import FRICTION_RATIOS, figure3
from multibody_xval.scenarios.sweeps.attenuation_band import Edge
from multibody_xval.scenarios.sweeps.compared import ComparedSweep
from multibody_xval.scenarios.sweeps.edges import BandEdge, compare_edge
from multibody_xval.scenarios.sweeps.point import Point
from multibody_xval.scenarios.sweeps.sweep import Case
from multibody_xval.scenarios.verdicts.finding import TRANSMITTANCE, Comparison, Finding, Verdict
from multibody_xval.scenarios.verdicts.judge import missing
from multibody_xval.scenarios.verdicts.steady_case import CONVERGED, REFERENCE
from tests.reports.conftest import made_errors

RUNS, MISSING = Variant("mujoco"), Variant("pybullet")
LOWER_EDGES = dict(zip(FRICTION_RATIOS, (0.85, 0.75, 0.64, 0.76, 1.0, 1.17), strict=True))


@pytest.fixture(scope="module")
def page(files: dict[str, bytes]) -> str:
    return files["index.html"].decode()


class Elements(HTMLParser):
    """What a page is made of: identifiers, headings, open elements at the end."""

    VOID = ("meta", "link", "br", "hr", "img", "input")

    def __init__(self, text: str):
        super().__init__()
        self.identifiers: list[str] = []
        self.references: list[str] = []
        self.headings: list[str] = []
        self.open: list[str] = []
        self.feed(text)

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        if tag not in self.VOID:
            self.open.append(tag)
        for name, value in attrs:
            if name == "id" and value:
                self.identifiers.append(value)
            if name.endswith("href") and value:
                self.references.append(value)

    def handle_startendtag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.handle_starttag(tag, attrs)
        self.handle_endtag(tag)

    def handle_endtag(self, tag: str) -> None:
        if tag not in self.VOID:
            assert self.open.pop() == tag

    def handle_data(self, data: str) -> None:
        if self.open and self.open[-1] == "h2":
            self.headings.append(data)


def test_page_has_every_section_in_order(page: str) -> None:
    assert Elements(page).headings == [
        "Summary", "Transmittance", "Where the error is", "Friction and frequency", "Band edges", "Stick and slip",
        "Work and precision", "Verdicts", "Deviations and laws", "Points that do not agree",
        "How these numbers were made",
    ]  # fmt: skip


def test_page_needs_nothing_from_elsewhere(page: str, files: dict[str, bytes]) -> None:
    """No address, no script and no file but those in its folder; maps are pictures in the page itself."""
    assert not re.search(r"https?:|<link|<script|@import|\bsrc=", page)
    beside = {*FILES, *files}
    embedded = "data:image/png;base64,"
    references = Elements(page).references
    assert all(reference.startswith(("#", embedded)) or reference in beside for reference in references)


def test_figures_are_named_by_their_captions_and_have_the_colours_of_the_page(page: str) -> None:
    figures = re.findall(r'<figure class="chart.*?</figure>', page, flags=re.DOTALL)
    assert len(figures) > 8
    for figure in figures:
        assert re.search(r'<svg[^>]* role="img" aria-label="[^"]+"', figure)
        assert INK not in figure
        assert "var(--ink)" in figure


def test_page_is_small_enough_to_be_sent(page: str) -> None:
    assert len(page.encode()) < LARGEST_PAGE


def test_elements_close_and_identifiers_are_unique_and_found(page: str) -> None:
    elements = Elements(page)
    assert elements.open == []
    assert len(set(elements.identifiers)) == len(elements.identifiers)
    targets = [one[1:] for one in elements.references if one[0] == "#"] + re.findall(r"url\(#([^)]+)\)", page)
    assert set(targets) <= set(elements.identifiers)


def test_text_from_outside_is_escaped(page: str) -> None:
    assert "&lt;pybullet&gt; is missing &amp; has no wheel" in page
    assert "<pybullet>" not in page
    assert "&lt;b&gt;" in page


def test_a_missing_engine_is_blocked_with_its_reason_once_and_not_by_every_point(result: ComparedSweep) -> None:
    shown = {part["title"]: part["rows"] for part in OpenPoints(Report(result, "")).context()["variants"]}
    assert [row["verdict"] for row in shown["PyBullet"]] == ["blocked"]
    assert "has no wheel" in shown["PyBullet"][0]["reason"]


def test_points_and_edges_that_do_not_agree_are_named(result: ComparedSweep) -> None:
    shown = {part["title"]: part["rows"] for part in OpenPoints(Report(result, "")).context()["variants"]}
    places = {row["places"]: row["verdict"] for row in shown["MuJoCo"]}
    assert places == {
        "friction 0, η_r = 0.9": "disagree",
        "friction 0.3, η_r = 1.3": "inconclusive",
        "friction 0, lower edge": "disagree",
        "friction 0, upper edge": "disagree",
        "friction 0.3, lower edge": "disagree",
    }


def test_the_band_is_defined_once(page: str, result: ComparedSweep) -> None:
    definition = "first deep attenuation (transmittance below −10 dB)"
    assert definition in band_definition(result.sweep)
    assert page.count(definition) == 1


def test_the_page_says_how_many_frequencies_there_are_and_does_not_list_them(report: Report, page: str) -> None:
    assert "4 frequency ratios from 0.3 to 1.3 in each of 2 cases" in page
    assert "0.3, 0.6, 0.9, 1.3" not in page


def test_every_plot_has_its_files_and_those_with_numbers_their_table(page: str, files: dict[str, bytes]) -> None:
    figures = re.findall(r'data-figure="([^"]+)".*?<p class="downloads">(.*?)</p>', page, flags=re.DOTALL)
    assert len(figures) > 8
    for name, links in figures:
        linked = re.findall(r'href="([^"]+)" download', links)
        assert linked[:2] == [f"figures/{name}.svg", f"figures/{name}.pdf"]
        assert set(linked) <= set(files)
    tables = {name: re.findall(r'href="(\w+\.csv)"', links) for name, links in figures}
    assert tables["installed"] == ["errors.csv"]
    assert tables["transmittance-0.3"] == ["transmittance.csv"]


def test_the_first_screen_has_the_finding_what_to_paste_every_engine_on_one_axis_and_the_chain(
    page: str, files: dict[str, bytes]
) -> None:
    summary = page.split('id="summary"')[1].split("</section>", maxsplit=1)[0]
    first = summary.split("<details>\n", maxsplit=1)[0]
    assert first.index('class="lead"') < first.index('<table class="engines">') < first.index('class="chart')
    assert "multibody-xval recipe mujoco" in first
    assert "impratio=" in first, "what to paste"
    drawing = re.search(r'<svg class="chain".*?</svg>', first, flags=re.DOTALL)
    assert drawing is not None
    assert drawing[0].count('class="outer"') == drawing[0].count('class="inner"') == 7
    assert 'data-figure="installed"' in first
    assert {"figures/installed.svg", "figures/installed.pdf"} <= set(files)


def test_a_preview_has_no_section_without_anything_in_it(report: Report) -> None:
    """It has no steps but those that the store holds, and perhaps no point of the map."""
    empty = replace(report.friction_map, transmittance_db=np.full((2, 4), math.nan))
    shown = [type(part).__name__ for part in sections(replace(report, steps=(), friction_map=empty))]
    assert "WorkPrecision" not in shown
    assert "FrictionMapSection" not in shown
    whole = [type(part).__name__ for part in sections(report)]
    assert {"WorkPrecision", "FrictionMapSection"} <= set(whole)


def test_disagreements_in_db_come_first_and_the_largest_on_top(result: ComparedSweep) -> None:
    shown = {part["title"]: part["rows"] for part in OpenPoints(Report(result, "")).context()["variants"]}
    rows = shown["MuJoCo"]
    decibels = [abs(row["difference"]) for row in rows if row["unit"] == "dB" and not math.isnan(row["difference"])]
    assert decibels == sorted(decibels, reverse=True)
    assert decibels
    assert [row["unit"] == "dB" for row in rows] == sorted((row["unit"] == "dB" for row in rows), reverse=True)


def test_deviations_stand_beside_what_laws_leave_of_them_and_fail_the_comparison(report: Report, page: str) -> None:
    own = next(row for row in report.deviations if row["variant"] == RUNS)
    assert (own["points"], own["edges"], own["unmodelled"]) == (1, 3, 4)
    assert own["worst"]["deviation"] == pytest.approx(0.03, abs=1e-12)
    assert math.isnan(own["worst"]["left"])
    assert own["note"] == "claims the reference's step"
    assert report.failures[0].startswith("unmodelled: ")
    assert "<b>Failed: " in page
    assert report.failures[0] in page


def test_findings_count_verdicts_and_name_the_worst_place(result: ComparedSweep) -> None:
    found = Report(result, "").verdicts[RUNS]
    assert found["verdicts"] == {
        "agree": 6, "disagree": 1, "own step too coarse": 0, "inconclusive": 1, "blocked": 0,
    }  # fmt: skip
    assert found["worst_edge"]["difference"] == pytest.approx(0.01)
    assert found["median_periods"] == 30
    assert found["seconds"] == pytest.approx(3.5)


def test_what_shares_the_scheme_is_compared_at_equal_step() -> None:
    assert "at equal time step; nothing is allowed but what neither can resolve" in compared_with(RUNS)
    assert "converged reference; its own error is allowed" in compared_with(Variant("exudyn-bristle"))
    assert "step error" in compared_with(REFERENCE)
    assert "baseline" in compared_with(CONVERGED)


def test_an_edge_that_the_grid_does_not_hold_is_said_to_be_beyond_its_end(result: ComparedSweep) -> None:
    assert absent_edge(result, result.edge(CONVERGED, Case.of(friction_ratio=0.3), Edge.UPPER)) == "above 1.3"
    assert absent_edge(result, result.edge(CONVERGED, Case.of(friction_ratio=0.3), Edge.LOWER)) == "below 0.3"
    assert absent_edge(result, result.edge(MISSING, Case.of(friction_ratio=0.3), Edge.LOWER)) == "unknown"


def test_stick_slip_rows_compare_transitions_with_the_reference_at_equal_step(result: ComparedSweep) -> None:
    rows = {(row["engine"], row["preset"], row["frequency_ratio"]): row for row in stick_slip_rows(result)}
    assert {eta for _, _, eta in rows} == {0.6, 0.9}
    row = rows["mujoco", "tuned", 0.6]
    assert (row["transitions"], row["missed"], row["spurious"]) == (2, 0, 0)
    assert row["largest_time_error"] == pytest.approx(0.00025)
    assert row["stuck_fraction"] == 0.375
    assert rows["pybullet", "tuned", 0.6]["status"] == "blocked"
    assert rows["reference", "tuned", 0.6]["largest_time_error"] == 0.0


def not_compared(variant: Variant, result: Result) -> tuple[Finding, ...]:
    gap = missing("engine", [result])
    assert gap is not None
    return tuple(Finding.without_numbers(variant, "", [TRANSMITTANCE], gap))


def test_a_page_is_written_even_if_nothing_has_a_steady_state() -> None:
    place = (0.3, 0.6)
    ratios = ChainRatios(cells=2, mass_ratio=(1.0, 0.5), outer_mass_ratio=(1.0, 2.0))
    asked = figure3((MISSING,), place[:1], place[1:], ratios=ratios)
    case = Case.of(friction_ratio=place[0])
    lost = Result(status="period limit", residual=1e-3, periods=400)
    answers = {variant: Result.blocked("why") if variant == MISSING else lost for variant in asked.variants}
    result = ComparedSweep(
        asked,
        [
            Point(variant=v, case=case, frequency_ratio=0.6, result=found, findings=not_compared(v, found))
            for v, found in answers.items()
        ],
        tuple(BandEdge(v, case, edge, None, compare_edge(None, None)) for v in answers for edge in Edge),
        {case: (np.array([0.6]), np.array([math.nan]))},
    )
    page = files_of(Report(result, ""))["index.html"].decode()
    assert "period limit after 400 periods" in page
    assert "unknown" in page
    assert "2 cells, mass ratio (1, 0.5), stiffness ratio 1," in page
    assert "outer mass ratio (1, 2)" in page


def test_page_holds_no_text_of_an_object_of_the_program(page: str) -> None:
    assert "joint, tuned" in page, "variants are named"
    assert not re.search(r"\b[A-Z]\w+\(\w+=|&lt;[A-Z]\w+\.[A-Z]+|object at 0x", page)


def test_a_disagreement_has_the_command_that_shows_it_without_the_suite(page: str) -> None:
    assert f"<code>multibody-xval reproduce {RUNS} figure3</code>" in page


def test_page_and_terminal_count_the_same_numbers_without_the_reference(report: Report, page: str) -> None:
    shown = Verdicts(report).context()
    assert all(row["variant"].engine != "reference" for row in shown["rows"])
    totals = {name: sum(row["counted"][name] for row in shown["rows"]) for name in shown["counts"]}
    assert totals == counted(report.compared)
    assert sum(totals.values()) == len(report.compared)
    assert report.status.startswith("failed: ")
    assert report.status.capitalize() in page


def without_faults(result: ComparedSweep) -> ComparedSweep:
    """The engine that runs does as the reference does; the other one is not installed."""
    points = [
        replace(point, findings=tuple(map(agreeing, point.findings))) if point.variant == RUNS else point
        for point in result.points
    ]
    return replace(result, points=points, edges=())


def agreeing(finding: Finding) -> Finding:
    return replace(finding, comparison=Comparison(Verdict.AGREE, "", 0.0, 1.0))


@pytest.mark.slow
def test_a_page_does_not_say_that_all_agree_where_an_engine_is_missing(result: ComparedSweep) -> None:
    def said(shown: ComparedSweep) -> str:
        return files_of(Report(shown, ""))["index.html"].decode()

    whole = without_faults(result)
    page = said(whole)
    assert "there is no result of PyBullet" in page
    assert "there is no result of PyBullet" in page
    assert "None: every point and every edge" not in page
    lost = replace(whole, points=[point for point in whole.points if point.variant != MISSING])
    page = said(lost)
    assert "there is no result of PyBullet" in page
    assert "None: every point and every edge" not in page
    alone = replace(lost, sweep=figure3((RUNS,), (0.0, 0.3), (0.3, 0.6, 0.9, 1.3)))
    page = said(alone)
    assert "<b>Passed: " in page
    assert "None: every point and every edge of MuJoCo agrees" in page


def test_the_largest_error_as_installed_comes_first_and_the_finding_names_it() -> None:
    tuned, default = Variant("mujoco"), Variant("mujoco", "joint", "default")
    contact = {replace(tuned, formulation="contact"): -0.12449, replace(default, formulation="contact"): -42.851}
    rows = headlines(made_errors({tuned: -0.12449, default: 14.734, **contact}, points=4))
    assert [(row.variant.formulation, row.texts) for row in rows] == [
        ("contact", ["43", "–", "0.12"]), ("joint", ["15", "–", "0.12"]),
    ]  # fmt: skip
    assert finding(rows) == (
        "As installed, 1 of 1 engines is off by 3 dB or more (MuJoCo, contact by 43 dB; MuJoCo by 15 dB); "
        "tuned to this chain, none, and the largest error is 0.12 dB."
    )


def test_an_error_says_of_how_many_points_it_is() -> None:
    """All of five are known, one is not, most are not, and the engine is not here."""
    (row,) = made_errors({Variant("mujoco"): 14.734}, points=5).values()
    texts = {}
    for known, blocked in ((5, False), (4, False), (1, False), (0, True)):
        row.points_known, row.blocked = known, blocked
        texts[known] = error_text(row)
    assert texts == {5: "15", 4: "15*", 1: "unsteady", 0: "–"}


def test_the_finding_has_what_one_would_conclude_with_the_engine_that_is_farthest_off() -> None:
    bands = {f: Band(edge, math.inf, 3.0, float(f >= 1)) for f, edge in LOWER_EDGES.items()}
    installed = Variant("mujoco", preset_name="default")
    near, far = (bands | {5.0: replace(bands[5.0], lower=edge)} for edge in (1.16, 1.10))
    others = [(Variant("pybullet", preset_name="default"), near), (installed, far)]
    answered = [Conclusions(own, given, answers(given)) for own, given in ((REFERENCE, bands), *others)]
    said = finding([], answered)
    assert said.startswith("The paper’s claims hold (3 of 3); with MuJoCo as installed one would conclude the same")
    assert "5: 1.1000 instead of 1.1700" in said


def test_table_and_page_have_the_smallest_error_to_truth_first(page: str) -> None:
    table = page.split('id="summary"')[1].split("</table>", maxsplit=2)[1]
    assert re.findall(r'<th class="nowrap">([^<]*)<', table) == [
        "Reference (LCP), converged", "Reference (LCP)", "MuJoCo", "MuJoCo, default", "PyBullet",
    ]  # fmt: skip
    assert "same equations" in table
    assert "Compared with the truth at these points alone, without a verdict: MuJoCo, default" in page
    assert "worst difference" not in page
