"""The chain as a drawing: outer masses in a row, an inner mass in each, with a spring and dry friction between them."""

from markupsafe import Markup

WIDTH, HEIGHT, SPRING = 78.0, 64.0, 26.0
"""Size of an outer mass, and length of the spring before it, in units of the drawing."""

TOP = 34.0
"""Upper end of the outer masses; labels stand above."""

BASE = 40.0
"""Where the base ends and the first spring begins."""

MOST_DRAWN = 7
"""Cells that are drawn; of a longer chain the last one stands behind a gap."""


def chain_drawing(cells: int, drive: str) -> Markup:
    """Give the drawing of a chain as SVG, in the colour of the text around it."""
    shown = min(cells, MOST_DRAWN)
    middle = TOP + HEIGHT / 2
    parts = [_base(drive)]
    for number in range(shown):
        left = BASE + SPRING + (WIDTH + SPRING) * number
        gap = cells > shown and number == shown - 1
        parts += [_gap(left - SPRING, middle) if gap else _spring(left - SPRING, left, middle), _cell(left)]
    last = BASE + SPRING + (WIDTH + SPRING) * (shown - 1)
    if drive == "force":
        parts.append(_arrow(BASE + SPRING + WIDTH / 2, 16.0, "P₀ sin ωt"))
    parts += [_arrow(last + WIDTH / 2, 16.0, f"U{_low(cells)}, measured"), _legend(TOP + HEIGHT + 22)]
    width = last + WIDTH + 52
    return Markup(
        f'<svg class="chain" viewBox="0 0 {width:g} {TOP + HEIGHT + 34:g}" role="img" '
        f'aria-label="A chain of {cells} cells on a base; each cell is an outer mass that holds an inner mass, '
        f'with a spring and dry friction between them">{"".join(parts)}</svg>'
    )


def _base(drive: str) -> str:
    """Draw the base: it moves, or it stands."""
    lines = "".join(f'<path d="M{BASE - 8:g} {y:g}l-9 9"/>' for y in range(int(TOP), int(TOP + HEIGHT), 9))
    moving = _arrow(BASE - 8, 16.0, "U₀ sin ωt") if drive == "base" else ""
    return f'<path d="M{BASE - 8:g} {TOP:g}v{HEIGHT:g}M{BASE - 8:g} {TOP + HEIGHT / 2:g}h8"/>{lines}{moving}'


def _cell(left: float) -> str:
    """Draw an outer mass with an inner one, held by a spring at its left and rubbing on its floor."""
    inner, size, floor = left + 32, 26.0, TOP + HEIGHT - 8
    return (
        f'<rect x="{left:g}" y="{TOP:g}" width="{WIDTH:g}" height="{HEIGHT:g}" rx="4" class="outer"/>'
        f"{_spring(left, inner, floor - size / 2)}"
        f'<rect x="{inner:g}" y="{floor - size:g}" width="{size:g}" height="{size:g}" rx="3" class="inner"/>'
        f'<path d="M{left + 8:g} {floor:g}h{WIDTH - 16:g}" class="rub"/>'
    )


def _spring(start: float, end: float, y: float) -> str:
    """Draw a spring as a zigzag."""
    turns = 6
    step = (end - start - 8) / turns
    zigzag = "".join(f"L{start + 4 + step * (k + 0.5):.1f} {y + (5 if k % 2 else -5):g}" for k in range(turns))
    return f'<path d="M{start:g} {y:g}h4{zigzag}L{end - 4:.1f} {y:g}h4"/>'


def _gap(start: float, y: float) -> str:
    return f'<path d="M{start:g} {y:g}h{SPRING:g}" stroke-dasharray="2 5"/>'


def _arrow(x: float, y: float, text: str) -> str:
    """Draw an arrow to and fro, with what moves like this beside it."""
    return (
        f'<path d="M{x - 12:g} {y + 8:g}h24m-5 -4l5 4l-5 4m-14 -8l-5 4l5 4"/>'
        f'<text x="{x:g}" y="{y - 4:g}" text-anchor="{"start" if x < BASE else "middle"}">{text}</text>'
    )


def _legend(y: float) -> str:
    left = BASE + SPRING
    text = "dry friction: it sticks, or slips at a constant force"
    return f'<path d="M{left:g} {y - 4:g}h22" class="rub"/><text x="{left + 28:g}" y="{y:g}">{text}</text>'


def _low(number: int) -> str:
    """Give a number as an index."""
    return "".join("₀₁₂₃₄₅₆₇₈₉"[int(digit)] for digit in str(number))
