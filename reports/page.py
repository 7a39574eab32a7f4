"""The page: a list of sections, each one class and one template."""

from dataclasses import dataclass
from typing import Any, Protocol

from jinja2 import Environment, PackageLoader, StrictUndefined
from markupsafe import Markup

from reports import numbers
from reports.sections import BandEdges, OpenPoints, Provenance, StickSlip, Summary, Transmittance
from scenarios.figure3 import Figure3Result


class Section(Protocol):
    """One section of a page."""

    @property
    def title(self) -> str:
        """The heading."""

    @property
    def template(self) -> str:
        """Name of the template, without its ending; also the anchor of the section."""

    def context(self) -> dict[str, Any]:
        """What the template is given."""


@dataclass(frozen=True)
class RenderedSection:
    """A section as the page takes it."""

    title: str
    anchor: str
    html: Markup


def sections(result: Figure3Result, stick_slip: list[dict[str, Any]], provenance: dict[str, Any]) -> list[Section]:
    """Give the sections of the report on Figure 3, in order."""
    return [
        Summary(result),
        Transmittance(result),
        BandEdges(result),
        StickSlip(stick_slip),
        OpenPoints(result),
        Provenance(provenance),
    ]


def page(title: str, parts: list[Section]) -> str:
    """Render sections into one HTML document that needs nothing else."""
    environment = _environment()
    rendered = [
        RenderedSection(
            part.title, part.template, Markup(environment.get_template(f"{part.template}.html").render(part.context()))
        )
        for part in parts
    ]
    return environment.get_template("page.html").render(title=title, sections=rendered)


def _environment() -> Environment:
    """Templates that escape what they print and refuse names that are not there."""
    environment = Environment(
        loader=PackageLoader("reports"),
        autoescape=True,
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
    )
    for display in (numbers.fixed, numbers.signed, numbers.scientific, numbers.ratio, numbers.span, numbers.typeset):
        environment.filters[display.__name__] = display
    return environment
