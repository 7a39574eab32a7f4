"""Proven steady states: against the floating-point solver, closed forms, and each other."""

import dataclasses
import time
from decimal import Decimal
from fractions import Fraction

import numpy as np
import pytest

from reference_lcp import (
    Chain,
    CompiledSimulation,
    ExactChain,
    HarmonicBase,
    HarmonicForce,
    Lane,
    NotProven,
    ParameterError,
    Preload,
    decibel,
    exact_steady_state,
    frictionless_transmittance,
    periodic_orbits,
    prove,
    prove_steady_state,
    stuck_transmittance,
    transmittance,
)
from reference_lcp.exact.proof.exact_chain import ExactModulation
from reference_lcp.exact.proof.prove import Uniqueness

pytest.importorskip("flint", reason="python-flint is not installed")

FLOATING_POINT_DB = 1e-11
"""Twice the largest error of the floating-point solver with friction over figure 3."""

RANDOM_CHAINS = 8

DISORDERED = {
    "friction_ratio": ("0.1", "0.5", "0.3", "0", "0.2", "0.7", "0.05"),
    "mass_ratio": ("1", "1.1", "0.9", "1.2", "0.8", "1.3", "0.7"),
    "damping_ratio": ("0.01", "0.02", "0", "0.03", "0.01", "0", "0.01"),
}
"""Cells that all differ, one without friction, two without dashpot."""


def proven(friction_ratio="0.3", frequency_ratio="0.6", **ratios):
    return prove(ExactChain.from_ratios(friction_ratio=friction_ratio, frequency_ratio=frequency_ratio, **ratios))


def solved(friction_ratio="0.3", frequency_ratio="0.6", **ratios):
    """The same in floating point."""
    numbers = {name: np.array(value, dtype=float) for name, value in ratios.items() if name != "cells"}
    cells = {"cells": ratios.get("cells", 7)}
    chain = Chain.from_ratios(friction_ratio=np.array(friction_ratio, dtype=float), **numbers, **cells)
    return exact_steady_state(chain, HarmonicBase.from_ratio(chain, float(frequency_ratio)))


def difference(proof, level) -> float:
    return float(abs(proof.transmittance_db.value - Decimal(level)))


def test_a_proven_value_has_twenty_digits() -> None:
    """The value was computed by another program at 192 bits."""
    proof = proven("0.3", "0.6")
    assert proof.transmittance_db.radius < Decimal("1e-20")
    assert proof.transmittance_db.contains(Decimal("-0.147086317722704478358698096747562039531436940"))
    assert proof.phase.contains(Decimal("-0.18237565186472315507797787258256"))
    assert (len(proof.transitions), proof.unique_by, proof.repairs) == (20, Uniqueness.DAMPING, 0)


@pytest.mark.parametrize("frequency_ratio", ["0.35", "0.75", "1.1", "1.45"])
@pytest.mark.parametrize("friction_ratio", ["0.05", "0.3", "1"])
def test_floating_point_is_within_its_error_of_what_is_proven(friction_ratio, frequency_ratio) -> None:
    proof, state = proven(friction_ratio, frequency_ratio), solved(friction_ratio, frequency_ratio)
    assert difference(proof, state.transmittance_db) < FLOATING_POINT_DB
    assert [float(part.value) for part in proof.stuck_fraction] == pytest.approx(state.stuck_fraction, abs=1e-11)
    period = state.orbit.lane.drive.period
    assert [(change.cell, change.kind) for change in proof.transitions] == [
        (change.cell, change.kind) for change in state.transitions
    ]
    assert [float(change.time_over_period.value) for change in proof.transitions] == pytest.approx(
        [change.time / period for change in state.transitions], abs=1e-11
    )
    slips = state.travels / state.orbit.lane.drive.amplitude
    assert float(proof.largest_slip.value) == pytest.approx(np.max(slips, initial=0.0), abs=1e-10)
    assert proof.multipliers_bound < 1


@pytest.mark.parametrize(
    ("name", "ratios", "unique_by"),
    [
        ("one cell", {"cells": 1}, "damping"),
        ("two cells", {"cells": 2}, "damping"),
        ("nine cells", {"cells": 9}, "damping"),
        ("no dashpots", {"damping_ratio": "0"}, "contraction"),
        ("no dashpots, all stuck", {"damping_ratio": "0", "frequency_ratio": "0.35"}, "not shown"),
        ("inner dashpots", {"mass_ratio": "0.5", "stiffness_ratio": "0.25", "inner_damping_ratio": "0.02"}, "damping"),
        ("disordered", DISORDERED, "contraction"),
        ("graded", {"cells": 4, "chain_stiffness_ratio": ("1.5", "0.9", "0.8", "0.7")}, "damping"),
    ],
)  # fmt: skip
def test_chains_of_all_kinds_are_proven(name, ratios, unique_by) -> None:
    proof = proven(**ratios)
    assert str(proof.unique_by) == unique_by
    assert difference(proof, solved(**ratios).transmittance_db) < FLOATING_POINT_DB


def random_ratios(seed: int) -> dict:
    """A chain of 1 to 6 cells whose numbers are all random, some without friction or dashpots."""
    rng = np.random.default_rng(seed)
    cells = int(rng.integers(1, 7))

    def drawn(low, high, zeros=0.0):
        return tuple("0" if rng.random() < zeros else f"{rng.uniform(low, high):.4f}" for _ in range(cells))

    return {
        "cells": cells,
        "frequency_ratio": f"{rng.uniform(0.3, 1.6):.4f}",
        "friction_ratio": drawn(0.02, 1, 0.15),
        "mass_ratio": drawn(0.3, 2),
        "stiffness_ratio": drawn(0.3, 2),
        "outer_mass_ratio": drawn(0.5, 2),
        "chain_stiffness_ratio": drawn(0.5, 2),
        "damping_ratio": drawn(0.002, 0.05, 0.3 * (seed % 2)),
        "inner_damping_ratio": drawn(0, 0.05, 0.5),
    }


@pytest.mark.parametrize("seed", range(RANDOM_CHAINS))
def test_random_chains_are_proven(seed) -> None:
    """Floating point has lost digits where little of the drive arrives, as round-off is that of the drive."""
    ratios = random_ratios(seed)
    proof, state = proven(**ratios), solved(**ratios)
    assert difference(proof, state.transmittance_db) < FLOATING_POINT_DB / min(1, float(proof.transmittance.value))


def test_force_on_the_first_mass_is_proven() -> None:
    chain = Chain.from_ratios(friction_ratio=0.3)
    drive = HarmonicForce(10.0, 0.7 * chain.resonator_frequency)
    proof = prove_steady_state(chain, drive)
    assert difference(proof, exact_steady_state(chain, drive).transmittance_db) < FLOATING_POINT_DB


def test_units_of_a_chain_in_doubles_do_not_change_what_is_proven() -> None:
    """The doubles of both are those of the ratios to a rounding; a level changes by no more than some roundings."""
    chain = Chain.from_ratios(friction_ratio=0.3)
    proof = prove_steady_state(chain, HarmonicBase.from_ratio(chain, 0.6))
    assert difference(proof, proven().transmittance_db.value) < 1e-12


@pytest.mark.parametrize(
    ("friction_ratio", "frequency_ratio", "linear"),
    [("0", "0.7", frictionless_transmittance), ("50", "0.7", stuck_transmittance)],
)
def test_linear_limits_are_those_of_closed_forms(friction_ratio, frequency_ratio, linear) -> None:
    chain = Chain.from_ratios()
    expected = decibel(linear(chain, HarmonicBase.from_ratio(chain, float(frequency_ratio))))
    proof = proven(friction_ratio, frequency_ratio)
    assert difference(proof, expected) < 1e-11
    assert proof.transitions == []


def test_deep_antiresonance_has_its_digits_where_floating_point_has_lost_them() -> None:
    proof = proven("0", "1.01")
    assert difference(proof, "-239.7238160516744980409443") < 1e-20
    assert difference(proof, solved("0", "1.01").transmittance_db) > 1e-6


def test_mass_that_stands_still_has_no_level() -> None:
    with pytest.raises(NotProven, match=r"the last mass stands still .* it has no level"):
        proven("0", "1")


def test_another_friction_is_proven_to_be_another_motion() -> None:
    other = proven("0.30000003")
    assert 1e-9 < difference(other, solved().transmittance_db) < 1e-5


BEFORE, AFTER = "0.7354812364061960", "0.7354812364061962"


@pytest.mark.parametrize(("frequency_ratio", "transitions"), [(BEFORE, 20), (AFTER, 16)])
def test_both_sides_of_a_grazing_are_proven(frequency_ratio, transitions) -> None:
    """A sticking force just reaches its bound, or just does not: 2e-16 apart, with other events."""
    assert len(proven("0.3", frequency_ratio).transitions) == transitions


def test_missing_slips_near_a_grazing_are_inserted() -> None:
    """The floating-point solver sees 16 events where 20 happen."""
    assert len(solved("0.3", BEFORE).transitions) == 16
    assert proven("0.3", BEFORE).repairs > 0


def test_full_period_gives_what_half_a_period_gives() -> None:
    """Normal forces that change by 1e-25 break the symmetry, and change the level by no more than some of that."""
    half = ExactChain.from_ratios(friction_ratio="0.3", frequency_ratio="0.9", cells=3)
    full = dataclasses.replace(half, modulation=ExactModulation(Fraction(1, 10**25), Fraction(1), Fraction(0)))
    assert (half.half, full.half) == (True, False)
    one, other = prove(half), prove(full)
    assert difference(other, one.transmittance_db.value) < 1e-22
    assert len(one.transitions) == len(other.transitions)


@pytest.mark.parametrize("multiple", [1.0, 2.0])
def test_modulated_normal_force_is_the_limit_of_small_steps(multiple) -> None:
    """The scheme is of first order: its error is what the last halving of the step changes, here to a half of that."""
    chain = Chain.from_ratios(cells=3, friction_ratio=0.3)
    drive = HarmonicBase.from_ratio(chain, 0.9)
    preload = Preload.at_multiple(drive, 0.5, multiple, 0.3)
    proof = prove_steady_state(chain, drive, preload)
    coarse, fine = (
        decibel(
            transmittance(periodic_orbits(CompiledSimulation([Lane.periodic(chain, drive, steps, preload)]), steps)[0])
        )
        for steps in (3200, 6400)
    )
    assert difference(proof, fine) < 1.5 * abs(fine - coarse)
    assert proof.unique_by == Uniqueness.DAMPING


def test_modulation_that_repeats_after_two_periods_is_proven() -> None:
    proof = proven("0.3", "0.9", cells=3, modulation="0.3", modulation_multiple="0.5")
    assert max(change.time_over_period.value for change in proof.transitions) > 1
    assert proof.transmittance_db.radius < Decimal("1e-20")


@pytest.mark.parametrize("rubs", [1, 2])
def test_a_cell_without_friction_has_no_transitions_though_it_turns_round(rubs) -> None:
    proof = proven(tuple("0.3" if cell == rubs else "0" for cell in (1, 2)), "0.9", cells=2, modulation="0.5")
    assert {change.cell for change in proof.transitions} == {rubs}


def test_more_digits_are_in_fewer_digits() -> None:
    few, many = (
        proven(cells=2),
        prove(ExactChain.from_ratios(friction_ratio="0.3", frequency_ratio="0.6", cells=2), digits=60),
    )
    assert many.transmittance_db.radius < Decimal("1e-60")
    assert few.transmittance_db.contains(many.transmittance_db.value)


def test_time_that_does_not_suffice_proves_nothing() -> None:
    with pytest.raises(NotProven, match=r"the time limit of 0\.001 s is over"):
        prove(ExactChain.from_ratios(friction_ratio="0.3", frequency_ratio="0.6"), time_limit=1e-3)


@pytest.mark.parametrize(
    "ratios",
    [
        {"cells": 100},
        {"cells": 60, "modulation": "0.5"},
        {"cells": 60, "modulation": "0.5", "modulation_multiple": "0.5"},
    ],
)
def test_search_in_floating_point_keeps_the_time_limit_too(ratios) -> None:
    """Without that it takes the first and the last chain more than half a minute."""
    exact, began = ExactChain.from_ratios(friction_ratio="0.3", frequency_ratio="0.6", **ratios), time.monotonic()
    with pytest.raises(NotProven, match=r"the time limit of 0\.2 s is over"):
        prove(exact, time_limit=0.2)
    assert time.monotonic() - began < 10


@pytest.mark.parametrize(
    ("given", "message"),
    [({"digits": 0}, "digits = 0"), ({"time_limit": 0}, "time_limit = 0"), ({"digits": 10**6}, "digits")],
)
def test_wrong_request_is_refused(given, message) -> None:
    with pytest.raises(ParameterError, match=message):
        prove(ExactChain.from_ratios(frequency_ratio="0.6"), **given)
