"""PyBullet's joint formulation: one tree of sliders, with a velocity motor of bounded force as dry friction."""

import functools
import importlib
import sys
from typing import Any

import numpy as np

from multibody_xval.engines.interface.presets import Preset
from multibody_xval.engines.shared.coordinates import ChainCoordinates
from multibody_xval.engines.shared.force_loop import ExplicitForcesLane, Step
from multibody_xval.engines.shared.silence import silent_standard_error
from reference_lcp.chain.simulation import Lane
from reference_lcp.errors import ParameterError
from reference_lcp.validation import FloatArray


class Connection:
    """PyBullet's constants and functions, these of a connection of its own.

    It is opened on first use, for that takes longer than a period of the chain. PyBullet's own `BulletClient`, of the
    same kind, prints on standard output.
    """

    def __init__(self) -> None:
        self._client: int | None = None

    def __getattr__(self, name: str) -> Any:
        """Give what PyBullet has of this name."""
        found = getattr(import_pybullet(), name)
        return functools.partial(found, physicsClientId=self._opened()) if callable(found) else found

    def _opened(self) -> int:
        if self._client is None:
            bullet = import_pybullet()
            self._client = int(bullet.connect(bullet.DIRECT))
            if self._client < 0:
                raise RuntimeError("PyBullet opens no further world; close simulations that are no longer used")
        return self._client

    def connect(self, _mode: int) -> None:
        """Open the connection now; it never draws."""
        self._opened()

    def disconnect(self) -> None:
        """Close the connection; the next use opens another."""
        if self._client is not None:
            import_pybullet().disconnect(self._client)
            self._client = None

    def __del__(self) -> None:
        if not sys.is_finalizing():
            self.disconnect()


@functools.cache
def _module() -> Any:
    """Import PyBullet, which reports its build time to the standard error stream when it is loaded."""
    with silent_standard_error():
        return importlib.import_module("pybullet")


def import_pybullet(*, alone: bool = False) -> Any:
    """Give PyBullet, or its constants and the functions of a connection that is used alone."""
    return Connection() if alone else _module()


MOST_CELLS = 63
"""Two joints a cell: PyBullet addresses fewer than 128 joints of a body."""


class PyBulletLane(ExplicitForcesLane):
    """One chain; a run makes its bodies anew, so that nothing is left of earlier runs."""

    def __init__(self, lane: Lane, preset: Preset, bullet: Connection):
        super().__init__(lane, preset)
        self._bullet = bullet

    def close(self) -> None:
        """Close the connection that this lane shares with the others of its simulation."""
        self._bullet.disconnect()


class PyBulletJointLane(PyBulletLane):
    """Sliders with motors."""

    coordinates = ChainCoordinates.CELLS

    def __init__(self, lane: Lane, preset: Preset, bullet: Connection):
        cells = lane.chain.cells
        if cells > MOST_CELLS:
            raise ParameterError(f"cells = {cells} is outside what PyBullet takes; allowed: at most {MOST_CELLS}")
        super().__init__(lane, preset, bullet)
        # Those of the outer masses, then of the inner ones.
        self._links = [*range(0, 2 * cells, 2), *range(1, 2 * cells, 2)]

    def _begin(self, motion: FloatArray) -> Step:
        bullet, links = self._bullet, self._links
        self._body = body = self._new_body(*np.split(motion, 2))
        control, torque = bullet.setJointMotorControlArray, bullet.TORQUE_CONTROL
        step_simulation, read = bullet.stepSimulation, bullet.getJointStates

        def step(force: FloatArray) -> None:
            control(body, links, torque, forces=force.tolist())
            step_simulation()
            self._joints = joints = read(body, links)
            motion[:] = [joint[0] for joint in joints] + [joint[1] for joint in joints]

        return step

    def _set_normal_load(self, normal_load: FloatArray) -> None:
        bounds = self._chain.friction_coefficient * normal_load
        self._set_bounds(self._body, self._links[self._chain.cells :], bounds.tolist())

    def _contacts(self) -> list[float]:
        return [joint[3] for joint in self._joints[self._chain.cells :]]

    def _contact_forces(
        self, read: FloatArray, motions: FloatArray, given: FloatArray
    ) -> tuple[FloatArray, FloatArray]:
        # Of a motor that may do nothing in a step Bullet reports what it did in an earlier one.
        return np.where(given == 0, 0.0, read * self._units.force), given

    def _set_bounds(self, body: int, links: list[int], bounds: list[float]) -> None:
        """Set what the motors of these links can do at most."""
        bullet, still = self._bullet, [0.0] * len(links)
        bullet.setJointMotorControlArray(
            body, links, bullet.VELOCITY_CONTROL, targetVelocities=still, forces=bounds,
            velocityGains=[self._preset["velocityGain"]] * len(links),
        )  # fmt: skip

    def _new_body(self, coordinates: FloatArray, velocities: FloatArray) -> int:
        """Empty the world, make the chain and set its state.

        Motors come last, for Bullet stores their bounds times the time step.
        """
        bullet, links = self._bullet, self._links
        bullet.resetSimulation()
        bullet.setTimeStep(self._time_step)
        body = _new_tree(bullet, self._chain.outer_mass, self._chain.inner_mass)
        preset = self._preset
        bullet.changeDynamics(
            body, -1, linearDamping=preset["linearDamping"], maxJointVelocity=preset["maxJointVelocity"]
        )
        bullet.resetJointStatesMultiDof(body, links, coordinates[:, None].tolist(), velocities[:, None].tolist())
        self._set_bounds(
            body, links, [preset["outer motor force"]] * self._chain.cells + self._chain.friction_bound.tolist()
        )
        return body


def _new_tree(bullet: Connection, outer_mass: FloatArray, inner_mass: FloatArray) -> int:
    """Create a fixed base, on it n sliding outer masses, on each an inner mass that slides relative to it."""
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
    )
    return body
