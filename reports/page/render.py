"""The page: a list of sections, each one class and one template, in one document that needs nothing else."""

import base64
import gzip
import json
import sys
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

from jinja2 import ChoiceLoader, Environment, PackageLoader, StrictUndefined
from markupsafe import Markup
from plotly.offline import get_plotlyjs

from reports import formatting as numbers
from reports.data.report import Report
from reports.figures.figure import Picture, inline_png, inline_svg
from reports.page.section import SUITE, Section, registered_sections
from reports.page.sections import (
    BandEdges,
    FrictionMap,
    OpenPoints,
    Provenance,
    StickSlip,
    Summary,
    Transmittance,
    WorkPrecision,
)

LARGEST_PAGE = 5 * 2**20
"""Bytes that a page takes at most, so that it can be sent by mail and opens at once."""

DEFAULT_SECTIONS = (Summary, BandEdges, Transmittance, FrictionMap, StickSlip, WorkPrecision, OpenPoints)
"""Sections of every report, in order; those of other packages follow, and how the numbers were made comes last."""


@dataclass(frozen=True)
class RenderedSection:
    """A section as the page takes it."""

    title: str
    anchor: str
    html: Markup


@dataclass(frozen=True)
class RenderedPage:
    """What is written.

    Parameters
    ----------
    html
        The document.
    figures
        Every picture as SVG and PDF, by file name.
    """

    html: str
    figures: dict[str, bytes]


def sections(report: Report) -> list[Section]:
    """Give the sections of a report that have anything to show, in order."""
    every = [make(report) for make in (*DEFAULT_SECTIONS, *registered_sections(), Provenance)]
    return [section for section in every if section.shown]


def page(title: str, parts: Sequence[Section]) -> RenderedPage:
    """Render sections into one HTML document, and draw their pictures.

    A section that fails says so in its place; the others are there.
    """
    album = _Album()
    rendered = [_rendered(part, album) for part in parts]
    html = _environment(SUITE).get_template("page.html").render(
        title=title,
        sections=rendered,
        plots=_packed(json.dumps(album.plots, allow_nan=False, separators=(",", ":"))),
        library=_packed(get_plotlyjs() if album.plots else ""),
    )  # fmt: skip
    return RenderedPage(html, album.files)


class _Album:
    """Pictures that are on the page so far."""

    def __init__(self) -> None:
        self.plots: dict[str, Any] = {}
        self.files: dict[str, bytes] = {}

    def html(self, picture: Picture) -> Markup:
        """Draw a picture, keep its files, and give its element."""
        if picture.name in self.plots:
            raise ValueError(f"two pictures are called {picture.name!r}; allowed: names of their own")
        drawn = picture.print_files()
        self.plots[picture.name] = picture.plot
        template = _environment(SUITE).get_template("picture.html")
        if "png" in drawn:
            still = inline_png(drawn.pop("png"), picture)
        else:
            still = inline_svg(drawn["svg"], picture.name, picture.caption)
        self.files |= {f"{picture.name}.{ending}": content for ending, content in drawn.items()}
        return Markup(template.render(picture=picture, still=Markup(still)))


def _rendered(part: Section, album: _Album) -> RenderedSection:
    """Render one section."""
    try:
        drawn = {picture.name: album.html(picture) for picture in part.pictures()}
        template = _environment(part.templates).get_template(f"{part.template}.html")
        html = template.render(**part.context(), picture=_chosen(drawn), pictures=list(drawn.values()))
    except Exception as problem:
        if part.templates == SUITE:
            raise
        print(f"section {part.title!r} failed: {type(problem).__name__}: {problem}", file=sys.stderr)
        html = Markup("<p class='blocked'>This section failed: {}: {}</p>").format(type(problem).__name__, problem)
    return RenderedSection(part.title, part.template, Markup(html))


def _chosen(drawn: dict[str, Markup]) -> Callable[[str], Markup]:
    return lambda name: drawn[name]


def _environment(package: str) -> Environment:
    """Templates that escape what they print and refuse names that are not there."""
    environment = Environment(
        loader=ChoiceLoader([PackageLoader(name) for name in dict.fromkeys((package, SUITE))]),
        autoescape=True,
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
    )
    for display in (
        numbers.fixed,
        numbers.signed,
        numbers.scientific,
        numbers.ratio,
        numbers.per_cell,
        numbers.span,
        numbers.typeset,
    ):
        environment.filters[display.__name__] = display
    return environment


def _packed(text: str) -> str:
    """Compress text, and give it as letters: the browser unpacks it."""
    return base64.b64encode(gzip.compress(text.encode(), 9, mtime=0)).decode("ascii")
