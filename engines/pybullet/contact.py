"""PyBullet's contact formulation: in every cell a box, the inner mass, pressed on a plate, the outer one.

A box that is pulled off flies away from its plate and the plate from the box, for nothing guides them: the gap opens
as if the reduced mass m_o m_i / (m_o + m_i) flew. That is a factor on the gap alone: when the masses meet again,
∬ N dt dt = 0, and the impulse with which they do, ∫ N dt, do not depend on the mass that flies. States and
trajectories hold the gap over a guided plate, on which m_i flies.
"""

from typing import Any

import numpy as np

from multibody_xval.engines.interface.presets import Preset
from multibody_xval.engines.pybullet.joint import Connection, PyBulletLane
from multibody_xval.engines.shared.box_geometry import BOX
from multibody_xval.engines.shared.force_loop import PressedLane, Step
from reference_lcp.chain.simulation import Lane
from reference_lcp.chain.trajectory import State
from reference_lcp.errors import ParameterError
from reference_lcp.validation import FloatArray

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


class PyBulletContactLane(PressedLane, PyBulletLane):
    """Boxes on plates, which begin at the static equilibrium of their contacts.

    Outer and inner mass press each other with λ_N, an internal pair of forces, so that nothing needs a guide.
    """

    plate, spacing = PLATE, SPACING

    def __init__(self, lane: Lane, preset: Preset, bullet: Connection):
        largest = float(np.max(lane.chain.friction_coefficient))
        if largest > LARGEST_COEFFICIENT:
            raise ParameterError(
                f"friction_coefficient = {largest:g}; allowed by Bullet: at most {LARGEST_COEFFICIENT:g}"
            )
        super().__init__(lane, preset, bullet)
        # Gap of free bodies over the gap that the inner mass alone would make.
        self._opening = 1 + self._chain.inner_mass / self._chain.outer_mass

    def _begin(self, motion: FloatArray) -> Step:
        bullet, time_step = self._bullet, self._time_step
        self._bodies = bodies = self._new_bodies(motion, self._across)
        self._set_normal_load(self._chain.normal_force)
        position, velocity = np.split(motion, 2)
        apply, frame, nowhere = bullet.applyExternalForce, bullet.LINK_FRAME, (0.0, 0.0, 0.0)
        step_simulation, read = bullet.stepSimulation, bullet.getBaseVelocity

        def step(force: FloatArray) -> None:
            for body, along, across in zip(bodies, force.tolist(), self._pressing, strict=True):
                apply(body, -1, (along, 0.0, across), nowhere, frame)
            step_simulation()
            velocity[:] = [read(body)[0][0] for body in bodies]
            # Bullet's own step, compared in `_state`: reading positions too would take as long as its solver.
            np.add(position, time_step * velocity, position)

        return step

    def _set_normal_load(self, normal_load: FloatArray) -> None:
        self._pressing = np.concatenate([normal_load, -normal_load]).tolist()

    def _gaps(self) -> FloatArray:
        """Read the gap, and its rate, as the inner mass alone would make them; shape (2, n)."""
        bullet, bodies = self._bullet, self._bodies
        heights = [bullet.getBasePositionAndOrientation(body)[0][2] for body in bodies]
        speeds = [bullet.getBaseVelocity(body)[0][2] for body in bodies]
        outer, inner = np.split(np.array([heights, speeds]), 2, axis=1)
        # At rest a box is as deep as Bullet leaves alone, see `_new_bodies`.
        return (inner - outer - [[2 * self._sizes.box - REST_DEPTH], [0.0]]) / self._opening

    def _contacts(self) -> FloatArray:
        bullet, cells = self._bullet, self._chain.cells
        forces = np.zeros((2, cells))
        for cell, (outer, inner) in enumerate(zip(self._bodies[:cells], self._bodies[cells:], strict=True)):
            points = bullet.getContactPoints(inner, outer)
            # A point has its normal force at 9, then twice a tangential force and the direction it acts in on
            # the outer mass.
            forces[0, cell] = -sum(point[10] * point[11][0] + point[12] * point[13][0] for point in points)
            forces[1, cell] = sum(point[9] for point in points)
        return forces

    def _state(self, motions: FloatArray) -> State:
        """Compare the end with Bullet's; refuse a motion in which a box has left its plate and felt no friction."""
        bullet, end = self._bullet, super()._state(motions)
        positions = motions[-1, : len(self._bodies)]
        places = (bullet.getBasePositionAndOrientation(body)[0] for body in self._bodies)
        where, tolerance = [place[0] for place in places], POSITION_TOLERANCE * self._sizes.box / BOX
        if not np.allclose(positions, where, rtol=0, atol=tolerance, equal_nan=True):
            raise RuntimeError(f"Bullet's positions {where} do not follow from its velocities: {positions.tolist()}")
        return end

    def _new_bodies(self, motion: FloatArray, across: FloatArray) -> list[int]:
        """Empty the world, and make all plates, then all boxes, with their motion along the row and across it.

        `across` holds the gap and its rate as the inner mass alone would make them, shape (2, n).
        """
        bullet, preset = self._bullet, self._preset
        bullet.resetSimulation()
        bullet.setTimeStep(self._time_step)
        bullet.setPhysicsEngineParameter(
            solverResidualThreshold=preset["solverResidualThreshold"], contactSlop=REST_DEPTH
        )
        chain, box, length = self._chain, self._sizes.box, self._sizes.plate
        plate, cube = (
            bullet.createCollisionShape(bullet.GEOM_BOX, halfExtents=sizes) for sizes in ([length, box, box], [box] * 3)
        )
        # At the static equilibrium a contact is as deep as Bullet leaves alone.
        height = box - REST_DEPTH
        positions, velocities = np.split(motion, 2)
        bodies = []
        for mass in range(2 * chain.cells):
            side, cell = divmod(mass, chain.cells)
            place = [float(positions[mass]), cell * self._sizes.spacing, height if side else -box]
            weight = float((chain.inner_mass if side else chain.outer_mass)[cell])
            # Bullet multiplies the coefficients of the two bodies.
            friction = float(chain.friction_coefficient[cell]) if side else 1.0
            bodies.append(self._new_body(cube if side else plate, weight, friction, place))
        # Bullet takes over a new inertia at the end of a step only: let one pass at rest.
        bullet.stepSimulation()
        # The inner mass moves as it would alone; the plate the other way, for both are pulled alike.
        rises, speeds = np.hstack([-across * chain.inner_mass / chain.outer_mass, across]).tolist()
        for body, velocity, rise, speed in zip(bodies, velocities.tolist(), rises, speeds, strict=True):
            if self.lane.opens:
                (along, aside, rest), turned = bullet.getBasePositionAndOrientation(body)
                bullet.resetBasePositionAndOrientation(body, [along, aside, rest + rise], turned)
            bullet.resetBaseVelocity(body, [velocity, 0.0, speed], [0.0] * 3)
        return bodies

    def _new_body(self, shape: Any, mass: float, friction: float, place: list[float]) -> int:
        """Make one body; properties one call each, for Bullet mixes some of them up."""
        bullet, preset = self._bullet, self._preset
        body = int(bullet.createMultiBody(mass, shape, -1, place, useMaximalCoordinates=1))
        inertia = list(preset["localInertiaDiagonal"])
        for properties in (
            {"linearDamping": preset["linearDamping"], "angularDamping": 0.0},
            {"lateralFriction": friction},
            {"mass": mass, "localInertiaDiagonal": inertia},
        ):
            bullet.changeDynamics(body, -1, **properties)
        return body
