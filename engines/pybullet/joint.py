"""PyBullet's joint formulation: one tree of sliders, with a velocity motor of bounded force as dry friction."""

from collections.abc import Iterator

import numpy as np

from engines.interface.presets import NormalForce, Option, Preset
from engines.pybullet.connection import Connection, import_pybullet
from engines.pybullet.law import damped_joints
from engines.shared.coordinates import ChainCoordinates
from engines.shared.units import Units
from reference_lcp.chain.simulation import Lane
from reference_lcp.chain.trajectory import State, Trajectory
from reference_lcp.refusal import ParameterError
from reference_lcp.stepping.sequential import LaneModel
from reference_lcp.validation import FloatArray

JOINT_TUNED = Preset(
    "Motors that hold the relative velocity at zero with at most the friction bound, and no damping by Bullet.",
    {
        "units": Option("lane", "SI", "No number comes near Bullet's built-in smallest and largest ones."),
        "velocityGain": Option(1.0, 1.0, "The motor's share of the velocity that it removes in one step."),
        "outer motor force": Option(0.0, "large", "A new joint has a motor that locks it."),
        "linearDamping": Option(0.0, 0.04, "Bullet slows every body down, against the ground."),
        "maxJointVelocity": Option(1e30, 100.0, "Bullet cuts joint velocities off, whatever the units."),
    },
    shares_scheme=True,
    split_tolerance=1e-12,
    normal_force=NormalForce.MODULATED,
)

JOINT_DEFAULT = Preset(
    "Motors as dry friction in SI units, and Bullet's default options.",
    {
        "units": Option("SI", "SI", "The chain in SI units."),
        "velocityGain": Option(1.0, 1.0, "Bullet's own."),
        "outer motor force": Option(0.0, "large", "Needed: a new joint has a motor that locks it."),
        "linearDamping": Option(0.04, 0.04, "Bullet's own; it slows every body down, against the ground."),
        "maxJointVelocity": Option(100.0, 100.0, "Bullet's own."),
    },
    known_deviation=(
        "Bullet's damping, 0.04 /s of the velocity v and 0.04 /m of v |v|, slows every mass down against the ground, "
        "whatever the time step"
    ),
    law=damped_joints,
    split_tolerance=1e-12,
    normal_force=NormalForce.MODULATED,
    varied={"linearDamping": (0.0, 0.01, 0.02)},
)

MOST_CELLS = 63
"""Two joints a cell: PyBullet addresses fewer than 128 joints of a body."""


class PyBulletJointLane(LaneModel):
    """One chain; a run makes its bodies anew, so that nothing is left of earlier runs."""

    def __init__(self, connection: Connection, lane: Lane, preset: Preset):
        """Take the lane's parameters in its units."""
        cells = lane.chain.cells
        if cells > MOST_CELLS:
            raise ParameterError(f"cells = {cells} is outside what PyBullet takes; allowed: at most {MOST_CELLS}")
        self.lane = lane
        self._connection = connection
        self._preset = preset
        self._units = Units.named(preset["units"], lane)
        self._chain = self._units.scaled(lane.chain)
        self._time_step = lane.time_step / self._units.time
        self._forces = ChainCoordinates.CELLS.force_matrix(self._chain)

    def run(self, state: State, start: int, steps: int) -> Trajectory:
        """Advance from `state`; see `LaneModel.run`."""
        cells, units = self._chain.cells, self._units
        rows = self._rows(state, start, steps)
        position, velocity, friction = np.split(rows, [2 * cells, 4 * cells], axis=1)
        normal = self.lane.preloads(start, steps)
        # Of a motor that may do nothing in a step Bullet reports what it did in an earlier one.
        friction[normal == 0] = 0.0
        return Trajectory(
            self.lane.times(start, steps),
            ChainCoordinates.CELLS.absolute(position) * units.length,
            ChainCoordinates.CELLS.absolute(velocity) * units.velocity,
            friction * units.force,
            normal,
        )

    def native_steps(self, steps: int) -> None:
        """Take steps of Bullet alone, from rest; see `NativeStepping`."""
        body = self._new_body(*np.zeros((2, 2 * self._chain.cells)))
        self._connection.native_steps(steps)
        import_pybullet().removeBody(body, physicsClientId=self._connection.client)

    def close(self) -> None:
        """Close the connection that this lane shares with the others of its simulation."""
        self._connection.close()

    def _rows(self, state: State, start: int, steps: int) -> FloatArray:
        """Give coordinates, their velocities and friction of every step, shape (steps, 5n)."""
        bullet, client = import_pybullet(), self._connection.client
        coordinates = ChainCoordinates.CELLS.of(state.positions[0] / self._units.length)
        velocities = ChainCoordinates.CELLS.of(state.velocities[0] / self._units.velocity)
        body = self._new_body(coordinates, velocities)
        cells = self._chain.cells
        links = _links(cells)
        rows: list[list[float]] = []
        now = np.concatenate([coordinates, velocities])
        torque = np.empty(2 * cells)
        bounds = self._changing_bounds(start, steps)
        for load in self.lane.loads(start, steps) / self._units.force:
            if bounds is not None:
                self._set_bounds(body, links[cells:], next(bounds))
            np.dot(self._forces, now, out=torque)
            torque[0] += load
            bullet.setJointMotorControlArray(
                body, links, bullet.TORQUE_CONTROL, forces=torque.tolist(), physicsClientId=client
            )
            bullet.stepSimulation(physicsClientId=client)
            joints = bullet.getJointStates(body, links, physicsClientId=client)
            after = [joint[0] for joint in joints] + [joint[1] for joint in joints]
            now[:] = after
            rows.append(after + [joint[3] for joint in joints[cells:]])
        bullet.removeBody(body, physicsClientId=client)
        return np.array(rows)

    def _changing_bounds(self, start: int, steps: int) -> Iterator[list[float]] | None:
        """Give the friction bounds of every step where they change."""
        if self.lane.preload is None:
            return None
        bounds = self.lane.chain.friction_coefficient * self.lane.preloads(start, steps) / self._units.force
        return iter(bounds.tolist())

    def _set_bounds(self, body: int, links: list[int], bounds: list[float]) -> None:
        """Set what the motors of these links can do at most."""
        bullet, still = import_pybullet(), [0.0] * len(links)
        bullet.setJointMotorControlArray(
            body, links, bullet.VELOCITY_CONTROL, targetVelocities=still, forces=bounds,
            velocityGains=[self._preset["velocityGain"]] * len(links), physicsClientId=self._connection.client,
        )  # fmt: skip

    def _new_body(self, coordinates: FloatArray, velocities: FloatArray) -> int:
        """Make the chain and set its state; motors last, for Bullet stores their bounds times the time step."""
        bullet, client = import_pybullet(), self._connection.client
        bullet.setTimeStep(self._time_step, physicsClientId=client)
        body = _new_tree(self._chain.outer_mass, self._chain.inner_mass, client)
        preset = self._preset
        bullet.changeDynamics(
            body, -1, linearDamping=preset["linearDamping"], maxJointVelocity=preset["maxJointVelocity"],
            physicsClientId=client,
        )  # fmt: skip
        cells = self._chain.cells
        links = _links(cells)
        bullet.resetJointStatesMultiDof(
            body, links, coordinates[:, None].tolist(), velocities[:, None].tolist(), physicsClientId=client
        )
        self._set_bounds(body, links, [preset["outer motor force"]] * cells + self._chain.friction_bound.tolist())
        return body


def _new_tree(outer_mass: FloatArray, inner_mass: FloatArray, client: int) -> int:
    """Create a fixed base, on it n sliding outer masses, on each an inner mass that slides relative to it."""
    bullet = import_pybullet()
    cells = outer_mass.shape[0]
    masses = np.stack([outer_mass, inner_mass], axis=1).ravel().tolist()
    links = 2 * cells
    nowhere, upright = [0.0, 0.0, 0.0], [0.0, 0.0, 0.0, 1.0]
    body: int = bullet.createMultiBody(
        baseMass=0,
        linkMasses=masses,
        # Parent 0 is the base, k + 1 is link k; Bullet numbers links depth first: outer 2i, inner 2i + 1.
        linkParentIndices=[parent for cell in range(cells) for parent in (0, 2 * cell + 1)],
        linkJointTypes=[bullet.JOINT_PRISMATIC] * links,
        linkJointAxis=[[1.0, 0.0, 0.0]] * links,
        linkCollisionShapeIndices=[-1] * links,
        linkVisualShapeIndices=[-1] * links,
        linkPositions=[nowhere] * links,
        linkOrientations=[upright] * links,
        linkInertialFramePositions=[nowhere] * links,
        linkInertialFrameOrientations=[upright] * links,
        physicsClientId=client,
    )
    return body


def _links(cells: int) -> list[int]:
    """Links of the outer masses, then of the inner ones."""
    return [*range(0, 2 * cells, 2), *range(1, 2 * cells, 2)]
