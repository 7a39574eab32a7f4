"""An engine in a package of its own: the semi-implicit Euler step with the friction of each cell clipped, in NumPy.

A worked example of what an engine's developer writes: options and presets, a class with capabilities, a model that
takes a state in and gives a trajectory out, and one line in `pyproject.toml`.
"""

import numpy as np

import multibody_xval as xval

OPTIONS = {"compliance": xval.Option.own(1e-3, "part of the slip velocity that a stuck contact keeps in each step [-]")}

TUNED = xval.Preset(
    "Contacts stick without any creep.",
    OPTIONS,
    changes={"compliance": (0.0, "a contact that its friction can hold does not move")},
    shares_scheme=True,  # it is the reference's own step: the reference predicts it
)
DEFAULT = xval.Preset(
    "As the engine comes.",
    OPTIONS,
    residual_slip_compliance=1e-3,
    known_deviation="a stuck contact creeps by a thousandth of what it would slip",
)


class Tiny(xval.Engine):
    """The example's engine."""

    name = "tiny"
    capabilities = xval.Capabilities(
        title="Tiny",
        package="tiny-engine",
        licence="MIT",
        friction_law=xval.FrictionLaw.COULOMB,
        presets={xval.Formulation.JOINT: {"tuned": TUNED, "default": DEFAULT}},
    )

    def version(self) -> str:
        """Version of the package."""
        return "1.2.3"

    def unavailable_reason(self) -> str | None:
        """It needs nothing but NumPy."""
        return None

    def _build(
        self, lanes: tuple[xval.Lane, ...], formulation: xval.Formulation, preset: xval.Preset
    ) -> xval.SequentialSimulation:
        return xval.SequentialSimulation([TinyLane(lane, preset) for lane in lanes])


class TinyLane(xval.LaneModel):
    """One chain."""

    def __init__(self, lane: xval.Lane, preset: xval.Preset) -> None:
        self.lane = lane
        self._held = 1 - preset["compliance"]
        self._reduced_mass = 1 / (1 / lane.chain.outer_mass + 1 / lane.chain.inner_mass)

    def run(self, state: xval.State, start: int, steps: int) -> xval.Trajectory:
        """Advance from `state`."""
        rows = []
        x, v = state.positions[0].copy(), state.velocities[0].copy()
        for load in self.lane.loads(start, steps):
            v, friction = self._velocity_after(x, v, load)
            x = x + self.lane.time_step * v
            rows.append((x, v, friction))
        positions, velocities, forces = (np.array(column) for column in zip(*rows, strict=True))
        normal = self.lane.preloads(start, steps)
        return xval.Trajectory(self.lane.times(start, steps), positions, velocities, forces, normal)

    def _velocity_after(self, x: np.ndarray, v: np.ndarray, load: float) -> tuple[np.ndarray, np.ndarray]:
        """Equation (5), with the closed solution of each cell's contact."""
        chain, dt = self.lane.chain, self.lane.time_step
        force = -chain.stiffness_matrix @ x - chain.damping_matrix @ v
        force[0] += load
        mass = np.diag(chain.mass_matrix)
        free = v + dt * force / mass
        stop = -self._held * self._reduced_mass * (chain.contact_directions.T @ free) / dt
        friction = np.clip(stop, -chain.friction_bound, chain.friction_bound)
        return free + dt * (chain.contact_directions @ friction) / mass, friction
