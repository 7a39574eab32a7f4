"""The page: a list of sections, each one class and one template, in one document that needs nothing else."""

import base64
import gzip
import json
import sys
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from markupsafe import Markup
from plotly.offline import get_plotlyjs

from reports.data.report import Report
from reports.drawing.figure import Figure
from reports.drawing.plotly_backend import plot
from reports.drawing.printing import INDEX, DrawnFigures, Printer, index_of
from reports.formatting import environment
from reports.page.section import SUITE_TEMPLATES, Section, registered_sections
from reports.page.sections import FIRST_SECTIONS, LAST_SECTIONS

FIGURES = "figures"
"""Folder of the figures, beside the page."""

TABLES = (
    "errors.csv", "headline.csv", "transmittance.csv", "band_edges.csv", "transitions.csv", "work_precision.csv",
    "catalogue.csv", "report.json", "report.nc",
)  # fmt: skip
"""Files of numbers beside the page."""

LARGEST_PAGE = 5 * 2**20
"""Bytes that a page takes at most, so that it can be sent by mail and opens at once."""


@dataclass(frozen=True)
class RenderedPage:
    """What is written."""

    html: str
    figures: dict[str, bytes]
    """Every figure as SVG and PDF, dense ones as PNG too, and their index, by file name."""


def sections(report: Report) -> list[Section]:
    """Give the sections of a report that have anything to show, in order."""
    every = [make(report) for make in (*FIRST_SECTIONS, *registered_sections(), *LAST_SECTIONS)]
    return [section for section in every if section.shown]


def page(
    title: str, parts: Sequence[Section], drawn: DrawnFigures | None = None, cards: Mapping[str, str] | None = None
) -> RenderedPage:
    """Render sections into one HTML document, and draw those of their figures that are not drawn.

    Its footer links `cards` of engines that lie beside it, files by name of the engine.

    A section that fails says so in its place; the others are there.
    """
    described = [_figures(part) for part in parts]
    expected = [figure for figures in described if not isinstance(figures, Exception) for figure in figures]
    with Printer(expected, drawn) as printer:
        registry = _Registry(printer)
        rendered = [_rendered(part, figures, registry) for part, figures in zip(parts, described, strict=True)]
    html = environment(SUITE_TEMPLATES).get_template("page.html").render(
        title=title,
        sections=rendered,
        plots=_packed(json.dumps(registry.plots, allow_nan=False, separators=(",", ":"))),
        library=_packed(get_plotlyjs() if registry.plots else ""),
        cards=cards or {},
        tables=TABLES,
    )  # fmt: skip
    return RenderedPage(html, registry.files)


class _Registry:
    """Figures that are on the page so far."""

    def __init__(self, printer: Printer) -> None:
        self._printer = printer
        self.plots: dict[str, Any] = {}
        self._printed: list[tuple[Figure, dict[str, bytes]]] = []

    def html(self, figure: Figure, numbers: str = "") -> Markup:
        """Draw a figure, keep its files, and give its element, which links them and the file of its `numbers`."""
        if figure.name in self.plots:
            raise ValueError(f"two figures are called {figure.name!r}; allowed: names of their own")
        self.plots[figure.name] = plot(figure)
        files = self._printer.files(figure)
        self._printed.append((figure, files))
        kind, image = ("png", files["png"]) if "png" in files else ("svg+xml", files["svg"])
        template = environment(SUITE_TEMPLATES).get_template("figure.html")
        downloads = [f"{FIGURES}/{figure.name}.{ending}" for ending in ("svg", "pdf")]
        return Markup(
            template.render(
                figure=figure, kind=kind, image=base64.b64encode(image).decode("ascii"),
                files=[*downloads, *([numbers] if numbers else [])],
            )
        )  # fmt: skip

    @property
    def files(self) -> dict[str, bytes]:
        """Files of all figures, by name, and their index."""
        every = {f"{figure.name}.{ending}": file for figure, files in self._printed for ending, file in files.items()}
        return {**every, INDEX: index_of(self._printed)}


def _figures(part: Section) -> Sequence[Figure] | Exception:
    """Give the figures of a section, or why it has none."""
    try:
        return list(part.figures())
    except Exception as problem:
        return problem


def _rendered(part: Section, figures: Sequence[Figure] | Exception, registry: _Registry) -> dict[str, str]:
    """Give a section as the page takes it; one of another package may fail."""
    try:
        html = _content(part, figures, registry)
    except Exception as problem:
        if part.templates == SUITE_TEMPLATES:
            raise
        print(f"section {part.title!r} failed: {type(problem).__name__}: {problem}", file=sys.stderr)
        html = Markup("<p class='blocked'>This section failed: {}: {}</p>").format(type(problem).__name__, problem)
    return {"title": part.title, "anchor": part.template, "html": Markup(html)}


def _content(part: Section, figures: Sequence[Figure] | Exception, registry: _Registry) -> str:
    if isinstance(figures, Exception):
        raise figures
    drawn = {figure.name: registry.html(figure, part.numbers) for figure in figures}
    template = environment(part.templates, SUITE_TEMPLATES).get_template(f"{part.template}.html")
    return template.render(**part.context(), figure=drawn.__getitem__, figures=list(drawn.values()))


def _packed(text: str) -> str:
    """Compress text, and give it as letters: the browser unpacks it."""
    return base64.b64encode(gzip.compress(text.encode(), 9, mtime=0)).decode("ascii")
