"""Near grazings the order of events of one side is proven wrong on the other one, and is repaired."""

import pytest

pytest.importorskip("flint", reason="python-flint is not installed")

from flint import ctx

from reference_lcp.exact.proof.attempt import proven_or_repaired
from reference_lcp.exact.proof.dynamics import Dynamics
from tests.reference_lcp.exact.proof.schedules import BITS, point, refused, swapped

GRAZINGS = [
    pytest.param("0.3", "0.52860355", "0.52860375", id="a short slip in a stick"),
    pytest.param("0.3", "1.15541667", "1.15541687", id="a short stick in a slip"),
    pytest.param("0.1", "0.40156307", "0.40156328", id="a short stick where it turns round"),
    pytest.param("0.1", "0.60029678", "0.60029699", id="a short slip before a stick"),
]
"""Frequency ratios on both sides, 2e-7 apart."""


def repaired(exact, guess):
    with ctx.workprec(BITS):
        solution, _, repairs = proven_or_repaired(Dynamics(exact), guess)
    return solution.candidate, repairs


@pytest.mark.slow
@pytest.mark.parametrize(("friction", "before", "after"), GRAZINGS)
def test_events_of_one_side_of_a_grazing_become_those_of_the_other(friction, before, after) -> None:
    found = [point(friction, frequency) for frequency in (before, after)]
    sides = [(exact, repaired(exact, guess)[0]) for exact, guess in found]
    assert len(sides[0][1].events) != len(sides[1][1].events)
    for (exact, right), (_, other) in (sides, sides[::-1]):
        proven, repairs = repaired(exact, other)
        assert repairs >= 1
        assert len(proven.events) == len(right.events)


def test_swapped_events_are_put_in_order() -> None:
    exact, guess = point("0.3", "0.6")
    wrong = swapped(guess)[0]
    assert refused(exact, wrong)
    assert repaired(exact, wrong)[0].events == guess.events
