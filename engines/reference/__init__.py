"""The reference as an engine: the Euler scheme of equation (5), compiled, and the exact motion."""

import dataclasses
from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from engines.interface.engine import Engine
from engines.interface.presets import Capabilities, Formulation, FrictionLaw, NormalForce, Option, Preset
from engines.reference.law import authority
from engines.shared.wheel_engine import installed_version
from reference_lcp.chain.simulation import Lane, Simulation
from reference_lcp.chain.trajectory import State, Trajectory
from reference_lcp.exact.event_driven import EventDrivenSimulation
from reference_lcp.one_call import SteadyState, exact_steady_state
from reference_lcp.stepping.euler_compiled import CompiledSimulation
from reference_lcp.validation import checked_count

EXACT = "exact"
"""Name of the preset without a time step."""

SERIES_ROUND_OFF = 1e-12
"""Split tolerance of the exact motion: a run that is split begins another power series there, with sums of some thirty
terms in another order: thirty roundings a step, of a motion of a few displacement scales, over 100 steps."""

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
                    "The same scheme with a finer Euler step: the baseline for every engine.",
                    {
                        "substeps": Option(
                            CONVERGED_SUBSTEPS, 1, "brings the scheme's own first-order error below 0.01 dB"
                        )
                    },
                    law=authority,
                    normal_force=NormalForce.LIFTING,
                ),
                EXACT: Preset(
                    "The motion between events in closed form, without a time step; for harmonic drives or none.",
                    law=authority,
                    split_tolerance=SERIES_ROUND_OFF,
                    batch_lanes=1,
                    optional=True,
                ),
            }
        },
        batch_lanes=64,
        notes="Exact Coulomb friction by a linear complementarity problem in each step; first order in the time step.",
    )

    def version(self) -> str:
        """Version of this suite."""
        return installed_version("multibody-xval")

    def unavailable_reason(self) -> str | None:
        """The reference is always there."""
        return None

    def _build(self, lanes: tuple[Lane, ...], formulation: Formulation, preset: Preset) -> Simulation:
        if preset is self.capabilities.presets[formulation][EXACT]:
            return ExactSimulation(lanes)
        if "substeps" not in preset.options:
            return CompiledSimulation(lanes)
        return RefinedSimulation(lanes, preset["substeps"])


class ExactSimulation(EventDrivenSimulation):
    """The event-driven simulation, whose steady states are polished by Newton's method and read from their events."""

    def steady_states(self, steps_per_period: int) -> list[SteadyState]:
        """Give the steady state of every lane; see `SteadyStateSolver`."""
        drives: list[Any] = [lane.drive for lane in self.lanes]  # periodic ones
        return [
            exact_steady_state(lane.chain, drive, steps_per_period=steps_per_period)
            for lane, drive in zip(self.lanes, drives, strict=True)
        ]


class RefinedSimulation:
    """The compiled scheme with a whole number of Euler steps to each time step of the lanes.

    Parameters
    ----------
    lanes
        As for every simulation; rows of trajectories are at their time steps.
    substeps
        Euler steps to one time step.
    fine
        The lanes with these Euler steps, where they are built already.
    """

    def __init__(self, lanes: Sequence[Lane], substeps: int, fine: CompiledSimulation | None = None):
        self.lanes = tuple(lanes)
        self._substeps = checked_count("substeps", substeps)
        self._fine = fine or CompiledSimulation(
            [dataclasses.replace(lane, time_step=lane.time_step / substeps) for lane in self.lanes]
        )

    def run(self, state: State, start: int, steps: int) -> list[Trajectory]:
        """Advance every lane, one at a time: fine trajectories of many lanes would fill the memory."""
        trajectories = []
        for lane in range(len(self.lanes)):
            fine = self._fine.subset([lane])
            every = fine.run(state.subset([lane]), start * self._substeps, steps * self._substeps)[0]
            trajectories.append(self._thinned(every, self.lanes[lane], start, steps))
        return trajectories

    def advance(self, state: State, start: int, steps: int) -> State:
        """Advance every lane, keep the final state; see `Simulation.advance`."""
        return self._fine.advance(state, start * self._substeps, steps * self._substeps)

    def subset(self, lanes: Sequence[int] | NDArray[np.intp]) -> "RefinedSimulation":
        """Give the lanes of these indices."""
        return RefinedSimulation([self.lanes[lane] for lane in lanes], self._substeps, self._fine.subset(lanes))

    def close(self) -> None:
        """Nothing is held outside Python."""

    def _thinned(self, fine: Trajectory, lane: Lane, start: int, steps: int) -> Trajectory:
        """Keep the last Euler step of each time step."""
        last = slice(self._substeps - 1, None, self._substeps)
        return Trajectory(
            lane.times(start, steps),
            fine.positions[last].copy(),
            fine.velocities[last].copy(),
            fine.friction[last].copy(),
            fine.normal_force[last].copy(),
            fine.internal_state,
            None if fine.normal_gap is None else fine.normal_gap[last].copy(),
        )
