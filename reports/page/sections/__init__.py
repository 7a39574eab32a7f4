"""Sections of reports, one class and one template each."""

from reports.page.sections.errors import ErrorMaps, OptionCurves, WorkPrecision
from reports.page.sections.motion import BandEdges, FrictionMapSection, StickSlip, Transmittance
from reports.page.sections.summary import Provenance, Summary
from reports.page.sections.verdicts import Catalogue, DeparturesSection, OpenPoints, Verdicts, Versions

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
