"""The page: a list of sections, each one class and one template, in one document that needs nothing else."""

import re
import sys
from collections.abc import Sequence
from dataclasses import dataclass

from markupsafe import Markup

from multibody_xval.reports.data.report import Report
from multibody_xval.reports.figures.drawing import Drawing
from multibody_xval.reports.figures.stick_slip import MODE_COLOURS
from multibody_xval.reports.figures.style import BLANK, INK, LINE, PAGE_WIDTH, PALETTE, PAPER, SOFT
from multibody_xval.reports.formatting import environment
from multibody_xval.reports.page.section import SUITE_TEMPLATES, Section, registered_sections
from multibody_xval.reports.page.sections import FIRST_SECTIONS, LAST_SECTIONS

FIGURES = "figures"
"""Folder of the figures, beside the page."""

TABLES = (
    "errors.csv", "headline.csv", "transmittance.csv", "band_edges.csv", "transitions.csv", "work_precision.csv",
    "catalogue.csv", "report.json", "report.nc",
)  # fmt: skip
"""Files of numbers beside the page."""

LARGEST_PAGE = 5 * 2**20
"""Bytes that a page takes at most, so that it can be sent by mail and opens at once."""

OF_THE_PAGE = {
    colour.lower(): f"var(--{name})"
    for name, colour in {
        "ink": INK, "soft": SOFT, "line": LINE, "paper": PAPER, "blank": BLANK, "blue": PALETTE[0],
        "dark": next(iter(MODE_COLOURS.values())),
    }.items()
}  # fmt: skip
"""Colours of figures that are others on a dark page, by its style sheet."""


@dataclass(frozen=True)
class RenderedPage:
    """What is written."""

    html: str
    figures: dict[str, bytes]
    """Every figure as SVG and PDF, by file name."""


def sections(report: Report) -> list[Section]:
    """Give the sections of a report that have anything to show, in order."""
    every = [make(report) for make in (*FIRST_SECTIONS, *registered_sections(), *LAST_SECTIONS)]
    return [section for section in every if section.shown]


def page(title: str, parts: Sequence[Section]) -> RenderedPage:
    """Render sections into one HTML document.

    A section that fails says so in its place; the others are there.
    """
    files: dict[str, bytes] = {}
    rendered = [_rendered(part, files) for part in parts]
    template = environment(SUITE_TEMPLATES).get_template("page.html")
    return RenderedPage(template.render(title=title, sections=rendered, tables=TABLES), files)


def _rendered(part: Section, files: dict[str, bytes]) -> dict[str, str]:
    """Give a section as the page takes it; one of another package may fail."""
    try:
        html = _content(part, files)
    except Exception as problem:
        if part.templates == SUITE_TEMPLATES:
            raise
        print(f"section {part.title!r} failed: {type(problem).__name__}: {problem}", file=sys.stderr)
        html = Markup("<p class='blocked'>This section failed: {}: {}</p>").format(type(problem).__name__, problem)
    return {"title": part.title, "anchor": part.template, "html": Markup(html)}


def _content(part: Section, files: dict[str, bytes]) -> str:
    drawn = {drawing.name: _placed(drawing, part.numbers, files) for drawing in part.figures()}
    template = environment(part.templates, SUITE_TEMPLATES).get_template(f"{part.template}.html")
    return template.render(**part.context(), figure=drawn.__getitem__, figures=list(drawn.values()))


def _placed(drawing: Drawing, numbers: str, files: dict[str, bytes]) -> Markup:
    """Keep the files of a figure, and give its element, which links them and the file of its `numbers`."""
    own = {f"{drawing.name}.{ending}": drawing.file(ending) for ending in ("svg", "pdf")}
    if own.keys() & files:
        raise ValueError(f"two figures are called {drawing.name!r}; allowed: names of their own")
    files |= own
    return Markup(
        environment(SUITE_TEMPLATES).get_template("figure.html").render(
            drawing=drawing,
            wide=drawing.canvas.get_figwidth() >= PAGE_WIDTH,
            svg=_inline(files[f"{drawing.name}.svg"].decode(), drawing.caption),
            files=[*(f"{FIGURES}/{name}" for name in own), *([numbers] if numbers else [])],
        )
    )  # fmt: skip


def _inline(svg: str, caption: str) -> Markup:
    """Give a drawing as a part of the page, in whose colours it is drawn and whose width it takes."""
    drawing = svg[svg.index("<svg") :].split(">", 1)
    opening = re.sub(r' (xmlns(:\w+)?|width|height|version)="[^"]*"', "", drawing[0])
    body = drawing[1].replace("*{stroke-linejoin: round; stroke-linecap: butt}", "", 1)
    body = re.sub(r"#[0-9a-f]{6}\b", lambda colour: OF_THE_PAGE.get(colour[0], colour[0]), body)
    return Markup('{} role="img" aria-label="{}">{}').format(Markup(opening), caption, Markup(body))
