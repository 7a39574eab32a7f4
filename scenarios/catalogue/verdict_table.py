"""Verdicts as tables: for the terminal, for documents, for other programs."""

import math
import platform
from collections import Counter
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import partial

import pandas as pd

from multibody_xval.engines.interface.registry import law_of
from multibody_xval.engines.interface.variant import Variant
from multibody_xval.scenarios.catalogue.base import Scenario
from multibody_xval.scenarios.runs.task import versions_of
from multibody_xval.scenarios.tables import (
    Column,
    csv_text,
    full_table,
    json_text,
    markdown_lines,
    markdown_list,
    records,
    text_table,
)
from multibody_xval.scenarios.verdicts.finding import Finding, Metric, Verdict, failing, failures, silent, unmodelled

Results = Mapping[Scenario, Sequence[Finding]]
"""Findings by scenario, in the order in which they were run."""

VERDICT_LEGEND = """\
- *Agrees*: the difference from the expected number is allowed. Allowed is the sum of three parts: the error bar of the
  expected number; the error of the engine's own time step, from two step sizes, and no less than the reference's at the
  same step; and what neither can resolve.
- *As its law predicts*: a disagreement that the law of the preset, a model with constants from the preset's options,
  gives too. Engine and law also differ by no more than the law's bound after a period from the same state.
- *Unmodelled*: any other disagreement.
- *Own step too coarse*: the difference is allowed, but the errors of steps in the allowance are more than a tenth of
  what friction changes at all, or, where that has no size of its own, of what is expected.
- *Inconclusive*: there is no certified steady state, nothing to compare, or no result so far (skipped as too slow, or
  left out by --no-run).
- *Says nothing*: no certified steady state, or too coarse a step, where the law of the preset does not say the same; or
  an engine that fails.
- *Blocked*: the engine is not installed, cannot represent the case, or fails: a crash, the time limit, NaN.
- *Worst*: the largest difference over what is allowed for it.
"""


@dataclass(frozen=True)
class VariantRow:
    """The verdicts of one variant in one scenario, counted."""

    variant: Variant
    findings: tuple[Finding, ...]

    def count(self, verdict: Verdict) -> int:
        """How many findings have this verdict."""
        return sum(1 for finding in self.findings if finding.comparison.verdict is verdict)

    @property
    def worst(self) -> Finding | None:
        """The finding whose difference is largest beside what is allowed; ``None`` where none has a number."""
        worst = max(self.findings, key=lambda own: own.excess)
        return None if math.isnan(worst.comparison.excess) else worst

    @property
    def reason(self) -> str:
        """Of the worst finding, or why there is none."""
        if self.worst is None:
            return self.findings[0].comparison.reason
        return f"{self.worst.metric.name}, {self.worst.case}: {self.worst.comparison.reason}"

    @property
    def outcome(self) -> str:
        """One word, and how many findings it is of."""
        total = len(self.findings)
        disagree = self.count(Verdict.DISAGREE)
        if unmodelled(self.findings):
            return f"DISAGREES {disagree}/{total}"
        if failures(self.findings):
            return f"SAYS NOTHING {len(silent(self.findings))}/{total}"
        if disagree:
            return f"modelled {disagree}/{total}"
        for verdict in (Verdict.BLOCKED, Verdict.INCONCLUSIVE, Verdict.TOO_COARSE):
            if self.count(verdict):
                return f"{verdict} {self.count(verdict)}/{total}"
        return f"agrees {total}"


VERDICT_COLUMNS: tuple[Column[VariantRow], ...] = (
    Column("variant", lambda row: str(row.variant), "engine:formulation:preset"),
    *(Column(str(verdict), partial(VariantRow.count, verdict=verdict)) for verdict in Verdict),
    Column(
        "worst", lambda row: None if row.worst is None else f"{row.worst.comparison.excess:.2g}".replace("inf", "∞")
    ),
    Column("what", lambda row: row.reason),
)
"""Printed columns of a variant."""


def rows_of(findings: Sequence[Finding]) -> list[VariantRow]:
    """Give a row a variant, in their order."""
    variants = dict.fromkeys(finding.variant for finding in findings)
    return [
        VariantRow(variant, tuple(finding for finding in findings if finding.variant == variant))
        for variant in variants
    ]


def verdict_table(findings: Sequence[Finding]) -> pd.DataFrame:
    """Give a table for people: a row a variant, with its verdicts counted and the worst of them."""
    return text_table(VERDICT_COLUMNS, rows_of(findings))


def matrix(results: Results) -> pd.DataFrame:
    """Give variants × scenarios, with the outcome of each variant in each scenario."""
    outcomes = {
        scenario.name: {str(row.variant): row.outcome for row in rows_of(findings)}
        for scenario, findings in results.items()
    }
    variants = list(dict.fromkeys(variant for column in outcomes.values() for variant in column))
    table = pd.DataFrame(outcomes, index=variants, dtype=object).fillna("–")
    return table.rename_axis("engine:formulation:preset").reset_index()


def details(findings: Sequence[Finding]) -> Iterator[tuple[Variant, list[str]]]:
    """Give the variants that do not agree throughout, each with a line for every metric and verdict but agreement."""
    for row in rows_of(findings):
        groups: dict[tuple[Metric, Verdict], list[Finding]] = {}
        for finding in row.findings:
            if finding.comparison.verdict is not Verdict.AGREE:
                groups.setdefault((finding.metric, finding.comparison.verdict), []).append(finding)
        if groups:
            yield row.variant, [_detail(group) for group in groups.values()]


def _detail(group: Sequence[Finding]) -> str:
    """One line for findings of one metric and verdict: the worst of them, and how many there are."""
    worst = max(group, key=lambda own: own.excess)
    more = f" (and {len(group) - 1} more)" if len(group) > 1 else ""
    reason = f"{worst.comparison.reason}{_law(worst, '; ')}{more}"
    return f"{worst.comparison.verdict}, {worst.metric.name}, {worst.case}: {reason}"


def _law(finding: Finding, before: str) -> str:
    """Give what the law says, after what comes `before` it; nothing where it says nothing."""
    return "" if finding.prediction is None else f"{before}{finding.prediction}"


def law_in_words(variant: Variant) -> str:
    """Say how a variant deviates, in words where there are some, else by the formula of its law."""
    model = variant.law
    law = None if model is None else law_of(model.preset)
    return variant.preset.known_deviation or ("" if law is None else law.formula)


MOST_SHOWN = 10
"""Numbers that the summary of a document shows; everything else is folded."""


def verdict_document(results: Results, command: str) -> str:
    """Give everything as a document for a comment on a pull request: a summary, and each scenario folded."""
    findings = [finding for own in results.values() for finding in own]
    lines = [*_summary(results), "", *markdown_lines(matrix(results)), "", *_largest(results)]
    for scenario, own in results.items():
        lines += _folded(scenario.name, [scenario.question, "", *_description(scenario), "", *_verdicts(own)])
    lines += _folded("What the words mean", [VERDICT_LEGEND])
    names = sorted({finding.variant.engine for finding in findings})
    versions = f"Versions: {versions_of(names)}; Python {platform.python_version()}."
    return "\n".join([*lines, "", f"Made by `{command}`. {versions}", ""])


def _summary(results: Results) -> list[str]:
    """Say whether the run fails, and why."""
    findings = [finding for own in results.values() for finding in own]
    count = Counter(str(finding.comparison.verdict) for finding in findings)
    verdicts = ", ".join(f"{count[verdict]} {verdict}" for verdict in Verdict if count[verdict])
    predicted = sum(finding.modelled for finding in findings)
    fails = sum(len(failing(own)) for own in results.values())
    counted = f"{len(findings)} numbers: {verdicts}; {predicted} as their law predicts, {fails} fail."
    lines = markdown_list(f"{scenario.name}: {line}" for scenario, own in results.items() for line in failures(own))
    return [f"## Verdicts: {'fails' if lines else 'passes'}", "", counted, "", *lines]


_Row = tuple[Scenario, Finding]

LARGEST_COLUMNS: tuple[Column[_Row], ...] = (
    Column("variant", lambda row: str(row[1].variant)),
    Column("scenario", lambda row: row[0].name),
    Column("case", lambda row: row[1].case),
    Column("metric", lambda row: row[1].metric.name),
    Column("difference", lambda row: row[1].comparison.difference, pattern="{:+.3g}"),
    Column("allowed", lambda row: row[1].comparison.tolerance, pattern="{:.2g}"),
    Column("verdict", lambda row: f"{row[1].comparison.verdict}{', modelled' * row[1].modelled}"),
)


def _largest(results: Results) -> list[str]:
    """Give what fails, and what disagrees, the largest differences over what is allowed first."""
    fails = {id(finding) for own in results.values() for finding in failing(own)}
    rows = [(scenario, finding) for scenario, own in results.items() for finding in own]
    rows = [row for row in rows if id(row[1]) in fails or row[1].comparison.verdict is Verdict.DISAGREE]
    rows.sort(key=lambda row: (id(row[1]) not in fails, -row[1].excess))
    if not rows:
        return []
    title = f"The {MOST_SHOWN} largest of {len(rows)}:" if len(rows) > MOST_SHOWN else "What disagrees:"
    return [title, "", *markdown_lines(text_table(LARGEST_COLUMNS, rows[:MOST_SHOWN])), ""]


def _folded(title: str, lines: Sequence[str]) -> list[str]:
    return ["", f"<details><summary>{title}</summary>", "", *lines, "", "</details>"]


def _description(scenario: Scenario) -> list[str]:
    lines = [f"- from: {scenario.source}", f"- compared with: {scenario.expects}"]
    lines += [
        f"- {metric.name}{f' [{metric.unit}]' if metric.unit else ''}: {metric.meaning}" for metric in scenario.metrics
    ]
    return lines + [f"- {line}" for line in scenario.parameters()]


def _verdicts(findings: Sequence[Finding]) -> list[str]:
    """Give the verdicts of a scenario, what does not agree, and the laws that predict it."""
    lines = markdown_lines(verdict_table(findings))
    wrong = list(details(findings))
    if wrong:
        lines += ["", "What does not agree:", ""]
    for variant, remarks in wrong:
        lines += [f"- {variant}", *(f"  {line}" for line in markdown_list(remarks))]
    predicted = dict.fromkeys(finding.variant for finding in findings if finding.modelled)
    if predicted:
        lines += ["", "What the laws of the presets are:", ""]
    return lines + [f"- {variant}: {law_in_words(variant)}" for variant in predicted]


def _predicted(name: str) -> Column[_Row]:
    return Column(f"law {name}".replace("_", " "), lambda row: getattr(row[1].prediction, name, math.nan))


FINDING_COLUMNS: tuple[Column[_Row], ...] = (
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
    Column("modelled", lambda row: row[1].modelled),
    *(_predicted(name) for name in ("value", "difference", "allowed", "distance", "period_bound")),
    Column("reason", lambda row: row[1].comparison.reason),
)


def finding_table(results: Results) -> pd.DataFrame:
    """Give every finding, with full precision."""
    return full_table(FINDING_COLUMNS, [(scenario, finding) for scenario, own in results.items() for finding in own])


class VerdictTable(pd.DataFrame):
    """Verdicts, a row a number; printed as one line.

    A part of it, such as ``table[table.verdict == "disagree"]``, is shown row by row. As a figure:
    ``table.counts.plot.barh(stacked=True)``.
    """

    @property
    def _constructor(self) -> type[pd.DataFrame]:
        return pd.DataFrame

    @property
    def counts(self) -> pd.DataFrame:
        """How many numbers of each variant in each scenario have which verdict, a row a variant."""
        names = ["scenario", "engine", "formulation", "preset"]
        modelled = self["modelled"].map({True: ", as its law predicts"}).fillna("")
        return self.assign(verdict=self["verdict"] + modelled).value_counts([*names, "verdict"]).unstack(fill_value=0)

    def __repr__(self) -> str:
        """Count the verdicts."""
        each = ", ".join(f"{count:,} {verdict}" for verdict, count in self.counts.sum().items())
        return f"<verdicts on {len(self):,} numbers: {each}>"


def _content(results: Results, command: str) -> dict[str, object]:
    findings = [finding for own in results.values() for finding in own]
    return {
        "command": command,
        "passes": not any(failing(own) for own in results.values()),
        "versions": versions_of(sorted({finding.variant.engine for finding in findings})),
        "scenarios": [
            {"name": scenario.name, "question": scenario.question, "source": scenario.source,
             "expects": scenario.expects, "parameters": scenario.parameters()}
            for scenario in results
        ],
        "findings": records(finding_table(results)),
        "laws": {str(finding.variant): law_in_words(finding.variant) for finding in findings if finding.modelled},
    }  # fmt: skip


VERDICT_FORMATS: dict[str, Callable[[Results, str], str]] = {
    ".md": verdict_document,
    ".json": lambda results, command: json_text(_content(results, command), indent=1),
    ".csv": lambda results, _command: csv_text(finding_table(results), missing=""),
}
"""What is written of verdicts and the command that made them, by the ending of the file."""
