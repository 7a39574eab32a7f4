"""Where a motion in which nothing slips but contacts without friction crosses 0 dB, and where a contact would slip.

Both are roots of polynomials in ω², which are isolated: nothing changes between them. Where contacts slip, no range of
frequencies is proven: the balls of a motion from event to event grow by some 1e8 over a period.
"""

import operator
from collections.abc import Iterable
from dataclasses import dataclass
from fractions import Fraction
from itertools import accumulate, pairwise

from flint import acb, acb_poly, arb, arb_poly, ctx

from reference_lcp.errors import NotProven
from reference_lcp.exact.proof.dynamics import ball
from reference_lcp.exact.proof.exact_chain import ExactChain

PRECISION = 1000
"""Bits: the coefficients of a hundred roots cancel in many digits."""


@dataclass(frozen=True)
class LinearRange:
    """Frequency ratios in which nothing slips but contacts without friction."""

    low: arb
    high: arb
    crossings: list[arb]
    """Where the level may be 0 dB; nowhere else in the range it is."""


def linear_ranges(exact: ExactChain, low: Fraction, high: Fraction) -> list[LinearRange]:
    """Give the ranges between two frequency ratios in which nothing slips; the chain's own frequency does not count.

    If every cell has a chain dashpot, all steady states there are these motions, see docs/theory/proof.md. Raises
    `NotProven` where roots are not told apart, and of normal forces that change.
    """
    if exact.modulation is not None:
        raise NotProven("contacts whose normal forces change are not told to stick in a range of frequencies")
    with ctx.workprec(PRECISION):
        unit = ball(exact.inner_stiffness[0] / exact.inner_mass[0])
        moved, over = _amplitudes(exact)
        forces = [
            arb_poly([0, 0, 0, 0, ball(mass) ** 2]) * _size(amplitude) - _size(over) * ball(bound) ** 2
            for mass, bound, amplitude in zip(exact.inner_mass, exact.friction, moved, strict=True)
            if bound
        ]
        excess = [_in_square(force, 0) for force in forces]
        ends = [ball(low), *_within(excess, unit, low, high), ball(high)]
        crossings = _within([_in_square(_size(moved[-1]) - _size(over), 2)], unit, low, high)
        return [
            LinearRange(first, last, [place for place in crossings if not (place < first or place > last)])
            for first, last in pairwise(ends)
            if all(force(((first + last) / 2) ** 2 * unit) < 0 for force in excess)
        ]


def _amplitudes(exact: ExactChain) -> tuple[list[acb_poly], acb_poly]:
    """Numerators of the outer masses' complex amplitudes over the drive's, and their common denominator.

    With κ the spring before a cell and p / q the dynamic stiffness of the cell and all behind it, an amplitude is
    κ q / (κ q + p) of the one before; q is a factor of the cell times the denominator of the cell behind.
    """
    p, q = acb_poly([0]), acb_poly([1])
    factors, denominators = [], [q]
    for cell in reversed(range(exact.cells)):
        spring = _spring(exact.chain_stiffness[cell], exact.chain_damping_squared[cell])
        inner = _spring(exact.inner_stiffness[cell], exact.inner_damping_squared[cell])
        outer_mass, inner_mass = (acb_poly([0, 0, -ball(mass[cell])]) for mass in (exact.outer_mass, exact.inner_mass))
        own, over = outer_mass + inner_mass, acb_poly([1])
        if not exact.friction[cell]:
            over = inner + inner_mass
            own = outer_mass * over + inner_mass * inner
        p, q = own * q + over * p, over * q
        load = spring if cell or exact.moving_base else acb_poly([spring[0]])
        factors.append(load * over)
        p, q = spring * p, spring * q + p
        denominators.append(q)
    products = accumulate(reversed(factors), operator.mul)
    behind = reversed(denominators[:-1])
    return [product * rest for product, rest in zip(products, behind, strict=True)], q


def _spring(stiffness: Fraction, damping_squared: Fraction) -> acb_poly:
    """Give k + iωc, in powers of ω."""
    return acb_poly([ball(stiffness), acb(0, ball(damping_squared).sqrt())])


def _size(polynomial: acb_poly) -> arb_poly:
    """Give the absolute square where ω is real, in powers of ω."""
    coefficients: list[acb] = list(polynomial)
    real, imaginary = (arb_poly([getattr(own, part) for own in coefficients]) for part in ("real", "imag"))
    return real * real + imaginary * imaginary


def _in_square(even: arb_poly, first: int) -> arb_poly:
    """Give an even polynomial in powers of its argument's square, without those that vanish before the `first`."""
    return arb_poly([even[k] for k in range(first, even.degree() + 1, 2)])


def _within(polynomials: Iterable[arb_poly], unit: arb, low: Fraction, high: Fraction) -> list[arb]:
    """Enclose all places between two frequency ratios at which one of the polynomials in ω² may vanish, ascending."""
    places = []
    for polynomial in polynomials:
        try:
            roots = acb_poly(polynomial).roots(tol=arb(10) ** -30)
        except ValueError as problem:
            raise NotProven("crossings of the level are not told apart") from problem
        real = [root.real for root in roots if root.imag.contains(0)]
        ratios = [(square / unit).sqrt() for square in real if square > 0]
        places += [ratio for ratio in ratios if ratio > ball(low) and ratio < ball(high)]
    return sorted(places, key=lambda place: float(place.mid()))
