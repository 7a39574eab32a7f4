"""PyBullet's contact formulation: in every cell a box, the inner mass, pressed on a plate, the outer one.

A box that is pulled off flies away from its plate and the plate from the box, for nothing guides them: the gap opens
as if the reduced mass m_o m_i / (m_o + m_i) flew. That is a factor on the gap alone: when the masses meet again,
∬ N dt dt = 0, and the impulse with which they do, ∫ N dt, do not depend on the mass that flies. States and
trajectories hold the gap over a guided plate, on which m_i flies.
"""

import itertools
from collections.abc import Iterable, Sequence
from typing import Any

import numpy as np

from engines.interface.presets import NormalForce, Option, Preset
from engines.pybullet.connection import Connection, import_pybullet
from engines.pybullet.law import damped_bodies
from engines.shared.box_geometry import BOX, PressedBoxes
from engines.shared.coordinates import ChainCoordinates
from engines.shared.units import Units, power_of_two
from reference_lcp.chain.simulation import Lane
from reference_lcp.chain.trajectory import State, Trajectory
from reference_lcp.refusal import ParameterError
from reference_lcp.stepping.sequential import LaneModel
from reference_lcp.validation import FloatArray, checked_count

CONTACT_TUNED = Preset(
    "Boxes without rotation or damping, and a contact solver that never stops early: it then equals equation (5).",
    {
        "units": Option("lane", "SI", "No number comes near Bullet's built-in smallest and largest ones."),
        "localInertiaDiagonal": Option((0.0, 0.0, 0.0), "of the box", "Bullet takes zero for infinite: no rotation."),
        "linearDamping": Option(0.0, 0.04, "Bullet slows every body down, against the ground."),
        "solverResidualThreshold": Option(0.0, 1e-7, "The solver stops early otherwise, and stuck contacts creep."),
    },
    shares_scheme=True,
    split_tolerance=1e-12,
    normal_force=NormalForce.LIFTING,
    turns=True,
)

CONTACT_DEFAULT = Preset(
    "The same boxes in SI units, with Bullet's own damping and its own solver.",
    {
        "units": Option("SI", "SI", "The chain in SI units."),
        "localInertiaDiagonal": Option((0.0, 0.0, 0.0), "of the box", "Needed: the chain moves along a line."),
        "linearDamping": Option(0.04, 0.04, "Bullet's own; it slows every body down, against the ground."),
        "solverResidualThreshold": Option(1e-7, 1e-7, "Bullet's own; below it the solver stops."),
    },
    known_deviation=(
        "Bullet's linear damping, 0.04 a second, slows every mass down against the ground, whatever the time step"
    ),
    law=damped_bodies,
    split_tolerance=1e-12,
    normal_force=NormalForce.LIFTING,
    turns=True,
)

REST_DEPTH = 1e-5
"""Penetration that Bullet leaves alone, its contactSlop; at zero depth, round-off would lose a contact now and then."""

PLATE = 2.0**20
"""Half of a plate's length over the displacement scale; beyond, boxes would fall off."""

SPACING = 8 * BOX
"""Distance of neighbouring cells over the displacement scale, across the motion."""

POSITION_TOLERANCE = 1e-9
"""Difference from Bullet's positions at the end of a run, over the displacement scale.

It is zero where both round alike; a machine that fuses multiplication and addition leaves a round-off a step.
"""

LARGEST_COEFFICIENT = 10.0
"""Bullet cuts larger coefficients of friction off."""


class PyBulletContactLane(LaneModel):
    """One chain; a run makes its bodies anew, at the static equilibrium of their contacts.

    Outer and inner mass press each other with λ_N, an internal pair of forces, so that nothing needs a guide.
    """

    def __init__(self, connection: Connection, lane: Lane, preset: Preset):
        """Take the lane's parameters in its units."""
        largest = float(np.max(lane.chain.friction_coefficient))
        if largest > LARGEST_COEFFICIENT:
            raise ParameterError(
                f"friction_coefficient = {largest:g}; allowed by Bullet: at most {LARGEST_COEFFICIENT:g}"
            )
        self.lane = lane
        self._connection = connection
        self._preset = preset
        self._units = Units.named(preset["units"], lane)
        self._chain = self._units.scaled(lane.chain)
        self._forces = ChainCoordinates.ABSOLUTE.force_matrix(self._chain)
        self._pressing = np.concatenate([self._chain.normal_force, -self._chain.normal_force]).tolist()
        # Gap of free bodies over the gap that the inner mass alone would make.
        self._opening = 1 + self._chain.inner_mass / self._chain.outer_mass
        # Powers of two: distances of contacts are then exact.
        self._scale = power_of_two(lane.drive.displacement_scale(lane.chain)) / self._units.length

    def run(self, state: State, start: int, steps: int) -> Trajectory:
        """Advance from `state`; see `LaneModel.run`."""
        units = self._units
        rows, end = self._rows(state, start, steps, record=True)
        cells = self._chain.cells
        position, velocity, friction, normal, gap = np.split(rows, np.cumsum([2, 2, 1, 1]) * cells, axis=1)
        return Trajectory(
            self.lane.times(start, steps),
            position * units.length,
            velocity * units.velocity,
            friction * units.force,
            normal * units.force,
            end,
            gap * units.length if self.lane.opens else None,
        )

    def advance(self, state: State, start: int, steps: int) -> State:
        """Advance as `run` does, without reading the contacts."""
        rows, end = self._rows(state, start, steps, record=False)
        position, velocity = np.split(rows, 2, axis=1)
        return self._units.state(position, velocity, end)

    def native_steps(self, steps: int) -> None:
        """Take steps of Bullet alone, from rest; see `NativeStepping`."""
        self._new_bodies(np.zeros(4 * self._chain.cells), np.zeros((2, self._chain.cells)))
        self._connection.native_steps(steps)

    def close(self) -> None:
        """Close the connection that this lane shares with the others of its simulation."""
        self._connection.close()

    def _rows(self, state: State, start: int, steps: int, record: bool) -> tuple[FloatArray, FloatArray | None]:
        """Give motion, friction, normal force and, where it opens, gap of every step, or the motion of the last only.

        The second is the internal state at the end.
        """
        checked_count("steps", steps)
        now = np.concatenate([state.positions[0] / self._units.length, state.velocities[0] / self._units.velocity])
        bodies = self._new_bodies(now, self._units.gaps(self.lane, state))
        position, velocity = np.split(now, 2)
        time_step = self.lane.time_step / self._units.time
        rows: list[list[float]] = []
        loads = (self.lane.loads(start, steps) / self._units.force).tolist()
        for load, pressing in zip(loads, self._pressings(start, steps), strict=True):
            velocity[:] = self._step(bodies, now, load, pressing)
            # Bullet's own step, compared in `_check_end`: reading positions too would take as long as its solver.
            position += time_step * velocity
            if record:
                gap = self._gaps(bodies)[0].tolist() if self.lane.opens else []
                rows.append(now.tolist() + self._contact_forces(bodies) + gap)
        self._check_end(bodies, position)
        end = self._units.normal_state(*self._gaps(bodies)) if self.lane.opens else None
        return np.array(rows) if record else now[None], end

    def _pressings(self, start: int, steps: int) -> Iterable[list[float]]:
        """Give the forces across the motion on every mass, outer ones first, of every step."""
        if self.lane.preload is None:
            return itertools.repeat(self._pressing, steps)
        normal_load = self.lane.preloads(start, steps) / self._units.force
        return iter(np.hstack([normal_load, -normal_load]).tolist())

    def _step(self, bodies: list[int], now: FloatArray, load: float, pressing: list[float]) -> list[float]:
        """Apply the forces of springs, dashpots, drive and pressing, take a step; give the velocities after it."""
        bullet, client = import_pybullet(), self._connection.client
        force = self._forces @ now
        force[0] += load
        apply, frame, nowhere = bullet.applyExternalForce, bullet.LINK_FRAME, (0.0, 0.0, 0.0)
        x, y = self.lane.axis
        for body, along, across in zip(bodies, force.tolist(), pressing, strict=True):
            apply(body, -1, (x * along, y * along, across), nowhere, frame, physicsClientId=client)
        bullet.stepSimulation(physicsClientId=client)
        read = bullet.getBaseVelocity
        return [self._along(read(body, physicsClientId=client)[0]) for body in bodies]

    def _along(self, vector: Sequence[float]) -> float:
        """Give the part along the row of a vector in the world."""
        x, y = self.lane.axis
        return x * vector[0] + y * vector[1] if y else vector[0]

    def _gaps(self, bodies: list[int]) -> FloatArray:
        """Read the gap, and its rate, as the inner mass alone would make them; shape (2, n)."""
        bullet, client, box = import_pybullet(), self._connection.client, BOX * self._scale
        heights = [bullet.getBasePositionAndOrientation(body, physicsClientId=client)[0][2] for body in bodies]
        speeds = [bullet.getBaseVelocity(body, physicsClientId=client)[0][2] for body in bodies]
        outer, inner = np.split(np.array([heights, speeds]), 2, axis=1)
        # At rest a box is as deep as Bullet leaves alone, see `_new_bodies`.
        return (inner - outer - [[2 * box - REST_DEPTH], [0.0]]) / self._opening

    def _contact_forces(self, bodies: list[int]) -> list[float]:
        """Friction on every inner mass, then every normal force: sums over the points of a contact."""
        bullet, client = import_pybullet(), self._connection.client
        friction, normal = [], []
        cells = self._chain.cells
        for outer, inner in zip(bodies[:cells], bodies[cells:], strict=True):
            points = bullet.getContactPoints(inner, outer, physicsClientId=client)
            # A point has its normal force at 9, then twice a tangential force and the direction it acts in on
            # the outer mass.
            friction.append(
                -sum(point[10] * self._along(point[11]) + point[12] * self._along(point[13]) for point in points)
            )
            normal.append(float(sum(point[9] for point in points)))
        return friction + normal

    def _new_bodies(self, motion: FloatArray, across: FloatArray) -> list[int]:
        """Empty the world, and make all plates, then all boxes, with their motion along the row and across it.

        `across` holds the gap and its rate as the inner mass alone would make them, shape (2, n).
        """
        bullet, client, preset = import_pybullet(), self._connection.client, self._preset
        bullet.resetSimulation(physicsClientId=client)
        bullet.setTimeStep(self.lane.time_step / self._units.time, physicsClientId=client)
        bullet.setPhysicsEngineParameter(
            solverResidualThreshold=preset["solverResidualThreshold"], contactSlop=REST_DEPTH, physicsClientId=client
        )
        chain, box = self._chain, BOX * self._scale
        length = PLATE * self._scale
        plate, cube = (
            bullet.createCollisionShape(bullet.GEOM_BOX, halfExtents=sizes, physicsClientId=client)
            for sizes in ([length, length if self.lane.direction else box, box], [box] * 3)
        )
        # At the static equilibrium a contact is as deep as Bullet leaves alone.
        height = box - REST_DEPTH
        positions, velocities = np.split(motion, 2)
        bodies, (x, y) = [], self.lane.axis
        for mass in range(2 * chain.cells):
            side, cell = divmod(mass, chain.cells)
            along, aside = float(positions[mass]), cell * SPACING * self._scale
            place = [x * along, y * along + aside, height if side else -box]
            weight = float((chain.inner_mass if side else chain.outer_mass)[cell])
            # Bullet multiplies the coefficients of the two bodies.
            friction = float(chain.friction_coefficient[cell]) if side else 1.0
            bodies.append(self._new_body(cube if side else plate, weight, friction, place))
        # Bullet takes over a new inertia at the end of a step only: let one pass at rest.
        bullet.stepSimulation(physicsClientId=client)
        # The inner mass moves as it would alone; the plate the other way, for both are pulled alike.
        rises, speeds = np.hstack([-across * chain.inner_mass / chain.outer_mass, across]).tolist()
        for body, velocity, rise, speed in zip(bodies, velocities.tolist(), rises, speeds, strict=True):
            if self.lane.opens:
                (along, aside, rest), turned = bullet.getBasePositionAndOrientation(body, physicsClientId=client)
                bullet.resetBasePositionAndOrientation(
                    body, [along, aside, rest + rise], turned, physicsClientId=client
                )
            bullet.resetBaseVelocity(body, [x * velocity, y * velocity, speed], [0.0] * 3, physicsClientId=client)
        return bodies

    def _new_body(self, shape: Any, mass: float, friction: float, place: list[float]) -> int:
        """Make one body; properties one call each, for Bullet mixes some of them up."""
        bullet, client, preset = import_pybullet(), self._connection.client, self._preset
        body = int(bullet.createMultiBody(mass, shape, -1, place, useMaximalCoordinates=1, physicsClientId=client))
        inertia = list(preset["localInertiaDiagonal"])
        for properties in (
            {"linearDamping": preset["linearDamping"], "angularDamping": 0.0},
            {"lateralFriction": friction},
            {"mass": mass, "localInertiaDiagonal": inertia},
        ):
            bullet.changeDynamics(body, -1, **properties, physicsClientId=client)
        return body

    def _check_end(self, bodies: list[int], positions: FloatArray) -> None:
        """Compare positions with Bullet's; refuse a motion in which a box has left its plate and felt no friction."""
        bullet, client = import_pybullet(), self._connection.client
        where = [self._along(bullet.getBasePositionAndOrientation(body, physicsClientId=client)[0]) for body in bodies]
        if not np.allclose(positions, where, rtol=0, atol=POSITION_TOLERANCE * self._scale, equal_nan=True):
            raise RuntimeError(f"Bullet's positions {where} do not follow from its velocities: {positions.tolist()}")
        sizes = PressedBoxes(BOX * self._scale, PLATE * self._scale, SPACING * self._scale)
        sizes.check_reach(self._units.state(positions[None], np.zeros((1, positions.size))), self._units)
