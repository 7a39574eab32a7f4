"""Batches of lanes that are advanced one lane after the other."""

from abc import ABC, abstractmethod
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from reference_lcp.chain.simulation import Lane
from reference_lcp.chain.trajectory import State, Trajectory
from reference_lcp.validation import checked_count


class LaneModel(ABC):
    """One lane, built and ready to be advanced."""

    lane: Lane

    @abstractmethod
    def run(self, state: State, start: int, steps: int) -> Trajectory:
        """Advance from `state`, a batch of this one lane, at step index `start`."""

    def advance(self, state: State, start: int, steps: int) -> State:
        """Advance as `run` does and give the end only; models override it where that costs less."""
        return self.run(state, start, steps).end

    def close(self) -> None:
        """Free what is held for this lane."""
        return


class SequentialSimulation:
    """A `Simulation` made of one `LaneModel` a lane, in `models`."""

    def __init__(self, models: Sequence[LaneModel]):
        self.models = tuple(models)
        self.lanes = tuple(model.lane for model in self.models)

    def run(self, state: State, start: int, steps: int) -> list[Trajectory]:
        """Advance every lane; see `Simulation.run`."""
        checked_count("steps", steps)
        state.check_fits(len(self.lanes), self.lanes[0].chain.freedoms)
        return [model.run(state.subset([lane]), start, steps) for lane, model in enumerate(self.models)]

    def advance(self, state: State, start: int, steps: int) -> State:
        """Advance every lane, keep the final state; see `Simulation.advance`."""
        checked_count("steps", steps)
        state.check_fits(len(self.lanes), self.lanes[0].chain.freedoms)
        return State.stack(
            [model.advance(state.subset([lane]), start, steps) for lane, model in enumerate(self.models)]
        )

    def subset(self, lanes: Sequence[int] | NDArray[np.intp]) -> "SequentialSimulation":
        """Give the lanes of these indices; they share the models."""
        return SequentialSimulation([self.models[lane] for lane in lanes])

    def close(self) -> None:
        """Free every lane."""
        for model in self.models:
            model.close()
