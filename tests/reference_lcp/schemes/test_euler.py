"""The scheme of equation (5): Lemke and the compiled closed form, and motions known in closed form."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from reference_lcp import (
    Chain,
    CompiledSimulation,
    HarmonicBase,
    HarmonicForce,
    Lane,
    ParameterError,
    State,
    StillBase,
    simulate,
)
from reference_lcp.chain.mass_in_mass import mechanical_energy
from reference_lcp.schemes.euler import LemkeSimulation
from tests.reference_lcp.cases import driven, random_chain

ROUND_OFF = 1e-13
"""Of one step, relative to the largest motion: some hundred roundings of double precision."""


@settings(max_examples=25, deadline=None)
@given(st.integers(0, 10**6), st.integers(1, 11))
def test_lemke_and_the_closed_form_agree_at_every_step_to_round_off(seed, cells) -> None:
    """From the same state, step after step, also where contacts change between stick and slip; with equal cells too."""
    rng = np.random.default_rng(seed)
    chain = random_chain(rng, cells) if seed % 2 else Chain.from_ratios(cells=cells, friction_ratio=0.3)
    drive = HarmonicBase(0.01, rng.uniform(5, 60))
    lane = Lane.periodic(chain, drive, 400)
    lemke, compiled = LemkeSimulation([lane]), CompiledSimulation([lane])
    state = State(rng.normal(0, 0.01, (1, 2 * cells)), rng.normal(0, 0.1, (1, 2 * cells)))
    for step in range(40):
        one, other = lemke.run(state, step, 1)[0], compiled.run(state, step, 1)[0]
        assert np.allclose(one.velocities, other.velocities, rtol=0, atol=ROUND_OFF)
        assert np.allclose(one.positions, other.positions, rtol=0, atol=ROUND_OFF)
        assert np.allclose(one.friction * lane.time_step, other.friction * lane.time_step, rtol=0, atol=ROUND_OFF)
        state = one.end


def test_lanes_of_one_batch_are_bitwise_what_they_are_alone() -> None:
    chains = [Chain.from_ratios(friction_ratio=ratio) for ratio in np.linspace(0, 1, 67)]
    lanes = [Lane.periodic(chain, HarmonicBase.from_ratio(chain, 0.9), 400) for chain in chains]
    rng = np.random.default_rng(0)
    state = State(rng.normal(0, 0.01, (67, 14)), rng.normal(0, 0.1, (67, 14)))
    together = CompiledSimulation(lanes).run(state, 5, 50)
    for lane in (0, 3, 63, 64, 66):
        alone = CompiledSimulation([lanes[lane]]).run(state.subset([lane]), 5, 50)[0]
        assert np.array_equal(alone.positions, together[lane].positions)
        assert np.array_equal(alone.friction, together[lane].friction)


@settings(max_examples=25, deadline=None)
@given(st.integers(0, 10**6), st.integers(1, 19), st.integers(1, 40))
def test_a_chain_cut_into_segments_moves_bitwise_as_one_beside_others(seed, lanes, cells) -> None:
    """Alone it advances eight of its cells at once, beside seven others or more one of them."""
    rng = np.random.default_rng(seed)
    drives = [HarmonicBase(0.01, rng.uniform(5, 60)) for _ in range(lanes)]
    batch = [Lane.periodic(random_chain(rng, cells), drive, 400) for drive in drives]
    state = State(rng.normal(0, 0.01, (lanes, 2 * cells)), rng.normal(0, 0.1, (lanes, 2 * cells)))
    together = CompiledSimulation(batch)
    ends, trajectories = together.advance(state, 3, 50), together.run(state, 3, 50)
    for lane in range(lanes):
        alone = together.subset([lane]).run(state.subset([lane]), 3, 50)[0]
        assert np.array_equal(alone.positions, trajectories[lane].positions)
        assert np.array_equal(alone.velocities, trajectories[lane].velocities)
        assert np.array_equal(alone.friction, trajectories[lane].friction)
        assert np.array_equal(alone.positions[-1], ends.positions[lane])
        assert np.array_equal(alone.velocities[-1], ends.velocities[lane])


@pytest.mark.parametrize("cells", [8, 24, 27, 80])
def test_equal_cells_move_bitwise_as_they_do_beside_cells_that_are_not(cells) -> None:
    """Alone their parameters are read from one row, beside a graded chain from a row of each cell."""
    rng = np.random.default_rng(cells)
    equal, graded = Chain.from_ratios(cells=cells, friction_ratio=0.3), random_chain(rng, cells)
    lanes = [Lane.periodic(chain, HarmonicBase.from_ratio(equal, 0.9), 400) for chain in (equal, graded)]
    state = State(rng.normal(0, 0.01, (2, 2 * cells)), rng.normal(0, 0.1, (2, 2 * cells)))
    together = CompiledSimulation(lanes).advance(state, 3, 100)
    alone = CompiledSimulation(lanes[:1]).advance(state.subset([0]), 3, 100)
    assert np.array_equal(alone.positions[0], together.positions[0])
    assert np.array_equal(alone.velocities[0], together.velocities[0])
    assert not np.array_equal(alone.positions[0], together.positions[1])


def test_a_lane_that_diverges_leaves_the_others_alone() -> None:
    """Columns of one table are neighbours in memory, not in the chain: no infinity reaches another lane."""
    chain = Chain.from_ratios(friction_ratio=0.3)
    lanes = [Lane.periodic(chain, HarmonicBase.from_ratio(chain, 0.9), 400) for _ in range(2)]
    state = State(np.vstack([np.full(14, np.inf), np.zeros(14)]), np.zeros((2, 14)))
    ends = CompiledSimulation(lanes).advance(state, 0, 100)
    alone = CompiledSimulation(lanes[1:]).advance(state.subset([1]), 0, 100)
    assert not np.all(np.isfinite(ends.positions[0]))
    assert np.array_equal(ends.positions[1], alone.positions[0])


def test_two_runs_of_half_the_steps_equal_one_run() -> None:
    chain = Chain.from_ratios(friction_ratio=0.3)
    lane = Lane.periodic(chain, HarmonicBase.from_ratio(chain, 0.6), 400)
    simulation = CompiledSimulation([lane])
    whole = simulation.run(State.at_rest(1, 7), 0, 200)[0]
    first = simulation.run(State.at_rest(1, 7), 0, 100)[0]
    second = simulation.run(first.end, 100, 100)[0]
    assert np.array_equal(whole.positions, [*first.positions, *second.positions])
    assert np.allclose(whole.time, [*first.time, *second.time])


def one_resonator(friction: float, stiffness: float = 100.0) -> Chain:
    """An inner mass of 1 kg in an outer mass so heavy that it stands still."""
    return Chain(
        cells=1, outer_mass=np.asarray(1e12), inner_mass=np.asarray(1.0), chain_stiffness=np.asarray(1.0),
        inner_stiffness=np.asarray(stiffness), normal_force=np.asarray(friction), friction_coefficient=np.asarray(1.0),
    )  # fmt: skip


def test_free_decay_loses_four_bounds_over_stiffness_a_cycle_and_rests_in_the_dead_band() -> None:
    """Coulomb friction lowers the amplitude linearly, by 4 F / k a cycle, until |x| <= F / k at a turn."""
    friction, stiffness, start = 2.0, 100.0, 0.27
    chain = one_resonator(friction, stiffness)
    period = 2 * np.pi / np.sqrt(stiffness)
    steps = 4000
    motion = simulate(
        chain, StillBase(), time_step=period / steps, steps=5 * steps, positions=np.array([0.0, start])
    ).inner_positions[:, 0]
    cycles = motion[steps - 1 :: steps]
    expected = start - 4 * friction / stiffness * np.arange(1, 4)
    assert cycles[:3] == pytest.approx(expected, abs=4e-4)
    assert np.ptp(motion[-steps:]) < 1e-12
    assert abs(motion[-1]) <= friction / stiffness


def test_free_motion_of_an_undamped_frictionless_chain_keeps_its_energy() -> None:
    """The symplectic step keeps a modified energy: the true one oscillates by O(Δt) and does not drift."""
    chain = Chain.from_ratios(damping_ratio=0.0)
    rng = np.random.default_rng(3)
    dt = 0.01 / chain.highest_natural_frequency
    run = simulate(
        chain, StillBase(), time_step=dt, steps=200_000, positions=rng.normal(0, 0.01, 14), velocities=np.zeros(14)
    )
    energy = mechanical_energy(chain, run.positions, run.velocities)
    assert np.max(np.abs(energy / energy[0] - 1)) < 0.01
    assert np.mean(energy[-1000:]) == pytest.approx(np.mean(energy[:1000]), rel=2e-3)


def test_friction_never_exceeds_its_bound_and_never_gives_energy() -> None:
    chain, drive = driven(0.62, friction_ratio=[0.1, 0.3, 0.0, 0.6, 1.0, 0.05, 0.3])
    run = simulate(chain, drive, time_step=drive.period / 400, steps=4000)
    assert np.all(np.abs(run.friction) <= chain.friction_bound)
    assert np.all(run.friction * run.relative_velocity <= 1e-15)


@pytest.mark.parametrize("ratio", [0.1, 0.6, 1.3])
def test_two_motions_under_one_drive_never_drift_apart(ratio) -> None:
    """Coulomb friction is monotone: the energy norm of the difference does not grow, to the scheme's order."""
    chain, drive = driven(ratio, friction_ratio=0.3)
    lane = Lane.periodic(chain, drive, 4000)
    rng = np.random.default_rng(1)
    state = State(rng.normal(0, 0.01, (2, 14)), rng.normal(0, 0.2, (2, 14)))
    one, other = CompiledSimulation([lane, lane]).run(state, 0, 20_000)
    x, v = one.positions - other.positions, one.velocities - other.velocities
    distance = np.sqrt(
        np.einsum("ti,ij,tj->t", v, chain.mass_matrix, v) + np.einsum("ti,ij,tj->t", x, chain.stiffness_matrix, x)
    )
    growth = np.max(distance[1:] - np.minimum.accumulate(distance)[:-1])
    assert growth < 2 * lane.time_step * chain.highest_natural_frequency * distance[0]
    assert distance[-1] < 0.9 * distance[0]


def test_force_on_the_first_cell_and_equivalent_base_motion_give_the_same_motion() -> None:
    """Without a dashpot to the base, U0 sin ωt of the base is the force k_c U0 sin ωt on cell 1."""
    chain = Chain.from_ratios(damping_ratio=0.0, friction_ratio=0.3)
    base = HarmonicBase.from_ratio(chain, 0.7)
    force = HarmonicForce(float(chain.chain_stiffness[0]) * base.amplitude, base.angular_frequency)
    runs = [simulate(chain, drive, time_step=1e-3, steps=500) for drive in (base, force)]
    assert np.allclose(runs[0].positions, runs[1].positions, rtol=0, atol=1e-12 * base.amplitude)
    assert force.displacement_scale(chain) == pytest.approx(base.amplitude)


def test_scheme_is_of_first_order_in_the_time_step() -> None:
    """The error at a fixed time halves with the step: free oscillation of one resonator, closed form."""
    chain = one_resonator(0.0)
    errors = []
    for steps in (200, 400, 800, 1600):
        run = simulate(chain, StillBase(), time_step=0.5 / steps, steps=steps, positions=np.array([0.0, 1.0]))
        errors.append(abs(run.inner_positions[-1, 0] - np.cos(10 * 0.5)))
    orders = np.log2(np.array(errors[:-1]) / errors[1:])
    assert orders == pytest.approx(np.ones(3), abs=0.05)


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ({"time_step": 0.0, "steps": 1}, "time_step = 0"),
        ({"time_step": 1e-3, "steps": 0}, "steps = 0"),
        (
            {"time_step": 1e-3, "steps": 1, "solver": "magic"},
            "solver = 'magic' is unknown; allowed: compiled, lemke, exact",
        ),
        ({"time_step": 1e-3, "steps": 1, "positions": np.zeros(3)}, r"initial positions have shape \(3,\)"),
        ({"time_step": 1e-3, "steps": 1, "velocities": np.full(14, np.nan)}, "initial velocities = nan"),
    ],
)
def test_impossible_simulation_is_refused(arguments, message) -> None:
    with pytest.raises(ParameterError, match=message):
        simulate(Chain.from_ratios(), StillBase(), **arguments)


def test_chains_of_different_length_do_not_fit_one_batch() -> None:
    lanes = [Lane(Chain.from_ratios(cells=cells), StillBase(), 1e-3) for cells in (3, 4)]
    with pytest.raises(ParameterError, match=r"chains of \[3, 4\] cells"):
        CompiledSimulation(lanes)
