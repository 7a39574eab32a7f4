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

extensions = [
    "myst_parser",
    "sphinx.ext.autodoc",
    "sphinx.ext.autosummary",
    "numpydoc",
    "sphinx.ext.viewcode",
    "sphinx_copybutton",
]
exclude_patterns = ["_build"]
html_theme = "furo"
html_title = "multibody-xval"
html_static_path = ["_static"]
html_css_files = ["page.css"]
html_math_renderer = "svg"

myst_enable_extensions = ["amsmath", "colon_fence", "dollarmath"]
myst_heading_anchors = 3

python_maximum_signature_line_length = 100
autodoc_member_order = "bysource"
autodoc_typehints = "signature"
default_role = "py:obj"
numpydoc_show_class_members = False
suppress_warnings = ["myst.header"]

MATH_SIZE = 17
"""Pixels: as high as the text beside it."""

_LITERAL = re.compile(r"(``.+?``|`.+?`)")
_FLOAT_ARRAY = "numpy.ndarray[tuple[~typing.Any, ...], ~numpy.dtype[~numpy.float64]]"
_ARRAY_LIKE = re.compile(r"~?\S*_Buffer \|.*?_NestedSequence\[(?:~?[\w.]+ \| )*~?[\w.]+\]")


def bars_are_absolute_values(_app, _what, _name, _object, _options, lines):
    """Escape |x| in docstrings, which reStructuredText would take for a substitution."""
    for index, line in enumerate(lines):
        parts = _LITERAL.split(line)
        lines[index] = "".join(part if part.startswith("`") else part.replace("|", r"\|") for part in parts)


def short_types(_app, _what, _name, _object, _options, signature, returned):
    """Give types of arrays the names that the code gives them."""

    def shortened(text):
        if text is None:
            return None
        text = text.replace("~" + _FLOAT_ARRAY, "FloatArray").replace(_FLOAT_ARRAY, "FloatArray")
        return _ARRAY_LIKE.sub("ArrayLike", text)

    return shortened(signature), shortened(returned)


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


def no_tree_beside_sources(_app, page, _template, context, _doctree):
    """Show no tree of pages beside a source file: it is made anew for every page, which takes a sixth of a second."""
    if page.startswith("_modules/"):
        context.pop("toctree", None)


def name_files_of_the_source(_app, _page, text):
    """Name Markdown files outside this folder, to which GitHub can link and the built pages cannot."""
    text[0] = re.sub(
        r"\[([^\]]+)\]\(((?:\.\./)+(?:CONTRIBUTING|CHANGELOG|scenarios/truth/README)\.md)\)", r"\1 (`\2`)", text[0]
    )


def setup(app):
    """Connect what is above; pages are read and written side by side with ``-j auto``."""
    app.connect("source-read", name_files_of_the_source)
    app.add_html_math_renderer("svg", (visit_inline_math, None), (visit_display_math, None))
    app.connect("html-page-context", no_tree_beside_sources, priority=400)
    app.connect("autodoc-process-docstring", bars_are_absolute_values, priority=900)
    app.connect("autodoc-process-signature", short_types)
    return {"parallel_read_safe": True, "parallel_write_safe": True}
