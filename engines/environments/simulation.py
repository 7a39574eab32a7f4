"""Lanes in the worker process of an environment, as one simulation."""

import pickle
from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from engines.environments.process import FIRST_USE_LIMIT
from engines.out_of_process.built import REQUEST_LIMIT, STEP_LIMIT, Built
from engines.out_of_process.process import EngineProcess
from reference_lcp.chain.simulation import Lane, Simulation
from reference_lcp.chain.trajectory import State, Trajectory
from reference_lcp.validation import checked_count


class EnvironmentSimulation(Simulation):
    """A simulation that the adapter builds in another process, and that is called there.

    Parameters
    ----------
    process
        The worker process; see `engines.environments.process`.
    lanes
        The lanes.
    formulation, preset
        Names, as `Engine.build` takes them.
    """

    def __init__(self, process: EngineProcess, lanes: Sequence[Lane], formulation: str, preset: str):
        self.lanes = tuple(lanes)
        self._process = process
        self._options = formulation, preset
        self._built = Built(process, {"pickled": _pickled(self.lanes, *self._options)}, FIRST_USE_LIMIT)

    def run(self, state: State, start: int, steps: int) -> list[Trajectory]:
        """Advance every lane; see `Simulation.run`."""
        trajectories: list[Trajectory] = self._call(steps, "run", state, start, steps)
        return trajectories

    def advance(self, state: State, start: int, steps: int) -> State:
        """Advance every lane, keep the final state; see `Simulation.advance`."""
        end: State = self._call(steps, "advance", state, start, steps)
        return end

    def native_steps(self, steps: int) -> None:
        """Take steps of the engine alone, in one request; see `engines.interface.engine.NativeStepping`."""
        self._call(steps, "native_steps", steps)

    def subset(self, lanes: Sequence[int] | NDArray[np.intp]) -> "EnvironmentSimulation":
        """Give the lanes of these indices, built anew."""
        return EnvironmentSimulation(self._process, [self.lanes[lane] for lane in lanes], *self._options)

    def close(self) -> None:
        """Let the worker drop the lanes."""
        self._built.close()

    def _call(self, steps: int, method: str, *arguments: Any) -> Any:
        limit = REQUEST_LIMIT + STEP_LIMIT * checked_count("steps", steps) * len(self.lanes)
        reply = self._built.request("call", limit, pickled=_pickled(method, *arguments))
        return pickle.loads(reply["pickled"].tobytes())


def _pickled(*values: Any) -> NDArray[np.uint8]:
    return np.frombuffer(pickle.dumps(values), np.uint8)
