"""The scheme of equation (5): Lemke and the compiled closed form, and motions known in closed form."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from reference_lcp import (
    Chain,
    CompiledSimulation,
    HarmonicBase,
    Lane,
    ParameterError,
    State,
    StillBase,
    simulate,
)
from reference_lcp.schemes.euler import LemkeSimulation
from tests.reference_lcp.cases import random_chain

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


@settings(max_examples=25, deadline=None)
@given(st.integers(0, 10**6), st.sampled_from([1, 2, 5, 8, 9, 19, 67]), st.integers(1, 80))
def test_a_chain_moves_bitwise_alone_as_beside_others(seed, lanes, cells) -> None:
    """Alone it advances eight of its cells at once, beside seven others or more one of them.

    Parameters of equal cells, as in every second lane, are read from one row, beside others from a row of each cell.
    """
    rng = np.random.default_rng(seed)
    drives = [HarmonicBase(0.01, rng.uniform(5, 60)) for _ in range(lanes)]
    chains = [Chain.from_ratios(cells=cells, friction_ratio=0.3), random_chain(rng, cells)] * lanes
    batch = [Lane.periodic(chain, drive, 400) for chain, drive in zip(chains, drives, strict=False)]
    state = State(rng.normal(0, 0.01, (lanes, 2 * cells)), rng.normal(0, 0.1, (lanes, 2 * cells)))
    together = CompiledSimulation(batch)
    ends, trajectories = together.advance(state, 3, 50), together.run(state, 3, 50)
    for lane in {0, lanes // 2, lanes - 1}:
        alone = together.subset([lane]).run(state.subset([lane]), 3, 50)[0]
        for name in ("positions", "velocities", "friction"):
            assert np.array_equal(getattr(alone, name), getattr(trajectories[lane], name))
        assert np.array_equal(alone.end.positions[0], ends.positions[lane])
        assert np.array_equal(alone.end.velocities[0], ends.velocities[lane])


def lanes_of(*cells: int) -> list[Lane]:
    return [Lane(Chain.from_ratios(cells=count), StillBase(), 1e-3) for count in cells]


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (lambda: still(time_step=0.0), "time_step = 0"),
        (lambda: still(steps=0), "steps = 0"),
        (lambda: still(solver="magic"), "solver = 'magic' is unknown; allowed: compiled, lemke, exact"),
        (lambda: still(positions=np.zeros(3)), r"initial positions have shape \(3,\)"),
        (lambda: still(velocities=np.full(14, np.nan)), "initial velocities = nan"),
        (lambda: CompiledSimulation(lanes_of(3, 4)), r"chains of \[3, 4\] cells"),
    ],
)
def test_impossible_simulation_is_refused(make, message) -> None:
    with pytest.raises(ParameterError, match=message):
        make()


def still(**arguments):
    return simulate(Chain.from_ratios(), StillBase(), **({"time_step": 1e-3, "steps": 1} | arguments))
