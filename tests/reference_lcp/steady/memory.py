"""Chains that remember: what their masses feel in a period depends on an internal state that the period changes."""

import dataclasses
from collections.abc import Callable

import numpy as np

from reference_lcp import Chain, CompiledSimulation, HarmonicBase, Lane, State, Trajectory

STEPS = 400


def chain_of(friction_ratio: float, damping_ratio: float) -> Chain:
    """Two cells with dashpots of one ratio between and within them."""
    ratios = {"damping_ratio": damping_ratio, "inner_damping_ratio": damping_ratio}
    return Chain.from_ratios(cells=2, friction_ratio=friction_ratio, **ratios)


def lanes_of(*frequency_ratios: float, damping_ratio: float = 0.1) -> tuple[Lane, ...]:
    chain = chain_of(0.3, damping_ratio)
    return tuple(Lane.periodic(chain, HarmonicBase.from_ratio(chain, eta), STEPS) for eta in frequency_ratios)


class RememberingChain:
    """A simulation of whole periods: each moves the lane that `felt` makes of the state, which `after` follows."""

    def __init__(
        self, lanes: tuple[Lane, ...], felt: Callable[[Lane, float], Lane], after: Callable[[float], float]
    ) -> None:
        self.lanes, self._felt, self._after = lanes, felt, after

    def advance(self, state: State, start: int, steps: int) -> State:
        for _ in range(steps // STEPS):
            state = State.stack([trajectory.end for trajectory in self.run(state, start, STEPS)])
        return state

    def run(self, state: State, start: int, steps: int) -> list[Trajectory]:
        assert (start, steps) == (0, STEPS)
        own = np.zeros(len(self.lanes)) if state.internal_state is None else state.internal_state[:, 0]
        felt = [self._felt(lane, value) for lane, value in zip(self.lanes, own.tolist(), strict=True)]
        trajectories = CompiledSimulation(felt).run(State(state.positions, state.velocities), start, steps)
        return [
            dataclasses.replace(one, internal_state=np.array([self._after(value)]))
            for one, value in zip(trajectories, own.tolist(), strict=True)
        ]

    def subset(self, lanes) -> "RememberingChain":
        return RememberingChain(tuple(self.lanes[lane] for lane in lanes), self._felt, self._after)

    def close(self) -> None: ...
