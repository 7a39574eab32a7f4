"""Proven steady states: against the floating-point solver, closed forms, and each other."""

import dataclasses
import time
from decimal import Decimal
from fractions import Fraction

import numpy as np
import pytest

from reference_lcp import (
    Chain,
    ExactChain,
    HarmonicBase,
    HarmonicForce,
    NotProven,
    ParameterError,
    Preload,
    decibel,
    exact_steady_state,
    prove,
    prove_steady_state,
    transmittance,
)
from reference_lcp.exact.proof.exact_chain import ExactModulation
from reference_lcp.exact.proof.prove import Uniqueness
from tests.reference_lcp.cases import euler_orbit

pytest.importorskip("flint", reason="python-flint is not installed")

FLOATING_POINT_DB = 1e-11
"""Twice the largest error of the floating-point solver with friction over figure 3."""

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


CHAINS = {
    "weak friction": ({"friction_ratio": "0.05", "frequency_ratio": "0.75"}, "damping"),
    "long sticks": ({"friction_ratio": "1", "frequency_ratio": "0.75"}, "damping"),
    "above the gap": ({"friction_ratio": "0.3", "frequency_ratio": "1.1"}, "damping"),
    "no friction": ({"friction_ratio": "0", "frequency_ratio": "0.7"}, "damping"),
    "all stuck": ({"friction_ratio": "50", "frequency_ratio": "0.7"}, "damping"),
    "nine cells": ({"cells": 9}, "damping"),
    "no dashpots": ({"damping_ratio": "0"}, "contraction"),
    "no dashpots, all stuck": ({"damping_ratio": "0", "frequency_ratio": "0.35"}, "not shown"),
    "inner dashpots": ({"mass_ratio": "0.5", "stiffness_ratio": "0.25", "inner_damping_ratio": "0.02"}, "damping"),
    "disordered": (DISORDERED, "contraction"),
    **{f"random {seed}": (random_ratios(seed), "contraction" if seed in (1, 5) else "damping") for seed in range(6)},
}


@pytest.mark.parametrize("name", CHAINS)
def test_floating_point_is_within_its_error_of_what_is_proven(name) -> None:
    """Digits are lost where little of the drive arrives, as round-off is that of the drive."""
    ratios, unique_by = CHAINS[name]
    proof, state = proven(**ratios), solved(**ratios)
    assert difference(proof, state.transmittance_db) < FLOATING_POINT_DB / min(1, float(proof.transmittance.value))
    assert [float(part.value) for part in proof.stuck_fraction] == pytest.approx(state.stuck_fraction, abs=1e-11)
    changes = [(change.cell, change.kind) for change in state.transitions]
    assert [(change.cell, change.kind) for change in proof.transitions] == changes
    times = [change.time / state.orbit.lane.drive.period for change in state.transitions]
    assert [float(change.time_over_period.value) for change in proof.transitions] == pytest.approx(times, abs=1e-11)
    assert str(proof.unique_by) == unique_by


@pytest.mark.parametrize("make", [HarmonicBase, HarmonicForce])
def test_chain_in_doubles_is_proven_under_either_drive(make) -> None:
    """In units that are not one, with dashpots in every cell that a slip moves."""
    chain = Chain.from_ratios(
        cells=3, friction_ratio=0.1, mass_ratio=0.7, stiffness_ratio=0.4, inner_damping_ratio=0.02, outer_mass=2
    )
    drive = make(0.01 if make is HarmonicBase else 10.0, 0.9 * chain.resonator_frequency)
    proof = prove_steady_state(chain, drive)
    assert {change.cell for change in proof.transitions} == {1, 2, 3}
    assert difference(proof, exact_steady_state(chain, drive).transmittance_db) < FLOATING_POINT_DB


def test_deep_antiresonance_has_its_digits_where_floating_point_has_lost_them() -> None:
    proof = proven("0", "1.01")
    assert difference(proof, "-239.7238160516744980409443") < 1e-20
    assert difference(proof, solved("0", "1.01").transmittance_db) > 1e-6
    with pytest.raises(NotProven, match=r"the last mass stands still .* it has no level"):
        proven("0", "1")


def test_another_friction_is_proven_to_be_another_motion() -> None:
    other = proven("0.30000003")
    assert 1e-9 < difference(other, solved().transmittance_db) < 1e-5


BEFORE, AFTER = "0.7354812364061960", "0.7354812364061962"


@pytest.mark.parametrize(("frequency_ratio", "transitions", "repaired"), [(BEFORE, 20, True), (AFTER, 16, False)])
def test_both_sides_of_a_grazing_are_proven(frequency_ratio, transitions, repaired) -> None:
    """A sticking force just reaches its bound, or just does not: 2e-16 apart, with other events.

    Floating point has the same 16 on both sides: slips are inserted.
    """
    proof = proven("0.3", frequency_ratio)
    assert len(solved("0.3", frequency_ratio).transitions) == 16
    assert (len(proof.transitions), proof.repairs > 0) == (transitions, repaired)


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
    coarse, fine = (decibel(transmittance(euler_orbit(chain, drive, steps, preload=preload))) for steps in (1600, 3200))
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
    many = prove(ExactChain.from_ratios(friction_ratio="0.3", frequency_ratio="0.6", cells=2), digits=60)
    assert many.transmittance_db.radius < Decimal("1e-60")
    assert proven(cells=2).transmittance_db.contains(many.transmittance_db.value)


@pytest.mark.parametrize(
    ("seconds", "ratios"),
    [(1e-3, {}), (0.2, {"cells": 100}), (0.2, {"cells": 60, "modulation": "0.5", "modulation_multiple": "0.5"})],
)
def test_time_that_does_not_suffice_proves_nothing(seconds, ratios) -> None:
    """The search in floating point, which takes long chains more than half a minute, keeps the limit too."""
    exact, began = ExactChain.from_ratios(friction_ratio="0.3", frequency_ratio="0.6", **ratios), time.monotonic()
    with pytest.raises(NotProven, match=rf"the time limit of {seconds} s is over"):
        prove(exact, time_limit=seconds)
    assert time.monotonic() - began < 10


@pytest.mark.parametrize(
    ("given", "message"),
    [({"digits": 0}, "digits = 0"), ({"time_limit": 0}, "time_limit = 0"), ({"digits": 10**6}, "digits")],
)
def test_wrong_request_is_refused(given, message) -> None:
    with pytest.raises(ParameterError, match=message):
        prove(ExactChain.from_ratios(frequency_ratio="0.6"), **given)
