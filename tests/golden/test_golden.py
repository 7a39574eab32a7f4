"""Commands ask for the same tasks as before, and say the same of a store that an earlier version wrote."""

import json
import lzma
import math
import re

import pytest

from tests.golden.record import EXPECTED, golden

pytestmark = pytest.mark.slow

NUMBER = re.compile(r"(?<![\w.])[-+−]?\d+\.?\d*(?:e[-+]?\d+)?(?!\w)")

ROUND_OFF = 1e-9
"""Of numbers that another processor computes from the same stored ones: sums and transforms take other orders there."""

SMALLEST = 1e-12
"""Below it, a number that is computed is a difference of larger ones that are equal."""

WRITTEN = json.loads(lzma.decompress(EXPECTED.read_bytes()))


@pytest.fixture(scope="module")
def now() -> dict[str, str]:
    return golden()


def difference(expected: str, given: str) -> str:
    """Say where two texts differ, first; empty where only the round-off of numbers does."""
    if expected == given:
        return ""
    if NUMBER.sub("#", expected) != NUMBER.sub("#", given):
        pairs = zip(NUMBER.sub("#", expected).split(), NUMBER.sub("#", given).split(), strict=False)
        return next((f"{one!r}: now {other!r}" for one, other in pairs if one != other), "another length")
    for one, other in zip(NUMBER.findall(expected), NUMBER.findall(given), strict=True):
        if not math.isclose(_value(one), _value(other), rel_tol=ROUND_OFF, abs_tol=SMALLEST):
            return f"{one}: now {other}"
    return ""


def _value(text: str) -> float:
    return float(text.replace("−", "-"))


@pytest.mark.parametrize("name", WRITTEN)
def test_what_is_asked_and_said_of_an_old_store_is_the_same(name: str, now: dict[str, str]):
    assert difference(WRITTEN[name], now[name]) == ""


def test_nothing_is_said_that_was_not_said_before(now: dict[str, str]):
    assert set(now) == set(WRITTEN)


@pytest.mark.parametrize(
    ("given", "differs"),
    [("a 1.5 dB", False), ("a 1.5000000001 dB", False), ("a 1.50001 dB", True), ("b 1.5 dB", True), ("a 1.5", True)],
)
def test_another_number_or_word_is_a_difference(given: str, differs: bool):
    assert bool(difference("a 1.5 dB", given)) is differs
