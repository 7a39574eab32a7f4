"""How things are drawn, on the page and in print: colours, shapes, lines and sizes, the same everywhere."""

from dataclasses import dataclass

from engines.interface.variant import Variant
from scenarios.sweeps.sweep import Sweep
from scenarios.verdicts.steady_case import CONVERGED, REFERENCE

PALETTE = ("#0072B2", "#D55E00", "#009E73", "#CC79A7", "#E69F00", "#56B4E9")
"""Okabe and Ito's palette, which colour-blind readers can distinguish."""

SOLID: tuple[float, ...] = ()
DASHED = (5.0, 4.0)
DOTTED = (2.0, 2.0)

_SHAPES = (
    ("circle", 6.0), ("square", 4.8), ("triangle-up", 4.6), ("diamond", 3.4), ("triangle-down", 4.4), ("cross", 4.2),
    ("x", 4.0), ("star", 5.4),
)  # fmt: skip
_DASHES = ((5.0, 1.5), (1.0, 1.0), (4.0, 1.0, 1.0, 1.0), (8.0, 2.0), (4.0, 1.0, 1.0, 1.0, 1.0, 1.0))


@dataclass(frozen=True)
class Style:
    """How a series is drawn; those of variants differ in colour, shape and line, so that any one of them is enough."""

    colour: str
    symbol: str = "dot"
    """Shape of the points, by plotly's name: hollow, but for ``dot``."""
    size: float = 1.0
    """Of the shape in print [pt]."""
    dash: tuple[float, ...] = SOLID
    """Lengths of dashes and of the gaps between them, over the width of the line; `SOLID` if empty."""
    width: float = 1.1
    """Of the line in print [pt]."""


RULE = Style("#666666", width=0.6)
"""A thin grey line, such as that of a threshold."""


def compared_variants(sweep: Sweep) -> list[Variant]:
    """Variants of engines other than the reference, in their order."""
    return [variant for variant in sweep.variants if variant.engine != REFERENCE.engine]


def style_of(sweep: Sweep, variant: Variant) -> Style:
    """Give a variant its style, the same in every figure; the reference is black and solid."""
    if variant.engine == REFERENCE.engine:
        return Style("#000000", "cross-thin" if variant == CONVERGED else "x-thin", 4.5)
    number = compared_variants(sweep).index(variant)
    # one shape further each time that the colours are used up: 48 variants in a row differ
    symbol, size = _SHAPES[(number + number // len(PALETTE)) % len(_SHAPES)]
    return Style(PALETTE[number % len(PALETTE)], symbol, size, _DASHES[number % len(_DASHES)])


def curve_style(number: int) -> Style:
    """Give the style of the curve with this number among the cases, from 0."""
    if number == 0:
        return Style("#000000")
    return Style(PALETTE[(number - 1) % len(PALETTE)], dash=_DASHES[(number - 1) % len(_DASHES)])
