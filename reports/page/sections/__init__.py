"""Sections of reports, one class and one template each."""

from multibody_xval.reports.page.sections.claims import Claims
from multibody_xval.reports.page.sections.errors import ErrorMaps, WorkPrecision
from multibody_xval.reports.page.sections.motion import BandEdges, FrictionMapSection, StickSlip, Transmittance
from multibody_xval.reports.page.sections.scenes import Scenes
from multibody_xval.reports.page.sections.summary import Provenance, Summary
from multibody_xval.reports.page.sections.verdicts import Catalogue, DeviationsSection, OpenPoints, Verdicts

FIRST_SECTIONS = (
    Summary, Claims, Transmittance, Scenes, ErrorMaps, FrictionMapSection, BandEdges, StickSlip, Catalogue,
    WorkPrecision, Verdicts, DeviationsSection, OpenPoints,
)  # fmt: skip
LAST_SECTIONS = (Provenance,)
"""Sections of every report, in order; those of other packages stand between."""
