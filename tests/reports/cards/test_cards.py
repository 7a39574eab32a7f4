"""Cards of engines: their numbers are those of the scenarios, and nothing of them is lost in a file."""

import dataclasses
import json
import math
from types import SimpleNamespace

import pytest

from engines.interface.variant import Variant
from engines.mujoco import MuJoCo
from reference_lcp.errors import ParameterError
from reports.cards import card as cards
from reports.cards.card import Card, Row, VariantCard, card, card_variants
from reports.cards.write import badge_json, bench_json, check_card_files, html, markdown, write_card
from reports.export.files import cards_beside
from scenarios.runs.store import opened_store
from scenarios.studies.work_precision import StepPoint
from scenarios.verdicts.finding import Comparison, Finding, Metric, Verdict
from tests.scenarios.in_process import evaluator, rub_harder

SOFT = Variant("mujoco", "joint", "default")

needs_mujoco = pytest.mark.needs("mujoco")


def step_point(steps: int, error_db: float) -> StepPoint:
    return StepPoint(SOFT, steps, error_db, 1e-5, 0.1, 6, 6, "")


def made_up() -> Card:
    """A card whose numbers are easy to recognise; nothing is computed."""
    variant = VariantCard(
        variant=SOFT,
        description="As <it> comes.",
        largest_db=14.7321,
        median_db=0.25,
        certified=70,
        points=74,
        rows=(
            Row("creep", "µm/s", 5165.95, 0.0, "1 kg, load 0.99", command="multibody-xval reproduce mujoco"),
            Row("breakaway", "", 0.8738, 1.0, "1 kg, 2 ms"),
            Row("lower band edge", "η_r", math.nan, 0.637, "friction 0.3", "no edge | nearby"),
        ),
        steps=(step_point(400, 0.5), step_point(800, 0.09), step_point(1600, 0.01)),
        options=(
            {"name": "noslip_iterations", "value": "1", "default": "0", "reach": "general", "reason": "R | softness"},
        ),
        law="λ = −clip(a, ±μ λ_N)",
        script='print("a < b")\n',
    )
    return Card("mujoco", "MuJoCo", "mujoco", "4.0.0", "Apache-2.0", "Soft & slow.", (variant,))


def test_page_of_a_card_has_its_numbers_with_their_errors_and_the_script_as_it_is() -> None:
    page = html(made_up(), linked=True)
    numbers = ("15", "5166", "0.8738", "−0.13", "no edge | nearby")
    for text in (*numbers, "print(&#34;a &lt; b&#34;)", "As &lt;it&gt; comes."):
        assert text in page
    assert 'href="index.html"' in page
    assert 'href="index.html"' not in html(made_up(), linked=False)


def test_markdown_of_a_card_is_a_table_whose_cells_are_not_broken_by_bars() -> None:
    lines = markdown(made_up()).splitlines()
    table = [line for line in lines if line.startswith("|")]
    assert {line.replace("\\|", "").count("|") for line in table} == {3, 6}
    assert "| creep, 1 kg, load 0.99 [µm/s] | 5166 |" in lines
    assert "| steps a period to 0.1 dB | 800 |" in lines
    assert 'print("a < b")' in lines


def test_files_of_a_card_hold_it_in_full_and_lie_where_a_report_finds_them(tmp_path) -> None:
    check_card_files("mujoco", tmp_path / "new", None)
    files = write_card(made_up(), tmp_path / "new")
    assert [file.name for file in files] == [
        f"card-mujoco.{ending}" for ending in ("html", "md", "json", "bench.json", "badge.json")
    ]
    content = json.loads(files[2].read_text(encoding="utf-8"))
    (variant,) = content["variants"]
    assert (variant["variant"], variant["largest_db"], variant["steps_to_goal"]) == (str(SOFT), 14.7321, 800)
    assert [row["value"] for row in variant["rows"]] == [5165.95, 0.8738, None]
    assert cards_beside(tmp_path / "new") == {"mujoco": "card-mujoco.html"}


def test_a_chart_of_benchmarks_has_every_error_that_is_known() -> None:
    assert json.loads(bench_json(made_up())) == [
        {"name": "mujoco:joint:default: error to truth, largest", "unit": "dB", "value": 14.7321},
        {"name": "mujoco:joint:default: error of creep, 1 kg, load 0.99", "unit": "µm/s", "value": 5165.95},
        {"name": "mujoco:joint:default: error of breakaway, 1 kg, 2 ms", "unit": "1", "value": pytest.approx(0.1262)},
    ]


@pytest.mark.parametrize(
    ("error", "message", "colour"),
    [
        (0.1234, "0.12 dB tuned", "green"),
        (0.999, "1.0 dB tuned", "green"),
        (1.0, "1.0 dB tuned", "yellow"),
        (3.0, "3.0 dB tuned", "red"),
        (math.nan, "unsteady", "lightgrey"),
    ],
)
def test_a_badge_shows_the_best_preset_of_the_first_formulation(error, message, colour) -> None:
    (soft,) = made_up().variants
    tuned = dataclasses.replace(soft, variant=Variant("mujoco"), largest_db=error)
    contact = dataclasses.replace(soft, variant=Variant("mujoco", "contact"), largest_db=40.0)
    badge = json.loads(badge_json(dataclasses.replace(made_up(), variants=(soft, tuned, contact))))
    assert badge == {"schemaVersion": 1, "label": "friction", "message": message, "color": colour}


def test_a_card_that_reaches_no_goal_says_up_to_where_it_was_tried() -> None:
    shown = made_up().variants[0]
    assert (shown.steps_to_goal, shown.most_steps) == (800, 1600)
    coarse = VariantCard(**{**vars(shown), "steps": (step_point(400, 0.5), step_point(800, math.nan))})
    assert (coarse.steps_to_goal, coarse.most_steps) == (None, 800)


def test_steps_that_were_not_certified_at_every_point_reach_no_goal() -> None:
    lost = dataclasses.replace(step_point(400, 0.01), certified=5)
    shown = dataclasses.replace(made_up().variants[0], steps=(lost, step_point(800, 0.01)))
    assert shown.steps_to_goal == 800


def test_first_steps_that_were_tried_and_suffice_may_be_more_than_needed() -> None:
    first = dataclasses.replace(made_up().variants[0], steps=(step_point(400, 0.01), step_point(800, 0.01)))
    table = markdown(dataclasses.replace(made_up(), variants=(first,)))
    assert "| steps a period to 0.1 dB | 400 or fewer |" in table


@pytest.mark.parametrize(
    ("value", "exact", "cell"),
    [
        (1.000434, 0.999934, "1.0004 (+0.0005)"),
        (0.999957, 1.0, "0.99996 (−4.3e−05)"),
        (0.8738, 1.0, "0.8738 (−0.13)"),
        (-1.000434, -0.999934, "−1.0004 (−0.0005)"),
    ],
)
def test_a_number_shows_its_error(value, exact, cell) -> None:
    row = Row("stopping distance", "", value, exact, "1 kg")
    shown = dataclasses.replace(made_up().variants[0], rows=(row,))
    assert f"| stopping distance, 1 kg | {cell} |" in markdown(dataclasses.replace(made_up(), variants=(shown,)))


def test_points_without_a_certified_steady_state_are_counted_beside_the_largest_error() -> None:
    assert "| error to truth, largest [dB] | 15 (70 of 74 points certified) |" in markdown(made_up())
    whole = dataclasses.replace(made_up().variants[0], certified=74)
    assert "| 15 |" in markdown(dataclasses.replace(made_up(), variants=(whole,)))


def test_card_of_an_engine_without_scripts_names_no_command_that_would_be_refused() -> None:
    bare = dataclasses.replace(made_up().variants[0], script="", options=())
    shown = dataclasses.replace(made_up(), variants=(bare,))
    assert "reports reproduce" not in html(shown, linked=False)
    assert "This engine has no script so far." in html(shown, linked=False)
    assert "Every option is the engine's own." in markdown(shown)


def test_an_engine_that_is_not_there_is_refused_before_any_work(monkeypatch) -> None:
    monkeypatch.setattr(MuJoCo, "unavailable_reason", lambda _: "the package mujoco is not installed")
    with pytest.raises(ParameterError, match="engine = mujoco is not installed: the package mujoco is not installed"):
        card_variants("mujoco")


def test_a_catalogue_that_asks_for_directions_adds_the_worst_of_them(monkeypatch) -> None:
    metric = Metric("bound", "", "Over μ N.")

    def run(variants, _evaluator):
        return [
            Finding(variants[0], f"1 kg, {angle}°", metric, value, 1.0, Comparison(Verdict.DISAGREE, "", value - 1.0))
            for angle, value in ((0, 1.0), (45, math.sqrt(2)), (90, 1.0))
        ]

    monkeypatch.setattr(cards, "CATALOGUE", {"direction": SimpleNamespace(run=run)})
    (row,) = cards._direction_rows(Variant("mujoco", "contact"), None)
    assert (row.value, row.where) == (math.sqrt(2), "45°")
    assert cards._direction_rows(Variant("mujoco", "joint"), None) == []


@needs_mujoco
@pytest.mark.slow
@pytest.mark.parametrize("factor", [1.0, 1.02])
def test_card_of_an_engine_that_rubs_too_hard_says_by_how_much(factor, monkeypatch) -> None:
    """MuJoCo is replaced by the reference, with a bound that is too large by the factor."""
    rub_harder(monkeypatch, factor)
    monkeypatch.setattr(cards, "card_variants", lambda name: [Variant(name)])
    with opened_store(None) as store, evaluator(store) as running:
        (tuned,) = card("mujoco", running).variants
    rows = {(row.name, row.case): row for row in tuned.rows}
    assert rows["creep", "1 kg, load 0.99"].value == 0
    assert rows["stopping distance", "1 kg, 4.9 m/s"].value == pytest.approx(1 / factor, abs=1e-3)
    assert rows["breakaway", "1 kg, 2 ms"].value == pytest.approx(factor, abs=3e-3)
    assert (tuned.median_db < 0.005) == (factor == 1.0)
    assert tuned.certified == tuned.points
