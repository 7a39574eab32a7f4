"""The reference as an engine: the Euler scheme of equation (5), compiled."""

import dataclasses
import importlib.metadata
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from engines.interface.engine import Engine
from engines.interface.presets import Capabilities, Formulation, FrictionLaw, NormalForce, Option, Preset
from reference_lcp.chain.simulation import Lane, Simulation
from reference_lcp.chain.trajectory import State, Trajectory
from reference_lcp.stepping.euler_compiled import CompiledSimulation
from reference_lcp.validation import checked_count

CONVERGED_SUBSTEPS = 32
"""Euler steps to one step of the lane in the preset ``converged``.

The scheme is of first order: at 400 steps a period its error reaches 0.2 dB on the steepest flanks
of figure 3, at 32 times as many 0.006 dB, far below every tolerance that is compared with it.
"""


class Reference(Engine):
    """The LCP scheme that every other engine is compared with."""

    name = "reference"
    capabilities = Capabilities(
        title="Reference (LCP)",
        package="multibody-xval",
        licence="MIT",
        friction_law=FrictionLaw.COULOMB,
        presets={
            Formulation.JOINT: {
                "tuned": Preset(
                    "The scheme of equation (5), one Euler step a time step.",
                    shares_scheme=True,
                    normal_force=NormalForce.LIFTING,
                ),
                "converged": Preset(
                    "The same scheme with a finer Euler step: the ruler for every engine.",
                    {
                        "substeps": Option(
                            CONVERGED_SUBSTEPS, 1, "brings the scheme's own first-order error below 0.01 dB"
                        )
                    },
                    normal_force=NormalForce.LIFTING,
                ),
            }
        },
        batch_lanes=64,
        notes="Exact Coulomb friction by a linear complementarity problem in each step; first order in the time step.",
    )

    def version(self) -> str:
        """Version of this suite."""
        return importlib.metadata.version("multibody-xval")

    def unavailable_reason(self) -> str | None:
        """The reference is always there."""
        return None

    def _build(self, lanes: tuple[Lane, ...], formulation: Formulation, preset: Preset) -> Simulation:
        if "substeps" not in preset.options:
            return CompiledSimulation(lanes)
        return RefinedSimulation(lanes, preset["substeps"])


class RefinedSimulation:
    """The compiled scheme with a whole number of Euler steps to each time step of the lanes.

    Parameters
    ----------
    lanes
        As for every simulation; rows of trajectories are at their time steps.
    substeps
        Euler steps to one time step.
    """

    def __init__(self, lanes: Sequence[Lane], substeps: int):
        self.lanes = tuple(lanes)
        self._substeps = checked_count("substeps", substeps)
        self._fine = CompiledSimulation(
            [dataclasses.replace(lane, time_step=lane.time_step / substeps) for lane in self.lanes]
        )

    def run(self, state: State, start: int, steps: int) -> list[Trajectory]:
        """Advance every lane, one at a time: fine trajectories of many lanes would fill the memory."""
        found = []
        for lane in range(len(self.lanes)):
            fine = self._fine.subset([lane])
            every = fine.run(state.subset([lane]), start * self._substeps, steps * self._substeps)[0]
            found.append(self._thinned(every, self.lanes[lane], start, steps))
        return found

    def advance(self, state: State, start: int, steps: int) -> State:
        """Advance every lane, keep the final state; see `Simulation.advance`."""
        return self._fine.advance(state, start * self._substeps, steps * self._substeps)

    def subset(self, lanes: Sequence[int] | NDArray[np.intp]) -> "RefinedSimulation":
        """Give the lanes of these indices."""
        part = RefinedSimulation.__new__(RefinedSimulation)
        part.lanes = tuple(self.lanes[lane] for lane in lanes)
        part._substeps = self._substeps
        part._fine = self._fine.subset(lanes)
        return part

    def close(self) -> None:
        """Nothing is held outside Python."""

    def _thinned(self, fine: Trajectory, lane: Lane, start: int, steps: int) -> Trajectory:
        """Keep the last Euler step of each time step."""
        kept = slice(self._substeps - 1, None, self._substeps)
        return Trajectory(
            lane.times(start, steps),
            fine.positions[kept].copy(),
            fine.velocities[kept].copy(),
            fine.friction[kept].copy(),
            fine.normal_force[kept].copy(),
            fine.memory,
            None if fine.normal_gap is None else fine.normal_gap[kept].copy(),
        )
