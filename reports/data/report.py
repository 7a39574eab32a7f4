"""The content of a report, from which its sections are made."""

from collections import Counter
from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any

import pandas as pd

from engines.interface.variant import Variant
from reports.data.catalogue import Outcomes
from reports.data.options import Installed, OptionCurve, SingleOption, installed, option_curves, single_options
from reports.data.points import by_variant, edge_table, point_rows, point_table, table_of
from reports.data.provenance import provenance
from reports.data.stick_slip import CasePoint, stick_slip_rows
from reports.data.variants import VariantErrors, blocked_reason, departures, variant_errors, verdict_row
from reports.data.versions import version_pairs
from scenarios.runs.recorded import RecordedPeriod
from scenarios.runs.result import ResultStatus
from scenarios.studies.friction_map import FrictionMap
from scenarios.studies.work_precision import StepPoint
from scenarios.sweeps.compared import ComparedSweep
from scenarios.sweeps.point import Point
from scenarios.sweeps.start_check import StartCheck
from scenarios.verdicts.finding import failures


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
    starts: tuple[StartCheck, ...] = ()
    """Of which points steady states were searched from elsewhere too, by variant."""
    recorded: Mapping[str, Mapping[str, Any]] = field(default_factory=dict)
    """Package, version, description and options by the name of a variant, where they were noted with the results."""
    beside: tuple[Point, ...] = ()
    """Points of variants that are compared with the truth at a few points only, and have no verdict."""
    one_option: tuple[Point, ...] = ()
    """Points of variants that differ in one option from a preset, at a few points of the grid."""
    catalogue: Outcomes = field(default_factory=dict)
    """What is known of the scenarios of the catalogue."""

    @property
    def missing(self) -> Mapping[Variant, int]:
        """Points of the grid that are not evaluated so far, by variant; variants without any are left out."""
        return Counter(point.variant for point in self.result.points if point.result.status is ResultStatus.MISSING)

    @cached_property
    def points(self) -> pd.DataFrame:
        """Every point of the grid, a row each."""
        return table_of(self.result, self._rows)

    @cached_property
    def _rows(self) -> list[dict[str, Any]]:
        return point_rows(self.result.points)

    @cached_property
    def edges(self) -> pd.DataFrame:
        """Both edges of every curve, a row each."""
        return edge_table(self.result)

    @cached_property
    def verdicts(self) -> Mapping[Variant, dict[str, Any]]:
        """What the points and edges of each variant come to, see `verdict_row`."""
        variants = self.result.sweep.variants
        points, edges = by_variant(self.points, variants), by_variant(self.edges, variants)
        return {variant: verdict_row(points[variant], edges[variant]) for variant in variants}

    @cached_property
    def blocked(self) -> Mapping[Variant, str]:
        """Why variants have no result at all; those that have one are left out."""
        reasons = {variant: blocked_reason(self.result, variant) for variant in self.result.sweep.variants}
        return {variant: reason for variant, reason in reasons.items() if reason is not None}

    @cached_property
    def departures(self) -> list[dict[str, Any]]:
        """What departs of each variant, and what its law leaves of it."""
        variants = self.result.sweep.variants
        points, edges = by_variant(self.points, variants), by_variant(self.edges, variants)
        rows = (departures(variant, points[variant], edges[variant]) for variant in variants)
        return [row for row in rows if row is not None]

    @cached_property
    def errors(self) -> Mapping[Variant, VariantErrors]:
        """How far each variant is from the truth, the smallest error first."""
        return variant_errors(self._wide)

    @cached_property
    def few_errors(self) -> Mapping[Variant, VariantErrors]:
        """Errors of the variants that differ in one option from a preset, and of all others at the same points."""
        return variant_errors(self._few)

    @cached_property
    def _wide(self) -> pd.DataFrame:
        """Points of the grid, and those of variants that are compared with the truth at a few."""
        return table_of(self.result, [*self._rows, *point_rows(self.beside)])

    @cached_property
    def _few(self) -> pd.DataFrame:
        """All points at the places of those with single options."""
        places = {point.place[1:] for point in self.one_option}
        others = (point for point in (*self.result.points, *self.beside) if point.place[1:] in places)
        return point_table(self.result, [*others, *self.one_option])

    @cached_property
    def single_options(self) -> list[SingleOption]:
        """Defaults with one option of the tuned preset each, the smallest error of an engine and formulation first."""
        return single_options(self.few_errors)

    @cached_property
    def installed(self) -> list[Installed]:
        """Engines as installed beside their tuned presets, the largest error first."""
        return installed(self.errors, self.single_options)

    @cached_property
    def option_curves(self) -> list[OptionCurve]:
        """Errors over one option of an engine, where variants differ in that alone: over the grid, or a few points."""
        wide, few = option_curves(self.errors, self._wide), option_curves(self.few_errors, self._few)
        shown = {(curve.title, curve.option) for curve in wide}
        return wide + [curve for curve in few if (curve.title, curve.option) not in shown]

    @cached_property
    def versions(self) -> list[dict[str, Any]]:
        """How versions of one engine differ, see `version_pairs`."""
        described = dict(zip(self.result.sweep.variants, self.provenance["variants"], strict=True))
        return version_pairs(self.result, described)

    @cached_property
    def failures(self) -> list[str]:
        """Why the comparison fails, a line each: unexplained disagreements, variants with too little certified."""
        return failures(self.result.findings)

    @cached_property
    def stick_slip(self) -> list[dict[str, Any]]:
        """Modes of every variant beside the reference's, see `stick_slip_rows`."""
        return stick_slip_rows(self.result)

    @cached_property
    def provenance(self) -> dict[str, Any]:
        """Everything that a reader needs to reproduce the numbers, as plain data."""
        return provenance(self.result, self.command, self.points, self.recorded, self.starts)
