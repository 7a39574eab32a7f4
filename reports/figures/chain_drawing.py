"""The chain as a drawing: outer masses in a row, an inner mass in each, with a spring and dry friction between them."""

from markupsafe import Markup

from multibody_xval.reports.formatting import environment

SIZES = {"width": 78.0, "height": 64.0, "gap": 26.0, "top": 34.0, "base": 40.0}
"""Size of an outer mass and length of the spring before it; upper end of the masses; where the first spring begins."""

MOST_DRAWN = 7
"""Cells that are drawn; of a longer chain the last one stands behind a gap."""


def chain_drawing(cells: int, drive: str) -> Markup:
    """Give the drawing of a chain as SVG, in the colour of the text around it."""
    templates = environment("multibody_xval.reports.figures")
    templates.filters["g"] = "{:g}".format
    index = str(cells).translate(str.maketrans("0123456789", "₀₁₂₃₄₅₆₇₈₉"))
    drawn = min(cells, MOST_DRAWN)
    svg = templates.get_template("chain.svg").render(cells=cells, drawn=drawn, drive=drive, index=index, **SIZES)
    return Markup("".join(map(str.strip, svg.splitlines())))
