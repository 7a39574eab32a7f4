"""Verdicts as tables: for the terminal, for documents, for other programs."""

import math
import platform
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import groupby

import pandas as pd

from engines.interface.registry import engine
from engines.interface.variant import Variant
from scenarios.catalogue.base import Scenario
from scenarios.tables import Column, csv_text, full_table, json_text, markdown_lines, records, text_table
from scenarios.verdicts.finding import Finding, Metric
from scenarios.verdicts.verdict import Verdict

Results = Mapping[Scenario, Sequence[Finding]]
"""Findings by scenario, in the order in which they were run."""

LEGEND = """\
A number *agrees* if it is within what is allowed of what is expected: the error bar of the expected number, plus the
error of the engine's own time step, estimated from two step sizes (and taken to be no less than the reference's at the
same step), plus what neither can resolve. A disagreement is *explained* where the preset names a law of the engine by
which it departs from Coulomb's, and *unexplained* otherwise. *Inconclusive*: there is no certified steady state,
nothing to compare, or no answer so far (too slow to be asked, or left out by --no-ask). *Blocked*: the engine is not
installed, or has failed. *Worst*: the largest difference over what is
allowed for it.
"""


def explained(finding: Finding) -> bool:
    """Say whether a disagreement has a law of the engine for its reason."""
    return finding.comparison.verdict is Verdict.DISAGREE and bool(finding.variant.preset.known_deviation)


def unexplained(findings: Sequence[Finding]) -> list[Finding]:
    """Give the disagreements without a reason."""
    return [one for one in findings if one.comparison.verdict is Verdict.DISAGREE and not explained(one)]


@dataclass(frozen=True)
class VariantRow:
    """The verdicts of one variant in one scenario, counted."""

    variant: Variant
    findings: tuple[Finding, ...]

    def count(self, verdict: Verdict) -> int:
        """How many findings have this verdict."""
        return sum(1 for one in self.findings if one.comparison.verdict is verdict)

    @property
    def worst(self) -> Finding | None:
        """The finding whose difference is largest beside what is allowed; ``None`` where none has a number."""
        known = [one for one in self.findings if not math.isnan(one.comparison.excess)]
        return max(known, key=lambda finding: finding.comparison.excess, default=None)

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
        if unexplained(self.findings):
            return f"DISAGREES {disagree}/{total}"
        if disagree:
            return f"explained {disagree}/{total}"
        for verdict in (Verdict.BLOCKED, Verdict.INCONCLUSIVE):
            if self.count(verdict):
                return f"{verdict} {self.count(verdict)}/{total}"
        return f"agrees {total}"


def _count(verdict: Verdict) -> Column[VariantRow]:
    return Column(str(verdict), lambda row: row.count(verdict))


COLUMNS: tuple[Column[VariantRow], ...] = (
    Column("variant", lambda row: str(row.variant), "engine:formulation:preset"),
    *(_count(verdict) for verdict in Verdict),
    Column(
        "worst", lambda row: None if row.worst is None else f"{row.worst.comparison.excess:.2g}".replace("inf", "∞")
    ),
    Column("what", lambda row: row.reason),
)
"""What is printed of a variant."""


def rows_of(findings: Sequence[Finding]) -> list[VariantRow]:
    """Give a row a variant, in their order."""
    variants = dict.fromkeys(one.variant for one in findings)
    return [VariantRow(variant, tuple(one for one in findings if one.variant == variant)) for variant in variants]


def verdict_table(findings: Sequence[Finding]) -> pd.DataFrame:
    """Give a table for people: a row a variant, with its verdicts counted and the worst of them."""
    return text_table(COLUMNS, rows_of(findings))


def matrix(results: Results) -> pd.DataFrame:
    """Give variants × scenarios, with the outcome of each variant in each scenario."""
    outcomes = {one.name: {str(row.variant): row.outcome for row in rows_of(found)} for one, found in results.items()}
    variants = list(dict.fromkeys(variant for column in outcomes.values() for variant in column))
    table = pd.DataFrame(outcomes, index=variants, dtype=object).fillna("–")
    return table.rename_axis("engine:formulation:preset").reset_index()


def details(findings: Sequence[Finding]) -> Iterator[tuple[Variant, list[str]]]:
    """Give the variants that do not agree throughout, each with a line for every metric and verdict but agreement."""
    for row in rows_of(findings):
        wrong = [one for one in row.findings if one.comparison.verdict is not Verdict.AGREE]
        if wrong:
            order: dict[tuple[Metric, Verdict], list[Finding]] = {}
            for one in wrong:
                order.setdefault((one.metric, one.comparison.verdict), []).append(one)
            yield row.variant, [_detail(group) for group in order.values()]


def _detail(group: Sequence[Finding]) -> str:
    """One line for findings of one metric and verdict: the worst of them, and how many there are."""
    worst = max(group, key=lambda one: -1.0 if math.isnan(one.comparison.excess) else one.comparison.excess)
    more = f" (and {len(group) - 1} more)" if len(group) > 1 else ""
    return f"{worst.comparison.verdict}, {worst.metric.name}, {worst.case}: {worst.comparison.reason}{more}"


def law(variant: Variant) -> str:
    """Give the law by which a variant departs from Coulomb's; empty where there is none."""
    return variant.preset.known_deviation


def markdown(results: Results, command: str) -> str:
    """Give everything as a document, with how it was made."""
    lines = ["# Verdicts", "", LEGEND, f"Made by `{command}`.", ""]
    lines += [*markdown_lines(matrix(results)), "", "## Laws of the engines that explain disagreements", ""]
    findings = [one for found in results.values() for one in found]
    lines += [
        f"- {variant}: {law(variant)}" for variant in dict.fromkeys(one.variant for one in findings if explained(one))
    ]
    for scenario, found in results.items():
        lines += ["", f"## {scenario.name}", "", scenario.question, ""]
        lines += [f"- from: {scenario.source}", f"- compared with: {scenario.expects}"]
        lines += [
            f"- {metric.name}{f' [{metric.unit}]' if metric.unit else ''}: {metric.meaning}"
            for metric in scenario.metrics
        ]
        lines += [f"- {line}" for line in scenario.parameters()]
        lines += ["", *markdown_lines(verdict_table(found))]
        wrong = list(details(found))
        if wrong:
            lines += ["", "What does not agree:", ""]
        for variant, remarks in wrong:
            lines += [f"- {variant}", *(f"  - {remark}" for remark in remarks)]
    return "\n".join([*lines, "", f"Versions: {versions(findings)}; Python {platform.python_version()}.", ""])


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
    Column("explained", lambda row: explained(row[1])),
    Column("difference", lambda row: row[1].comparison.difference),
    Column("allowed", lambda row: row[1].comparison.tolerance),
    Column("reason", lambda row: row[1].comparison.reason),
)


def finding_table(results: Results) -> pd.DataFrame:
    """Give every finding, with full precision."""
    return full_table(FINDING_COLUMNS, [(scenario, one) for scenario, found in results.items() for one in found])


def verdicts_text(results: Results, command: str, ending: str) -> str:
    """Give the verdicts in the format of a file: ``.md``, ``.csv`` or ``.json``."""
    if ending == ".md":
        return markdown(results, command)
    if ending == ".csv":
        return csv_text(finding_table(results), missing="")
    return json_text(_content(results, command), indent=1)


def _content(results: Results, command: str) -> dict[str, object]:
    """Give every finding, what was asked and the versions."""
    findings = [one for found in results.values() for one in found]
    return {
        "command": command,
        "versions": versions(findings),
        "scenarios": [
            {"name": one.name, "question": one.question, "source": one.source, "expects": one.expects,
             "parameters": one.parameters()}
            for one in results
        ],
        "findings": records(finding_table(results)),
        "laws": {str(one.variant): law(one.variant) for one in findings if explained(one)},
    }  # fmt: skip


def versions(findings: Sequence[Finding]) -> str:
    """Name every engine's version once."""
    names = [name for name, _ in groupby(sorted(one.variant.engine for one in findings))]
    installed = [engine(name) for name in names if engine(name).unavailable_reason() is None]
    return ", ".join(f"{one.name} {one.version()}" for one in installed)
