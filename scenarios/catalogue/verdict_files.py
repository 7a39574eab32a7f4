"""Verdicts as files: a document, every number as CSV or JSON."""

import math
import platform

import pandas as pd

from scenarios.catalogue.base import Scenario
from scenarios.catalogue.verdict_table import VERDICT_LEGEND, Results, details, law_in_words, matrix, verdict_table
from scenarios.tables import Column, csv_text, full_table, json_text, markdown_lines, records
from scenarios.tasks.versions import versions_of
from scenarios.verdicts.finding import Finding


def verdict_document(results: Results, command: str) -> str:
    """Give everything as a document, with how it was made."""
    lines = ["# Verdicts", "", VERDICT_LEGEND, f"Made by `{command}`.", ""]
    lines += [*markdown_lines(matrix(results)), "", "## What the laws of the presets are", ""]
    findings = [finding for own in results.values() for finding in own]
    lines += [
        f"- {variant}: {law_in_words(variant)}"
        for variant in dict.fromkeys(finding.variant for finding in findings if finding.as_predicted)
    ]
    for scenario, own in results.items():
        lines += ["", f"## {scenario.name}", "", scenario.question, ""]
        lines += [f"- from: {scenario.source}", f"- compared with: {scenario.expects}"]
        lines += [
            f"- {metric.name}{f' [{metric.unit}]' if metric.unit else ''}: {metric.meaning}"
            for metric in scenario.metrics
        ]
        lines += [f"- {line}" for line in scenario.parameters()]
        lines += ["", *markdown_lines(verdict_table(own))]
        wrong = list(details(own))
        if wrong:
            lines += ["", "What does not agree:", ""]
        for variant, remarks in wrong:
            lines += [f"- {variant}", *(f"  - {remark}" for remark in remarks)]
    names = sorted({finding.variant.engine for finding in findings})
    return "\n".join([*lines, "", f"Versions: {versions_of(names)}; Python {platform.python_version()}.", ""])


def _predicted(name: str) -> Column[tuple[Scenario, Finding]]:
    """Give a number of the prediction; NaN where there is none."""
    return Column(f"law {name}".replace("_", " "), lambda row: getattr(row[1].prediction, name, math.nan))


FINDING_COLUMNS: tuple[Column[tuple[Scenario, Finding]], ...] = (
    Column("scenario", lambda row: row[0].name),
    Column("case", lambda row: row[1].case),
    Column("engine", lambda row: row[1].variant.engine),
    Column("formulation", lambda row: row[1].variant.formulation),
    Column("preset", lambda row: row[1].variant.preset_name),
    Column("metric", lambda row: row[1].metric.name),
    Column("unit", lambda row: row[1].metric.unit),
    Column("value", lambda row: row[1].value),
    Column("expected", lambda row: row[1].expected),
    Column("verdict", lambda row: str(row[1].comparison.verdict)),
    Column("difference", lambda row: row[1].comparison.difference),
    Column("allowed", lambda row: row[1].comparison.tolerance),
    Column("as predicted", lambda row: row[1].as_predicted),
    *(_predicted(name) for name in ("value", "difference", "allowed", "distance", "period_bound")),
    Column("reason", lambda row: row[1].comparison.reason),
)


def finding_table(results: Results) -> pd.DataFrame:
    """Give every finding, with full precision."""
    return full_table(FINDING_COLUMNS, [(scenario, finding) for scenario, own in results.items() for finding in own])


def verdicts_text(results: Results, command: str, ending: str) -> str:
    """Give the verdicts in the format of a file: ``.md``, ``.csv`` or ``.json``."""
    if ending == ".md":
        return verdict_document(results, command)
    if ending == ".csv":
        return csv_text(finding_table(results), missing="")
    return json_text(_content(results, command), indent=1)


def _content(results: Results, command: str) -> dict[str, object]:
    findings = [finding for own in results.values() for finding in own]
    return {
        "command": command,
        "versions": versions_of(sorted({finding.variant.engine for finding in findings})),
        "scenarios": [
            {"name": scenario.name, "question": scenario.question, "source": scenario.source,
             "expects": scenario.expects, "parameters": scenario.parameters()}
            for scenario in results
        ],
        "findings": records(finding_table(results)),
        "laws": {str(finding.variant): law_in_words(finding.variant) for finding in findings if finding.as_predicted},
    }  # fmt: skip
