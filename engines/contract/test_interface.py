"""State goes in, a trajectory comes out, nothing is carried over; what an engine declares, and refuses."""

import re

import numpy as np
import pytest

from multibody_xval.engines.contract.lanes import lane_of, random_state, run_of
from multibody_xval.engines.interface.registry import engine
from multibody_xval.engines.interface.tolerances import ROUND_OFF, STEPS
from multibody_xval.engines.interface.variant import Variant
from reference_lcp.chain.drives import HarmonicBase
from reference_lcp.chain.mass_in_mass import Chain
from reference_lcp.chain.simulation import Lane
from reference_lcp.chain.trajectory import State
from reference_lcp.defaults import BASE_AMPLITUDE
from reference_lcp.errors import ParameterError


def test_split_run_equals_whole_run(tested: Variant) -> None:
    """Two runs of 100 steps are one of 200, to what the preset states."""
    simulation = tested.build([lane_of(0.3, 0.6)])
    whole = simulation.run(random_state(1), 0, 200)[0]
    first = simulation.run(random_state(1), 0, 100)[0]
    second = simulation.run(first.end, 100, 100)[0]
    allowed = tested.preset.split_tolerance * BASE_AMPLITUDE
    assert np.max(np.abs(whole.positions[100:] - second.positions)) <= allowed, "the second half starts elsewhere [m]"
    assert np.allclose(whole.time[100:], second.time), "the second half has other times"


def test_repeated_run_is_bitwise_equal(tested: Variant) -> None:
    """Nothing is left of an earlier run, where the engine is declared deterministic."""
    if not tested.capabilities.deterministic:
        pytest.skip(f"{tested.engine} is not declared deterministic")
    lane, state = lane_of(0.3, 0.6), random_state(1)
    simulation = tested.build([lane])
    first = simulation.run(state, 0, 50)[0]
    simulation.run(State.at_rest(1, 7), 50, 77)
    for repeated in (simulation.run(state, 0, 50)[0], run_of(tested, lane, state, 50)):
        assert np.array_equal(first.positions, repeated.positions), "a repeated run differs"
        assert np.array_equal(first.friction, repeated.friction), "the friction of a repeated run differs"


def test_batch_equals_its_lanes_alone_and_subset_keeps_them(tested: Variant) -> None:
    """Lanes do not feel each other."""
    lanes = [lane_of(0.3, 0.6), lane_of(0.1, 0.9), lane_of(1.0, 1.3)]
    state = random_state(3)
    together = tested.build(lanes)
    runs, part = together.run(state, 0, 40), together.subset([2, 0]).run(state.subset([2, 0]), 0, 40)
    for index, lane in enumerate(lanes):
        alone = tested.build([lane]).run(state.subset([index]), 0, 40)[0]
        assert np.array_equal(alone.positions, runs[index].positions), f"lane {index} differs from the lane alone"
    assert np.array_equal(part[0].positions, runs[2].positions), "a subset differs from the batch"
    assert np.array_equal(part[1].positions, runs[0].positions), "a subset differs from the batch"


def test_advance_ends_where_run_ends(tested: Variant) -> None:
    """`advance` is `run` without its record."""
    simulation = tested.build([lane_of(0.3, 0.6)])
    end = simulation.run(random_state(1), 0, 60)[0].end
    short = simulation.advance(random_state(1), 0, 60)
    assert np.array_equal(end.positions, short.positions), "advance ends at other positions"
    assert np.array_equal(end.velocities, short.velocities), "advance ends with other velocities"


def test_trajectory_has_one_finite_row_a_step_in_si_units(tested: Variant) -> None:
    """Rows are at the ends of the steps."""
    lane = lane_of(0.3, 0.6)
    run = tested.build([lane]).run(random_state(1), 3, 25)[0]
    shapes = [rows.shape for rows in (run.positions, run.velocities, run.friction, run.normal_force)]
    assert shapes == [(25, 14), (25, 14), (25, 7), (25, 7)], f"shapes of the rows are {shapes}"
    assert np.allclose(run.time, lane.time_step * np.arange(4, 29)), "rows are not at the ends of the steps"
    assert np.all(run.normal_force >= 0), "a contact pulls"
    for rows in (run.positions, run.velocities, run.friction, run.normal_force):
        assert np.all(np.isfinite(rows)), "the trajectory has numbers that are not finite"


MANY_RUNS = 500
"""Of which one in a hundred that fails is missed once in 150 times."""


@pytest.mark.slow
def test_many_runs_from_one_state_end_alike(tested: Variant) -> None:
    """None of them fails, and long use changes nothing, where the engine is declared deterministic."""
    simulation, state = tested.build([lane_of(0.3, 0.6)]), random_state(1)
    first = simulation.advance(state, 0, 2)
    for number in range(MANY_RUNS):
        end = simulation.advance(state, 0, 2)
        assert np.all(np.isfinite(end.positions) & np.isfinite(end.velocities)), f"run {number} is not finite"
        if tested.capabilities.deterministic:
            assert np.array_equal(end.positions, first.positions), f"run {number} ends elsewhere"


def test_capabilities_name_the_engine_and_every_option_has_a_reason(installed: str) -> None:
    """Reports print them."""
    abilities = engine(installed).capabilities
    for name in ("title", "package", "licence"):
        assert getattr(abilities, name), f"capabilities have no {name}"
    assert engine(installed).version(), "the version is empty"
    assert abilities.precision in ROUND_OFF, f"precision = {abilities.precision!r}; allowed: {', '.join(ROUND_OFF)}"
    presets = [preset for named in abilities.presets.values() for preset in named.values()]
    unsaid = [name for preset in presets for name, option in preset.options.items() if not option.reason]
    assert not unsaid, f"options have no reason: {', '.join(unsaid)}"
    assert all(preset.description for preset in presets), "a preset has no description"
    assert all("tuned" in named for named in abilities.presets.values()), "a formulation has no preset tuned"


def test_unknown_formulation_and_preset_are_refused(installed: str) -> None:
    """With the ones that there are."""
    formulation = next(iter(engine(installed).capabilities.presets))
    with pytest.raises(ParameterError, match=re.escape(f"formulation of {installed} = 'glue' is unknown; allowed: ")):
        engine(installed).build([lane_of(0.3, 0.6)], formulation="glue")
    with pytest.raises(ParameterError, match=re.escape(f"preset of {installed} = 'best' is unknown; allowed: tuned")):
        engine(installed).build([lane_of(0.3, 0.6)], formulation=formulation, preset="best")


def test_chains_of_different_lengths_and_states_of_another_shape_are_refused(installed: str) -> None:
    """Before any step."""
    formulation = next(iter(engine(installed).capabilities.presets))
    short = Chain.from_ratios(cells=2)
    mixed = [lane_of(0.3, 0.6), Lane.periodic(short, HarmonicBase.from_ratio(short, 0.9), STEPS)]
    with pytest.raises(ParameterError, match=r"chains of \[2, 7\] cells"):
        engine(installed).build(mixed, formulation=formulation)
    with pytest.raises(ParameterError, match=r"\(1, 6\)"):
        engine(installed).build([lane_of(0.3, 0.6)], formulation=formulation).run(State.at_rest(1, 3), 0, 10)
