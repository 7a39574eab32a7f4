"""DART's joint formulation: a skeleton of sliders with Coulomb friction in the inner ones."""

from typing import Any

import numpy as np

from multibody_xval.engines.interface.presets import Preset
from multibody_xval.engines.shared.coordinates import ChainCoordinates
from multibody_xval.engines.shared.force_loop import ExplicitForcesLane, Step
from reference_lcp.chain.simulation import Lane
from reference_lcp.validation import FloatArray


def new_world(time_step: float, sleeping: bool, gravity: float = 0.0) -> Any:
    """Make an empty world, where bodies that move slowly may be put to sleep, or not."""
    import dartpy

    world = dartpy.simulation.World()
    options = world.getDeactivationOptions()
    options.mEnabled = sleeping
    world.setDeactivationOptions(options)
    world.setTimeStep(time_step)
    world.setGravity([0.0, 0.0, -gravity])
    return world


class DartJointLane(ExplicitForcesLane):
    """One chain; a run makes its world anew, so that nothing is left of earlier runs."""

    def __init__(self, lane: Lane, preset: Preset):
        self._own_springs = preset["springs"] == "of the joints"
        self.coordinates = ChainCoordinates.ROW if self._own_springs else ChainCoordinates.CELLS
        super().__init__(lane, preset)

    def _begin(self, motion: FloatArray) -> Step:
        world, self._skeleton = self._new_world()
        skeleton, half = self._skeleton, motion.size // 2
        positions, velocities = motion[:half], motion[half:]
        skeleton.setPositions(positions)
        skeleton.setVelocities(velocities)
        load, advance = skeleton.setForces, world.step
        read_positions, read_velocities = skeleton.getPositions, skeleton.getVelocities

        def step(force: FloatArray) -> None:
            load(force)
            advance()
            positions[:] = read_positions()
            velocities[:] = read_velocities()

        return step

    def _set_normal_load(self, normal_load: FloatArray) -> None:
        first = self._chain.cells
        for cell, bound in enumerate((self._chain.friction_coefficient * normal_load).tolist()):
            self._skeleton.getJoint(first + cell).setCoulombFriction(0, bound)

    def _contacts(self) -> FloatArray:
        """Read the impulses of all joints: getConstraintForces divides them by the time step anew at every call."""
        impulses: FloatArray = self._skeleton.getJointConstraintImpulses()
        return impulses[self._chain.cells :] / self._time_step

    def _new_world(self) -> tuple[Any, Any]:
        """Make a world with one skeleton: sliders of the outer masses, then on each that of its inner mass."""
        import dartpy

        world, skeleton = new_world(self._time_step, self._preset["deactivation"]), dartpy.dynamics.Skeleton()
        chain, carriers = self._chain, [None]
        outer = chain.outer_mass, chain.chain_stiffness, chain.chain_damping, np.zeros(chain.cells)
        for values in zip(*outer, strict=True):
            carriers.append(self._add_slider(skeleton, carriers[-1] if self._own_springs else None, *values))
        inner = chain.inner_mass, chain.inner_stiffness, chain.inner_damping, chain.friction_bound
        for carrier, *numbers in zip(carriers[1:], *inner, strict=True):
            self._add_slider(skeleton, carrier, *numbers)
        world.addSkeleton(skeleton)
        return world, skeleton

    def _add_slider(
        self, skeleton: Any, carrier: Any, mass: float, stiffness: float, damping: float, bound: float
    ) -> Any:
        """Add a body that slides along x on its carrier, the ground if there is none."""
        joint, body = skeleton.createPrismaticJointAndBodyNodePair(*([] if carrier is None else [carrier]))
        joint.setAxis([1.0, 0.0, 0.0])
        joint.setCoulombFriction(0, bound)
        body.setMass(mass)
        if self._own_springs:
            joint.setSpringStiffness(0, stiffness)
            joint.setDampingCoefficient(0, damping)
        return body
