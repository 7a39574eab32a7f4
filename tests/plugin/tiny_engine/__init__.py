"""An engine in a package of its own: the semi-implicit Euler step with the friction of each cell clipped, in NumPy.

A worked example of what an engine's developer writes: a class with capabilities, a model that takes a
state in and gives a trajectory out, and one line in `pyproject.toml`.
"""

import numpy as np

from engines import Capabilities, Engine, Formulation, FrictionLaw, Preset
from reference_lcp import Lane, State, Trajectory
from reference_lcp.schemes.sequential import LaneModel, SequentialSimulation


class Tiny(Engine):
    """The example's engine."""

    name = "tiny"
    capabilities = Capabilities(
        title="Tiny",
        package="tiny-engine",
        licence="MIT",
        friction_law=FrictionLaw.COULOMB,
        presets={
            Formulation.JOINT: {"tuned": Preset("It has no options.", {}, shares_scheme=True, split_tolerance=0.0)}
        },
    )

    def version(self) -> str:
        """Version of the package."""
        return "1.2.3"

    def unavailable_reason(self) -> str | None:
        """It needs nothing but NumPy."""
        return None

    def _build(self, lanes: tuple[Lane, ...], formulation: Formulation, preset: Preset) -> SequentialSimulation:
        return SequentialSimulation([TinyLane(lane) for lane in lanes])


class TinyLane(LaneModel):
    """One chain."""

    def __init__(self, lane: Lane) -> None:
        self.lane = lane
        self._reduced_mass = 1 / (1 / lane.chain.outer_mass + 1 / lane.chain.inner_mass)

    def run(self, state: State, start: int, steps: int) -> Trajectory:
        """Advance from `state`."""
        rows = []
        x, v = state.positions[0].copy(), state.velocities[0].copy()
        for load in self.lane.loads(start, steps):
            v, friction = self._velocity_after(x, v, load)
            x = x + self.lane.time_step * v
            rows.append((x, v, friction))
        positions, velocities, forces = (np.array(column) for column in zip(*rows, strict=True))
        normal = self.lane.preloads(start, steps)
        return Trajectory(self.lane.times(start, steps), positions, velocities, forces, normal)

    def _velocity_after(self, x: np.ndarray, v: np.ndarray, load: float) -> tuple[np.ndarray, np.ndarray]:
        """Equation (5), with the closed solution of each cell's contact."""
        chain, dt = self.lane.chain, self.lane.time_step
        force = -chain.stiffness_matrix @ x - chain.damping_matrix @ v
        force[0] += load
        mass = np.diag(chain.mass_matrix)
        free = v + dt * force / mass
        stop = -self._reduced_mass * (chain.contact_directions.T @ free) / dt
        friction = np.clip(stop, -chain.friction_bound, chain.friction_bound)
        return free + dt * (chain.contact_directions @ friction) / mass, friction
