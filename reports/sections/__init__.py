"""Sections of reports: one module, one class and one template each."""

from reports.sections.band_edges import BandEdges
from reports.sections.friction_map import FrictionMap
from reports.sections.open_points import OpenPoints
from reports.sections.provenance import Provenance
from reports.sections.stick_slip import StickSlip
from reports.sections.summary import Summary
from reports.sections.transmittance import Transmittance
from reports.sections.work_precision import WorkPrecision

__all__ = [
    "BandEdges",
    "FrictionMap",
    "OpenPoints",
    "Provenance",
    "StickSlip",
    "Summary",
    "Transmittance",
    "WorkPrecision",
]
