"""A card as files: HTML to look at, Markdown for a tracker, JSON for programs, for charts of benchmarks and a badge."""

import dataclasses
import json
import math
from collections.abc import Sequence
from pathlib import Path
from typing import Any, NamedTuple

from reference_lcp.output import checked_output_file, checked_output_folder, write_whole
from reports.cards.card import GOAL_DB, Card, Row, VariantCard
from reports.export.files import CARD, PAGE
from reports.formatting import MISSING, card_number, environment, significant
from reports.page.section import SUITE_TEMPLATES
from scenarios.studies.accuracy import ACCURACY_MAP, ACCURACY_MAP_STEPS
from scenarios.sweeps.truths import WRONG_DB
from scenarios.tables import json_text, markdown_text

TEMPLATES = "reports.cards"
ENDINGS = ("html", "md", "json", "bench.json", "badge.json")

COLOURS = {1.0: "green", WRONG_DB: "yellow", math.inf: "red"}
"""Of a badge, by the error below which it has each [dB]."""

SMALLEST_ERROR = 1e-12
"""Part of the truth below which an error is round-off."""


class Cell(NamedTuple):
    """A number of the table, and its difference from the truth, or why there is none."""

    text: str
    note: str = ""


def card_files(name: str) -> list[str]:
    """Give the names of the files of an engine's card."""
    return [f"{CARD}{name}.{ending}" for ending in ENDINGS]


def check_card_files(name: str, folder: Path, store: Path | None) -> None:
    """Raise a `ParameterError` unless every file of a card can be written into the folder, which is made."""
    checked_output_folder("--out", folder)
    for file in card_files(name):
        checked_output_file("output file", folder / file, [store])


def write_card(shown: Card, folder: Path) -> list[Path]:
    """Write the files of a card; gives them, the page first."""
    page = html(shown, linked=(folder / PAGE).is_file())
    texts = (page, markdown(shown), _json(shown), bench_json(shown), badge_json(shown))
    files = [folder / file for file in card_files(shown.name)]
    for file, text in zip(files, texts, strict=True):
        write_whole(file, text.encode())
    return files


def html(shown: Card, *, linked: bool) -> str:
    """Give the page of a card; `linked` to the report that lies beside it."""
    template = environment(TEMPLATES, SUITE_TEMPLATES).get_template("card.html")
    return template.render(_context(shown), report=PAGE if linked else "")


def markdown(shown: Card) -> str:
    """Give a card as Markdown."""
    templates = environment(TEMPLATES, markup=False)
    templates.filters["cell"] = lambda text: markdown_text(str(text))
    return templates.get_template("card.md").render(_context(shown))


def _context(shown: Card) -> dict[str, Any]:
    return {
        "card": shown,
        "table": _table(shown.variants),
        "goal": GOAL_DB,
        "points": len(ACCURACY_MAP),
        "steps": ACCURACY_MAP_STEPS,
    }


def _table(variants: Sequence[VariantCard]) -> list[tuple[str, list[Cell]]]:
    """Give the rows of the table of numbers: what they are, and a cell a variant."""
    notes = [f"{own.certified} of {own.points} points certified" for own in variants]
    certified = [(own, note if own.certified < own.points else "") for own, note in zip(variants, notes, strict=True)]
    rows = [
        ("error to truth, largest [dB]", [Cell(significant(own.largest_db), note) for own, note in certified]),
        ("error to truth, median [dB]", [Cell(significant(own.median_db)) for own in variants]),
    ]
    for name in dict.fromkeys(_label(row) for own in variants for row in own.rows):
        own_rows = [next((row for row in own.rows if _label(row) == name), None) for own in variants]
        rows.append((name, list(map(_cell, own_rows))))
    rows.append((f"steps a period to {GOAL_DB:g} dB", [Cell(_steps(own)) for own in variants]))
    rows.append(("a step [µs]", [Cell(card_number(1e6 * own.step_seconds)) for own in variants]))
    return rows


def _label(row: Row) -> str:
    return f"{row.name}, {row.case}" + (f" [{row.unit}]" if row.unit else "")


def _cell(row: Row | None) -> Cell:
    """Give a number, and its error where the truth is not zero; or why there is none."""
    if row is None:
        return Cell(MISSING)
    if not math.isfinite(row.value):
        return Cell(MISSING, row.reason)
    if row.exact == 0 or abs(row.error) <= SMALLEST_ERROR * abs(row.exact):
        return Cell(card_number(row.value))
    error = f"{'+' if row.error > 0 else ''}{card_number(row.error, 2)}"
    return Cell(_with_error_seen(row), f"{error} at {row.where}" if row.where else error)


def _with_error_seen(row: Row) -> str:
    """Give a number with as many decimals as its error needs, where four digits would round the error away."""
    text = card_number(row.value)
    shown = float(text.replace("−", "-"))
    if abs(shown - row.value) < abs(row.error) / 2:
        return text
    return f"{row.value:.{-math.floor(math.log10(abs(row.error)))}f}".replace("-", "−")


def _steps(own: VariantCard) -> str:
    """Give the fewest steps that were tried and suffice; fewer than the first of them were not."""
    if own.steps_to_goal is None:
        return f"more than {own.most_steps}"
    return f"{own.steps_to_goal}{' or fewer' if own.steps_to_goal == own.steps[0].steps_per_period else ''}"


def _json(shown: Card) -> str:
    content = dataclasses.asdict(shown)
    for own, variant in zip(content["variants"], shown.variants, strict=True):
        own["variant"] = str(variant.variant)
        own["steps_to_goal"], own["goal_db"] = variant.steps_to_goal, GOAL_DB
        own["step_seconds"] = variant.step_seconds
        for point in own["steps"]:
            del point["variant"]
    return json.dumps(json.loads(json_text(content)), ensure_ascii=False, indent=2) + "\n"  # null where NaN was


def bench_json(shown: Card) -> str:
    """Give all errors as github-action-benchmark reads them: a list of numbers, of which smaller ones are better."""
    numbers = [(f"{own.variant}: error to truth, largest", "dB", own.largest_db) for own in shown.variants]
    numbers += [
        (f"{own.variant}: error of {row.name}, {row.case}", row.unit or "1", abs(row.error))
        for own in shown.variants
        for row in own.rows
    ]
    known = [{"name": name, "unit": unit, "value": value} for name, unit, value in numbers if math.isfinite(value)]
    return json.dumps(known, ensure_ascii=False, indent=2) + "\n"


def badge_json(shown: Card) -> str:
    """Give the endpoint of a badge of shields.io: the largest error of the first formulation, with its last preset."""
    best = [own for own in shown.variants if own.variant.formulation == shown.variants[0].variant.formulation][-1]
    error = best.largest_db
    message = f"{significant(error)} dB {best.variant.preset_name}" if math.isfinite(error) else "unsteady"
    colour = next((name for limit, name in COLOURS.items() if error < limit), "lightgrey")
    return json.dumps({"schemaVersion": 1, "label": "friction", "message": message, "color": colour}) + "\n"
