"""The content of a report, from which its sections are made."""

from collections import Counter
from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any

from engines.interface.variant import Variant
from reports.data.catalogue import Outcomes
from reports.data.departures import Departures, departures
from reports.data.errors import VariantErrors, variant_errors
from reports.data.findings import VariantFindings, findings
from reports.data.installed import Installed, installed
from reports.data.option_curves import OptionCurve, option_curves
from reports.data.provenance import provenance
from reports.data.single_options import SingleOption, single_options
from reports.data.stick_slip import CasePoint, stick_slip_rows
from reports.data.versions import VersionPair, version_pairs
from scenarios.studies.friction_map import FrictionMap
from scenarios.studies.work_precision import StepPoint
from scenarios.sweeps.compared import ComparedSweep
from scenarios.sweeps.start_check import StartCheck
from scenarios.sweeps.table import Point
from scenarios.sweeps.truths import Truths
from scenarios.tasks.recorded import RecordedPeriod
from scenarios.tasks.result import ResultStatus
from scenarios.verdicts.failure import failures


@dataclass(frozen=True)
class Report:
    """Results, as they were collected.

    Parameters
    ----------
    result
        The sweep, every variant compared with the reference.
    command
        The command line that gives the same numbers.
    periods
        One period of the reference and of every variant, by case and frequency ratio; unknown ones have a reason.
    steps
        Error and cost at several step sizes; ``None`` if they are no part of the report.
    friction_map
        Transmittance over friction and frequency; ``None`` if it is no part of the report.
    starts
        Of which points steady states were searched from elsewhere too, by variant.
    recorded
        Package, version, description and options by the name of a variant, where they were noted with the results.
    truths
        The true transmittance by case and frequency ratio.
    beside
        Points of variants that are compared with the truth at a few points only, and have no verdict.
    one_option
        Points of variants that differ in one option from a preset, at a few points of the grid.
    catalogue
        What is known of the scenarios of the catalogue.
    """

    result: ComparedSweep
    command: str
    periods: Mapping[CasePoint, Mapping[Variant, RecordedPeriod]] = field(default_factory=dict)
    steps: tuple[StepPoint, ...] | None = ()
    friction_map: FrictionMap | None = None
    starts: tuple[StartCheck, ...] = ()
    recorded: Mapping[str, Mapping[str, Any]] = field(default_factory=dict)
    truths: Truths = field(default_factory=dict)
    beside: tuple[Point, ...] = ()
    one_option: tuple[Point, ...] = ()
    catalogue: Outcomes = field(default_factory=dict)

    @property
    def missing(self) -> Mapping[Variant, int]:
        """Points of the grid that are not evaluated so far, by variant; variants without any are left out."""
        return Counter(point.variant for point in self.result.points if point.result.status is ResultStatus.MISSING)

    @cached_property
    def findings(self) -> Mapping[Variant, VariantFindings]:
        """What each variant comes to."""
        return {variant: findings(self.result, variant) for variant in self.result.sweep.variants}

    @cached_property
    def errors(self) -> Mapping[Variant, VariantErrors]:
        """How far each variant is from the truth, the smallest error first."""
        return variant_errors(self.result, self.truths, [*self.result.points, *self.beside])

    @cached_property
    def installed(self) -> list[Installed]:
        """Engines as installed beside their tuned presets, the largest error first."""
        return installed(self.errors, self.single_options)

    @cached_property
    def option_curves(self) -> list[OptionCurve]:
        """Errors over one option of an engine, where variants differ in that alone: over the grid, or a few points."""
        wide = option_curves(self.errors, [*self.result.points, *self.beside])
        few = option_curves(self.few_errors, self._few_points)
        shown = {(curve.title, curve.option) for curve in wide}
        return wide + [curve for curve in few if (curve.title, curve.option) not in shown]

    @cached_property
    def few_errors(self) -> Mapping[Variant, VariantErrors]:
        """Errors of the variants that differ in one option from a preset, and of all others at the same points."""
        return variant_errors(self.result, self.truths, self._few_points)

    @cached_property
    def _few_points(self) -> list[Point]:
        places = {(point.case, point.frequency_ratio) for point in self.one_option}
        others = (p for p in (*self.result.points, *self.beside) if (p.case, p.frequency_ratio) in places)
        return [*others, *self.one_option]

    @cached_property
    def single_options(self) -> list[SingleOption]:
        """Defaults with one option of the tuned preset each, the smallest error of an engine and formulation first."""
        return single_options(self.few_errors)

    @cached_property
    def departures(self) -> list[Departures]:
        """What departs of each variant, and what its law leaves of it."""
        own = (departures(self.result, variant) for variant in self.result.sweep.variants)
        return [one for one in own if one is not None]

    @cached_property
    def versions(self) -> list[VersionPair]:
        """How versions of one engine differ."""
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
        return provenance(self.result, self.command, self.findings, self.recorded, self.starts)
