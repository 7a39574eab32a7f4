"""The content of a report, from which its sections are made."""

from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any

import pandas as pd

from multibody_xval.engines.interface.variant import Variant
from multibody_xval.reports.data.catalogue import Outcomes
from multibody_xval.reports.data.options import Headline, headlines
from multibody_xval.reports.data.points import by_variant, edge_table, point_table
from multibody_xval.reports.data.provenance import provenance
from multibody_xval.reports.data.stick_slip import CasePoint, stick_slip_rows
from multibody_xval.reports.data.variants import Errors, deviations, error_table, errors_of, verdict_row
from multibody_xval.scenarios.runs.recorded import RecordedPeriod
from multibody_xval.scenarios.runs.result import ResultStatus
from multibody_xval.scenarios.studies.claims import Conclusions
from multibody_xval.scenarios.studies.friction_map import FrictionMap
from multibody_xval.scenarios.studies.response import Curves
from multibody_xval.scenarios.studies.work_precision import StepPoint
from multibody_xval.scenarios.sweeps.checks import Check
from multibody_xval.scenarios.sweeps.compared import ComparedSweep
from multibody_xval.scenarios.sweeps.point import Point
from multibody_xval.scenarios.sweeps.sweep import Case
from multibody_xval.scenarios.verdicts.finding import Finding, Verdict, failures, unmodelled
from multibody_xval.scenarios.verdicts.steady_case import REFERENCE


@dataclass(frozen=True)
class Report:
    """Results, as they were collected."""

    result: ComparedSweep
    """The sweep, every variant compared with the reference."""
    command: str
    """The command line that gives the same numbers."""
    periods: Mapping[CasePoint, Mapping[Variant, RecordedPeriod]] = field(default_factory=dict)
    """One period of the reference and of every variant, by case and frequency ratio; unknown ones have a reason."""
    steps: tuple[StepPoint, ...] | None = ()
    """Error and cost at several step sizes; ``None`` if they are no part of the report."""
    friction_map: FrictionMap | None = None
    """Transmittance over friction and frequency; ``None`` if it is no part of the report."""
    starts: tuple[Check, ...] = ()
    """Of which points steady states were searched from elsewhere too, by variant."""
    recorded: Mapping[str, Mapping[str, Any]] = field(default_factory=dict)
    """Package, version, description and options by the name of a variant, where they were noted with the results."""
    headline: tuple[Point, ...] = ()
    """Points of all variants, those of no grid too, by which they are compared with the truth, see `headline_points`;
    without any, that is done on the grid."""
    unit_cell: Curves = field(default_factory=dict)
    chain: Curves = field(default_factory=dict)
    """Responses of a single cell and of the chain at the paper's friction ratios, by the reference; none where they are
    not asked."""
    catalogue: Outcomes = field(default_factory=dict)
    """What is known of the scenarios of the catalogue."""
    scenes: pd.DataFrame = field(default_factory=pd.DataFrame)
    """What is known of scenes, of any engine, see `scene_numbers`; empty where that is nothing."""
    conclusions: tuple[Conclusions, ...] = ()
    """The paper's claims, answered for the reference and then every variant; none where they are not asked."""

    @property
    def of_dataset(self) -> bool:
        """Whether it is made of a dataset, which holds the points of its grid and nothing between them."""
        return bool(self.recorded)

    @property
    def missing(self) -> Mapping[Variant, int]:
        """Points of the grid that are not evaluated so far, by variant; variants without any are left out."""
        return Counter(point.variant for point in self.result.points if point.result.status is ResultStatus.MISSING)

    @cached_property
    def blocked(self) -> Mapping[Variant, str]:
        """Why variants have no result at all; those that have one are left out."""
        results = {variant: [point.result for point in self.result.points_of(variant)] for variant in self.variants}
        return {
            variant: own[0].reason
            for variant, own in results.items()
            if own and all(result.status is ResultStatus.BLOCKED for result in own)
        }

    @property
    def variants(self) -> Sequence[Variant]:
        """Those of the grid."""
        return self.result.sweep.variants

    @cached_property
    def _every(self) -> pd.DataFrame:
        return point_table(self.result, headline=self.headline)

    @cached_property
    def points(self) -> pd.DataFrame:
        """Every point of the grid, a row each."""
        return self._every[self._every["part"] == "grid"]

    @cached_property
    def _curves(self) -> dict[Any, pd.DataFrame]:
        return dict(iter(self.points.groupby(["variant", "case"], sort=False)))

    def curve(self, variant: Variant, case: Case) -> pd.DataFrame:
        """Points of one curve."""
        return self._curves.get((variant, case), self.points.iloc[:0])

    @cached_property
    def reference_lines(self) -> Mapping[Case, pd.Series]:
        """Transmittance [dB] of the reference by η_r in each case: its dense curve, and the grid with resonances."""
        lines = {}
        for case in self.result.cases:
            eta, dense = self.result.dense_reference.get(case, ((), ()))
            own = self.curve(REFERENCE, case).set_index("frequency_ratio")
            known = own["transmittance_db"].where(own["status"] == ResultStatus.CONVERGED)
            line = pd.Series(dense, eta, dtype=float).drop(known.index, errors="ignore")
            lines[case] = pd.concat([line, known]).sort_index()
        return lines

    @cached_property
    def edges(self) -> pd.DataFrame:
        """Both edges of every curve, a row each."""
        return edge_table(self.result)

    @cached_property
    def verdicts(self) -> Mapping[Variant, dict[str, Any]]:
        """What the points and edges of each variant come to, see `verdict_row`."""
        return {variant: verdict_row(points, edges) for variant, points, edges in self._by_variant}

    @cached_property
    def deviations(self) -> list[dict[str, Any]]:
        """What deviates of each variant, and what its law leaves of it."""
        return [row for own in self._by_variant if (row := deviations(*own)) is not None]

    @property
    def _by_variant(self) -> Iterator[tuple[Variant, pd.DataFrame, pd.DataFrame]]:
        edges = by_variant(self.edges, self.variants)
        return ((variant, points, edges[variant]) for variant, points in by_variant(self.points, self.variants).items())

    @cached_property
    def ruled(self) -> pd.DataFrame:
        """The points by which variants are compared with the truth."""
        return self._every[self._every["part"] == "headline"] if self.headline else self.points

    @cached_property
    def error_table(self) -> pd.DataFrame:
        """How far each variant is from the truth, the smallest error first."""
        return error_table(self.ruled, self.result.sweep.case_axes)

    @cached_property
    def errors(self) -> Errors:
        """Its rows, by variant."""
        return errors_of(self.error_table)

    @cached_property
    def headlines(self) -> list[Headline]:
        """How far each engine is off as installed, as recommended and tuned."""
        return headlines(self.errors)

    @cached_property
    def failures(self) -> list[str]:
        """Why the comparison fails, a line each: unmodelled disagreements, variants with too little certified."""
        return failures(self.result.findings)

    @property
    def compared(self) -> list[Finding]:
        """Every number that is compared, but for those of the reference with itself."""
        return [finding for finding in self.result.findings if finding.variant.engine != REFERENCE.engine]

    @cached_property
    def status(self) -> str:
        """Whether the comparison passes, and what its numbers come to, in one line."""
        agree, predicted, unexplained, rest = counted(self.compared).values()
        judged = f"{agree:,} agree, {predicted:,} differ as the engine’s model predicts, {unexplained:,} unexplained"
        open_ones = f"; not judged: {rest:,}, without a steady state or with too coarse a step" if rest else ""
        return f"{'failed' if self.failures else 'passed'}: {judged}{open_ones}"

    @cached_property
    def stick_slip(self) -> list[dict[str, Any]]:
        """Modes of every variant beside the reference's, see `stick_slip_rows`."""
        return stick_slip_rows(self.result)

    @cached_property
    def provenance(self) -> dict[str, Any]:
        """Everything that a reader needs to reproduce the numbers, as plain data."""
        return provenance(self)


def counted(findings: Sequence[Finding]) -> dict[str, int]:
    """Count numbers by what their comparison comes to; each stands in one count."""
    agree = sum(finding.comparison.verdict is Verdict.AGREE for finding in findings)
    unexplained = len(unmodelled(findings))
    predicted = sum(finding.comparison.verdict is Verdict.DISAGREE and finding.modelled for finding in findings)
    rest = len(findings) - agree - unexplained - predicted
    return {"agree": agree, "as predicted": predicted, "unexplained": unexplained, "not judged": rest}
