"""Verdicts as tables: for the terminal, for documents, for other programs."""

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass

import pandas as pd

from engines.interface.law_engine import law_of
from engines.interface.variant import Variant
from scenarios.catalogue.base import Scenario
from scenarios.tables import Column, text_table
from scenarios.verdicts.failure import failures, silent, unexplained
from scenarios.verdicts.finding import Finding, Metric
from scenarios.verdicts.verdict import Verdict

Results = Mapping[Scenario, Sequence[Finding]]
"""Findings by scenario, in the order in which they were run."""

VERDICT_LEGEND = """\
- *Agrees*: the difference from the expected number is allowed. Allowed is the sum of three parts: the error bar of the
  expected number; the error of the engine's own time step, from two step sizes, and no less than the reference's at the
  same step; and what neither can resolve.
- *As its law predicts*: a disagreement that the law of the preset, a model with constants from the preset's options,
  gives too. Engine and law also differ by no more than the law's bound after a period from the same state.
- *Unexplained*: any other disagreement.
- *Own step too coarse*: the difference is allowed, but the errors of steps in the allowance are more than a tenth of
  what friction changes at all.
- *Inconclusive*: there is no certified steady state, nothing to compare, or no result so far (skipped as too slow, or
  left out by --no-ask).
- *Says nothing*: no certified steady state, or too coarse a step, where the law of the preset does not say the same.
- *Blocked*: the engine is not installed, or has failed.
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
        worst = max(self.findings, key=excess)
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
        if unexplained(self.findings):
            return f"DISAGREES {disagree}/{total}"
        if failures(self.findings):
            return f"SAYS NOTHING {len(silent(self.findings))}/{total}"
        if disagree:
            return f"as predicted {disagree}/{total}"
        for verdict in (Verdict.BLOCKED, Verdict.INCONCLUSIVE, Verdict.TOO_COARSE):
            if self.count(verdict):
                return f"{verdict} {self.count(verdict)}/{total}"
        return f"agrees {total}"


def _count(verdict: Verdict) -> Column[VariantRow]:
    return Column(str(verdict), lambda row: row.count(verdict))


VERDICT_COLUMNS: tuple[Column[VariantRow], ...] = (
    Column("variant", lambda row: str(row.variant), "engine:formulation:preset"),
    *(_count(verdict) for verdict in Verdict),
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
        wrong = [finding for finding in row.findings if finding.comparison.verdict is not Verdict.AGREE]
        if wrong:
            order: dict[tuple[Metric, Verdict], list[Finding]] = {}
            for finding in wrong:
                order.setdefault((finding.metric, finding.comparison.verdict), []).append(finding)
            yield row.variant, [_detail(group) for group in order.values()]


def excess(finding: Finding) -> float:
    """Give the difference over what is allowed; −1 where there is none."""
    return -1.0 if math.isnan(finding.comparison.excess) else finding.comparison.excess


def _detail(group: Sequence[Finding]) -> str:
    """One line for findings of one metric and verdict: the worst of them, and how many there are."""
    worst = max(group, key=excess)
    more = f" (and {len(group) - 1} more)" if len(group) > 1 else ""
    law = "" if worst.prediction is None else f"; {worst.prediction}"
    return f"{worst.comparison.verdict}, {worst.metric.name}, {worst.case}: {worst.comparison.reason}{law}{more}"


def law_in_words(variant: Variant) -> str:
    """Say how a variant departs, in words where there are some, else by the formula of its law."""
    model = variant.inclined_law
    law = None if model is None else law_of(model.preset)
    return variant.preset.known_deviation or ("" if law is None else law.formula)
