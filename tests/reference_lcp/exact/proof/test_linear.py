"""Crossings of 0 dB without slip: all of them are found, and a contact slips where it is said to."""

from fractions import Fraction

import numpy as np
import pytest

from reference_lcp import (
    Chain,
    ExactChain,
    HarmonicBase,
    NotProven,
    frictionless_transmittance,
    prove,
    stuck_transmittance,
)

pytest.importorskip("flint", reason="python-flint is not installed")

from reference_lcp.exact.proof.linear import linear_ranges

GRID = np.linspace(0.1, 3.0, 5001)
"""Finer than any two crossings are apart."""


def ranges(friction_ratio="0", **ratios):
    exact = ExactChain.from_ratios(friction_ratio=friction_ratio, frequency_ratio="1", **ratios)
    return linear_ranges(exact, Fraction(1, 10), Fraction(3))


def sign_changes(transmittance) -> list[tuple[float, float]]:
    chain = Chain.from_ratios()
    above = np.array([transmittance(chain, HarmonicBase.from_ratio(chain, eta)) > 1 for eta in GRID.tolist()])
    return [(GRID[k], GRID[k + 1]) for k in np.flatnonzero(above[1:] != above[:-1]).tolist()]


def unmatched(places, changes) -> list[tuple[float, float]]:
    return [(low, high) for low, high in changes if not any(low <= place <= high for place in places)]


@pytest.mark.parametrize(
    ("friction_ratio", "transmittance", "crossings"),
    [("0", frictionless_transmittance, 21), ("1000000", stuck_transmittance, 9)],
)
def test_all_crossings_without_slip_are_found(friction_ratio, transmittance, crossings) -> None:
    (whole,) = ranges(friction_ratio)
    places, changes = [float(place) for place in whole.crossings], sign_changes(transmittance)
    assert len(changes) == len(places) == crossings
    assert unmatched(places, changes) == []
    assert unmatched(places[1:], changes) == changes[:1], "a crossing that is left out is noticed"


@pytest.mark.parametrize(("friction_ratio", "place"), [("1", 2), ("5", 3), ("0.3", 1)])
def test_contacts_slip_at_the_ends_of_a_range_and_not_within(friction_ratio, place) -> None:
    one = ranges(friction_ratio)[place]
    for end, outwards in ((one.low, -1), (one.high, 1)):
        if 0.11 < end < 2.9:
            within, beyond = (
                ExactChain.from_ratios(friction_ratio=friction_ratio, frequency_ratio=f"{float(end) + step:.12f}")
                for step in (-outwards * 1e-6, outwards * 1e-6)
            )
            assert prove(within).transitions == []
            assert len(prove(beyond).transitions) > 0


def test_level_is_zero_at_a_crossing() -> None:
    """An edge of the band at the friction ratio 5, where all cells stick."""
    edge = ranges("5")[-1].crossings
    assert len(edge) == 1
    proof = prove(ExactChain.from_ratios(friction_ratio="5", frequency_ratio=edge[0].str(25, radius=False)))
    assert abs(proof.transmittance_db.value) < 1e-20


def test_changing_normal_forces_are_refused() -> None:
    with pytest.raises(NotProven, match="normal forces change"):
        ranges("1", modulation="0.5")
