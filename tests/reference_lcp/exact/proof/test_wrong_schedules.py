"""Proofs refuse wrong orders of events, need each inequality of Coulomb's law, and repair the order near grazings."""

import dataclasses

import pytest

pytest.importorskip("flint", reason="python-flint is not installed")

from flint import arb, ctx

from reference_lcp import NotProven
from reference_lcp.exact.proof import coulomb
from reference_lcp.exact.proof.attempt import proven_or_repaired
from reference_lcp.exact.proof.coulomb import signs
from reference_lcp.exact.proof.dynamics import Dynamics
from tests.reference_lcp.exact.proof.schedules import (
    BITS,
    POINTS,
    WRONG,
    point,
    refused,
    swapped,
    unrepaired,
    wrong_orders,
)


@pytest.mark.parametrize(("friction", "frequency"), POINTS)
def test_right_order_of_events_is_proven_without_repair(friction, frequency) -> None:
    assert unrepaired(*point(friction, frequency)).radius < 1e-28


@pytest.mark.slow
@pytest.mark.parametrize("kind", WRONG)
def test_wrong_order_of_events_is_refused(kind) -> None:
    wrong = wrong_orders(kind)
    assert len(wrong) >= 2
    assert all(refused(*case) for case in wrong)


def left_out(slips):
    return lambda tests: (test for test in tests if test.slips != slips)


def turned(slips):
    return lambda tests: (
        dataclasses.replace(test, row=[-value for value in test.row]) if test.slips == slips else test for test in tests
    )


def undivided(tests):
    """Without the exact zeros at events."""
    return (dataclasses.replace(test, orders=(0, 0)) for test in tests)


def spoil(monkeypatch, change) -> None:
    """Change the inequalities of all stretches."""
    complete = coulomb._tests
    monkeypatch.setattr(coulomb, "_tests", lambda *given: change(complete(*given)))


@pytest.mark.parametrize(
    ("slips", "kind"),
    [(True, "a stick left out, or a reversal instead of it"), (False, "a slipping cell declared stuck")],
    ids=["slips", "sticks"],
)
def test_an_inequality_that_is_left_out_lets_wrong_orders_pass(slips, kind, monkeypatch) -> None:
    spoil(monkeypatch, left_out(slips))
    assert not all(refused(*case) for case in wrong_orders(kind))


@pytest.mark.parametrize(
    "change", [turned(slips=True), turned(slips=False), undivided], ids=["slips", "sticks", "zeros"]
)
def test_an_inequality_with_the_wrong_sign_or_with_its_zeros_refuses_right_orders(change, monkeypatch) -> None:
    spoil(monkeypatch, change)
    assert refused(*point("0.3", "0.6"))


@pytest.mark.parametrize(
    ("changed", "message"),
    [
        (lambda found: {"times": (found.times[0], *found.times[:1], *found.times[2:])}, "at one instant"),
        (lambda found: {"times": (*found.times[1::-1], *found.times[2:])}, "in the wrong order"),
        (lambda found: {"first": tuple(-mode if mode else 1 for mode in found.first)}, "modes at the end"),
    ],
    ids=["one instant", "order", "modes"],
)
def test_events_have_to_follow_each_other_and_to_repeat(changed, message) -> None:
    exact, guess = point("1", "0.95")
    solution = unrepaired(exact, guess)
    other = dataclasses.replace(solution.candidate, **changed(solution.candidate))
    with ctx.workprec(BITS):
        dynamics = Dynamics(exact)
    with pytest.raises(NotProven, match=message):
        coulomb.check_order(dynamics, dataclasses.replace(solution, candidate=other))


THIRD = arb(1) / 3


@pytest.mark.parametrize(
    ("polynomial", "positive"),
    [
        ([THIRD**2 + arb("1e-9"), -2 * THIRD, arb(1)], True),  # (s − 1/3)², lifted: its ends are positive anyhow
        ([THIRD**2 - arb("1e-9"), -2 * THIRD, arb(1)], False),
        ([THIRD**2, -2 * THIRD, arb(1)], False),
        ([arb(1), *[arb(0)] * 40], True),
        ([arb(1), *[arb(0)] * 40, arb(0, 1.1)], False),  # the remainder counts
    ],
)
def test_sign_of_a_polynomial_is_decided_down_to_its_vertex_and_its_remainder(polynomial, positive) -> None:
    assert (signs([polynomial])[0] is True) is positive


GRAZINGS = [
    pytest.param("0.3", "0.52860355", "0.52860375", id="a short slip in a stick"),
    pytest.param("0.3", "1.15541667", "1.15541687", id="a short stick in a slip"),
    pytest.param("0.1", "0.40156307", "0.40156328", id="a short stick where it turns round"),
    pytest.param("0.1", "0.60029678", "0.60029699", id="a short slip before a stick"),
]
"""Frequency ratios on both sides, 2e-7 apart: a defect was that grazings had the events of the other side."""


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
    exact, guess = point("1", "0.95")
    wrong = swapped(guess)[0]
    assert refused(exact, wrong)
    assert repaired(exact, wrong)[0].events == guess.events
