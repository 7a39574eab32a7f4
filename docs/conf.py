"""Configuration of the documentation: `python -m sphinx -W -j auto -b html docs docs/_build`."""

import re
from html import escape
from importlib.metadata import version as version_of

import ziamath
from docutils.nodes import SkipNode

project = "multibody-xval"
author = "the authors of multibody-xval"
project_copyright = author
version = release = version_of("multibody-xval")

extensions = ["myst_parser", "sphinx_copybutton"]
exclude_patterns = ["_build"]
html_theme = "furo"
html_title = "multibody-xval"
html_static_path = ["_static"]
html_css_files = ["page.css"]
html_math_renderer = "svg"

myst_enable_extensions = ["amsmath", "dollarmath"]
myst_heading_anchors = 3
suppress_warnings = ["myst.header"]

MATH_SIZE = 17
"""Pixels: as high as the text beside it."""


def drawn(source, inline):
    """Draw an equation as SVG, which browsers show without a script or a network."""
    equation = ziamath.Latex(source, size=MATH_SIZE, inline=inline)
    drop = equation.getyofst()
    svg = equation.svg().replace("<svg ", f'<svg role="img" style="vertical-align:{drop:.2f}px" ', 1)
    # a title is what a screen reader reads; names of glyphs are equal in all equations, and so are the glyphs
    return re.sub(r"(<svg [^>]*>)", lambda tag: f"{tag[1]}<title>{escape(source)}</title>", svg, count=1)


def visit_inline_math(writer, node):
    """Write an equation within a line."""
    writer.body.append(f'<span class="math">{drawn(node.astext(), inline=True)}</span>')
    raise SkipNode


def visit_display_math(writer, node):
    """Write an equation of its own."""
    writer.body.append(f'<div class="math">{drawn(node.astext(), inline=False)}</div>')
    raise SkipNode


def name_files_of_the_source(_app, _page, text):
    """Name Markdown files outside this folder, to which GitHub can link and the built pages cannot."""
    text[0] = re.sub(
        r"\[([^\]]+)\]\(((?:\.\./)+(?:CONTRIBUTING|CHANGELOG|scenarios/truth/README)\.md)\)", r"\1 (`\2`)", text[0]
    )


def setup(app):
    """Connect what is above; pages are read and written side by side with ``-j auto``."""
    app.connect("source-read", name_files_of_the_source)
    app.add_html_math_renderer("svg", (visit_inline_math, None), (visit_display_math, None))
    return {"parallel_read_safe": True, "parallel_write_safe": True}
