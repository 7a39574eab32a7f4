"""Everything that sections of a report are made from."""

from collections import Counter
from collections.abc import Mapping
from dataclasses import dataclass, field

from engines.interface.variant import Variant
from scenarios.studies.figure3 import Figure3Result
from scenarios.studies.friction_map import FrictionMap
from scenarios.studies.work_precision import StepPoint
from scenarios.tasks.recorded import RecordedPeriod
from scenarios.tasks.result import ResultStatus

OperatingPoint = tuple[float, float]
"""Friction ratio and frequency ratio."""


@dataclass(frozen=True)
class Report:
    """Results, as they were gathered.

    Parameters
    ----------
    result
        Figure 3 by every variant.
    command
        The command line that asks for the same numbers.
    motions
        One period of the reference and of every variant, by place; unknown ones say why.
    steps
        Error and cost at several step sizes; empty if nobody was asked.
    friction_map
        Transmittance over friction and frequency; ``None`` if nobody was asked.
    """

    result: Figure3Result
    command: str
    motions: Mapping[OperatingPoint, Mapping[Variant, RecordedPeriod]] = field(default_factory=dict)
    steps: tuple[StepPoint, ...] = ()
    friction_map: FrictionMap | None = None

    @property
    def missing(self) -> Mapping[Variant, int]:
        """Points of the grid that nobody has answered so far, by variant; variants without any are left out."""
        return Counter(point.variant for point in self.result.points if point.answer.status is ResultStatus.MISSING)
