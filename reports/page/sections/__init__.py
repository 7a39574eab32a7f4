"""Sections of reports: one module, one class and one template each."""

from reports.page.sections.band_edges import BandEdges
from reports.page.sections.catalogue import Catalogue
from reports.page.sections.departures import DeparturesSection
from reports.page.sections.error_map import ErrorMaps
from reports.page.sections.friction_map import FrictionMapSection
from reports.page.sections.open_points import OpenPoints
from reports.page.sections.option_curves import OptionCurves
from reports.page.sections.provenance import Provenance
from reports.page.sections.stick_slip import StickSlip
from reports.page.sections.summary import Summary
from reports.page.sections.transmittance import Transmittance
from reports.page.sections.verdicts import Verdicts
from reports.page.sections.versions import Versions
from reports.page.sections.work_precision import WorkPrecision

__all__ = [
    "BandEdges",
    "Catalogue",
    "DeparturesSection",
    "ErrorMaps",
    "FrictionMapSection",
    "OpenPoints",
    "OptionCurves",
    "Provenance",
    "StickSlip",
    "Summary",
    "Transmittance",
    "Verdicts",
    "Versions",
    "WorkPrecision",
]
