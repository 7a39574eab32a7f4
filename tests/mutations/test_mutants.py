"""Engines with one error each: without it they are sound, with it they move or record something else."""

import dataclasses

import numpy as np
import pytest

from multibody_xval.engines.contract.lanes import lane_of, modulated_lane, random_lanes, scaled_state
from multibody_xval.engines.interface.presets import NormalForce
from multibody_xval.engines.interface.registry import (
    default_engine_names,
    engine,
    engine_names,
    law_of,
    registered_names,
)
from multibody_xval.engines.interface.tolerances import STEPS
from multibody_xval.engines.interface.variant import Variant, variants_named
from multibody_xval.engines.shared.wide_range import DESIGN, LONG_USE, MANY_RUNS
from reference_lcp.chain.simulation import Lane
from reference_lcp.chain.trajectory import Trajectory
from reference_lcp.errors import ParameterError
from tests.mutations.abilities import ABILITIES
from tests.mutations.catalogue import MUTANTS
from tests.mutations.mutant import Mutant, Original, claimed_preset
from tests.mutations.ranges import RANGES

ROUND_OFF = 1e-7
"""Of every number of two periods, over the largest of its kind: the friction of a stick is a difference of velocities
over a time step, and two codes of the same steps round them differently."""


def usual_lanes(mutant: Mutant) -> list[Lane]:
    """Random lanes, and one whose contacts open or press unequally where the mutant takes it."""
    represented = claimed_preset(mutant).normal_force
    modulation = {NormalForce.CONSTANT: [], NormalForce.MODULATED: [0.5], NormalForce.LIFTING: [0.5, 1.5]}
    return [*random_lanes(), *(modulated_lane(part) for part in modulation[represented])]


def batches(mutant: Mutant) -> list[list[Lane]]:
    """The usual lanes; for mutants that are wrong elsewhere, also lanes all over the ranges and of every ability."""
    if mutant not in (*RANGES, *ABILITIES):
        return [usual_lanes(mutant)]
    preset, turned = claimed_preset(mutant), dataclasses.replace(DESIGN[2].lane, direction=0.5)
    special = {
        "turns": turned,
        "static_friction": dataclasses.replace(lane_of(0.3, 0.6), static_ratio=1.5),
    }
    able = [lane for ability, lane in special.items() if getattr(preset, ability)]
    return [usual_lanes(mutant), *([lane] for lane in (*(point.lane for point in DESIGN), *able))]


def runs(mutant: Mutant, moving: Original | Variant) -> list[Trajectory]:
    """Runs of every lane that a mutant is looked at in."""
    return [run for lanes in batches(mutant) for run in split(moving.build(lanes), lanes)]


def split(simulation, lanes) -> list[Trajectory]:
    """Two periods in two runs, split in a flight if there is one; the second again late, after many runs."""
    part, state = 3 * STEPS // 4, scaled_state(lanes)
    first = simulation.run(state, 0, part)
    ends = simulation.advance(state, 0, part)
    second = simulation.run(ends, part, 2 * STEPS - part)
    for _ in range(MANY_RUNS):
        simulation.advance(state, 0, 1)
    late = simulation.run(ends, LONG_USE, STEPS)
    return [*(one.joined(other) for one, other in zip(first, second, strict=True)), *late]


def distance(own: Trajectory, other: Trajectory) -> float:
    """Largest difference of anything that is recorded, over the largest number of its kind."""
    parted = own.normal_gap is not None and other.normal_gap is not None and np.any(own.normal_gap)
    gaps = ("normal_gap",) if parted else ()
    names = ("positions", "velocities", "friction", "normal_force", *gaps)
    return max(
        float(np.max(np.abs(getattr(own, name) - getattr(other, name))) / np.max(np.abs(getattr(own, name))))
        for name in names
    )


@pytest.mark.slow
@pytest.mark.parametrize("mutant", MUTANTS.values(), ids=lambda mutant: mutant.name)
def test_mutant_moves_as_its_original_without_its_error_and_with_it_does_not(mutant: Mutant) -> None:
    original = runs(mutant, Original(law_of(claimed_preset(mutant))))
    sound, wrong = (runs(mutant, mutant.variant(size)) for size in (0.0, mutant.size))
    assert max(map(distance, original, sound)) <= ROUND_OFF
    assert max(map(distance, original, wrong)) > 10 * ROUND_OFF


def test_mutants_are_engines_that_nobody_lists() -> None:
    wrong = MUTANTS["bound"].variant(0.1)
    assert engine(wrong.engine).name == "mutant@bound@0.1"
    assert wrong.preset.shares_scheme
    listed = [*registered_names(), *engine_names(), *default_engine_names(), *map(str, variants_named(["all"]))]
    assert not [name for name in listed if "mutant@" in name]


@pytest.mark.parametrize(
    ("name", "reason"),
    [
        ("mutant@bond@0.1", "mutant = 'bond' is unknown; allowed: "),
        ("mutant@bound", "'mutant@bound'; allowed: mutant@NAME@SIZE"),
        ("mutant@bound@much", "'mutant@bound@much'; allowed: mutant@NAME@SIZE"),
        ("mutant@bound@-1", "size = -1"),
        ("mutation@bound@1", "engine = 'mutation@bound@1' is unknown"),
    ],
)
def test_mutant_that_is_none_is_refused(name: str, reason: str) -> None:
    with pytest.raises(ParameterError, match=reason):
        engine(name)


def test_mutant_of_a_law_claims_the_honest_law() -> None:
    wrong = MUTANTS["pybullet-damping"].variant(9)
    assert str(wrong.law) == "pybullet@law:joint:default"
    assert law_of(wrong.preset).constants == law_of(MUTANTS["pybullet-damping"].of.preset).constants


def test_excused_mutant_states_a_text_and_no_law() -> None:
    wrong = MUTANTS["excused"].variant(1)
    assert wrong.preset.known_deviation == "bad weather"
    assert wrong.law is None
