"""Proofs refuse what is wrong: orders of events, and each inequality of Coulomb's law that is left out is noticed."""

import dataclasses

import pytest

flint = pytest.importorskip("flint", reason="python-flint is not installed")

from flint import arb, ctx  # noqa: E402

from reference_lcp import NotProven  # noqa: E402
from reference_lcp.exact.proof import coulomb  # noqa: E402
from reference_lcp.exact.proof.coulomb import positive_bounds  # noqa: E402
from reference_lcp.exact.proof.dynamics import Dynamics  # noqa: E402
from tests.reference_lcp.exact.proof.schedules import BITS, POINTS, WRONG, point, refused, unrepaired, wrong_orders  # noqa: E402


@pytest.mark.parametrize(("friction", "frequency"), POINTS)
def test_right_order_of_events_is_proven_without_repair(friction, frequency) -> None:
    solution, observed = unrepaired(*point(friction, frequency))
    assert solution.radius < 1e-28
    assert observed.margin > 0


LONG = "a stuck cell declared slipping"


@pytest.mark.slow
@pytest.mark.parametrize(
    "kind", [pytest.param(kind, marks=[pytest.mark.slow] if kind == LONG else []) for kind in WRONG]
)
def test_wrong_order_of_events_is_refused(kind) -> None:
    wrong = wrong_orders(kind)
    assert len(wrong) >= 2
    assert all(refused(*case) for case in wrong)


def without(left_out):
    """The inequalities but for some."""
    complete = coulomb._tests
    return lambda *arguments: (test for test in complete(*arguments) if not left_out(test))


@pytest.mark.parametrize(
    ("left_out", "kind"),
    [
        (lambda test: test.slips, "a stick left out, or a reversal instead of it"),
        (lambda test: not test.slips, "a slipping cell declared stuck"),
    ],
    ids=["slips", "sticks"],
)
def test_an_inequality_that_is_left_out_lets_wrong_orders_pass(left_out, kind, monkeypatch) -> None:
    monkeypatch.setattr(coulomb, "_tests", without(left_out))
    assert not all(refused(*case) for case in wrong_orders(kind))


@pytest.mark.parametrize("slips", [True, False], ids=["slips", "sticks"])
def test_an_inequality_with_the_wrong_sign_refuses_right_orders(slips, monkeypatch) -> None:
    complete = coulomb._tests

    def turned(*arguments):
        for test in complete(*arguments):
            row = [-value for value in test.row] if test.slips == slips else test.row
            yield dataclasses.replace(test, row=row)

    monkeypatch.setattr(coulomb, "_tests", turned)
    assert refused(*point("0.3", "0.6"))


def test_zeros_at_events_are_needed(monkeypatch) -> None:
    """Without the exact zeros the signs next to events are undecided, as they are for any order."""
    complete = coulomb._tests
    undivided = lambda *given: (dataclasses.replace(test, orders=(0, 0)) for test in complete(*given))  # noqa: E731
    monkeypatch.setattr(coulomb, "_tests", undivided)
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
    exact, guess = point("0.3", "0.6")
    solution, _ = unrepaired(exact, guess)
    other = dataclasses.replace(solution.candidate, **changed(solution.candidate))
    with ctx.workprec(BITS):
        dynamics = Dynamics(exact)
    with pytest.raises(NotProven, match=message):
        coulomb.check_order(dynamics, dataclasses.replace(solution, candidate=other))


@pytest.mark.parametrize(
    ("lowest", "expected"), [("1e-9", "positive"), ("-1e-9", "negative inside"), ("0", "undecided")]
)
def test_sign_of_a_parabola_is_decided_down_to_its_vertex(lowest, expected) -> None:
    """(s − 1/3)² + lowest: the ends of the interval are positive in all three cases."""
    third = arb(1) / 3
    [bound] = positive_bounds([[third * third + arb(lowest), -2 * third, arb(1)]])
    assert (bound > 0) == (expected == "positive")


def test_a_remainder_counts_against_a_sign() -> None:
    long = [arb(1), *[arb(0)] * 40]
    assert positive_bounds([long])[0] > 0
    assert not positive_bounds([[*long, arb(0, 1.1)]])[0] > 0
