"""Numbers of a proof: decimals as they are typed, doubles as they are stored, and what is refused."""

from decimal import Decimal
from fractions import Fraction

import pytest

from reference_lcp import Chain, ExactChain, HarmonicForce, ParameterError, Preload, StillBase
from reference_lcp.exact.proof.exact_chain import MOST_CELLS


def test_ratios_are_the_decimals_that_are_typed_and_a_float_stands_for_its_shortest_one() -> None:
    exact = ExactChain.from_ratios(friction_ratio="0.3", frequency_ratio="0.6", damping_ratio=Decimal("0.01"))
    assert exact.friction == (Fraction(3, 10),) * 7
    assert exact.frequency_squared == Fraction(36, 100)
    assert exact.chain_damping_squared[0] == Fraction(4, 10**4)
    assert exact == ExactChain.from_ratios(friction_ratio=0.3, frequency_ratio=0.6, damping_ratio=0.01)


@pytest.mark.parametrize(
    ("multiple", "half", "cycle"), [("2", True, 1), ("1", False, 1), ("3", False, 1), ("0.5", False, 2)]
)
def test_modulation_says_after_what_time_the_drive_repeats(multiple, half, cycle) -> None:
    exact = ExactChain.from_ratios(frequency_ratio=1, modulation="0.5", modulation_multiple=multiple)
    assert (exact.half, exact.cycle) == (half, cycle)


def test_force_and_modulation_of_doubles_are_over_the_amplitude_and_at_the_fraction_that_is_meant() -> None:
    chain = Chain.from_ratios(cells=2, friction_ratio=0.3)
    force = HarmonicForce(float(chain.chain_stiffness[0]) * 0.01, 20.0)
    exact = ExactChain.of(chain, force, Preload.at_multiple(force, 0.5, 3.0))
    assert (exact.moving_base, exact.modulation.multiple) == (False, 3)
    assert float(exact.friction[0]) == pytest.approx(0.3, rel=1e-14)


@pytest.mark.parametrize(
    ("ratios", "message"),
    [
        ({"friction_ratio": "lots"}, r"friction_ratio = 'lots' is no decimal number; allowed: >= 0"),
        ({"friction_ratio": "nan"}, r"friction_ratio = 'nan' is outside its range"),
        ({"friction_ratio": "1e13"}, r"friction_ratio = '1e13' is outside its range; allowed: 1e-12 to 1e\+12"),
        ({"frequency_ratio": "0"}, r"frequency_ratio = '0' is outside its range; allowed: > 0"),
        ({"cells": MOST_CELLS + 1}, rf"cells = {MOST_CELLS + 1} is outside its range"),
        ({"mass_ratio": ("1", "2")}, r"mass_ratio has 2 numbers; allowed: one, or 7"),
        ({"modulation": "1.5"}, r"modulation = 1.5 in a proof; allowed: 0 to 1"),
        ({"modulation": "1", "modulation_multiple": "1.4142"}, r"modulation_multiple = 1.4142.*do not repeat together"),
    ],
)  # fmt: skip
def test_wrong_ratio_is_refused_with_its_name(ratios, message) -> None:
    with pytest.raises(ParameterError, match=message):
        ExactChain.from_ratios(**({"frequency_ratio": "0.6"} | ratios))


def test_drive_that_does_not_repeat_is_refused() -> None:
    with pytest.raises(ParameterError, match="StillBase has no steady state that can be proven; allowed: HarmonicBase"):
        ExactChain.of(Chain.from_ratios(), StillBase())
