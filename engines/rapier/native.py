"""Rapier's own dry friction of joints, which only its loader of MJCF files sets: one multibody, a slide a mass."""

from typing import Any

import numpy as np

from multibody_xval.engines.interface.presets import Preset
from multibody_xval.engines.interface.tolerances import SINGLE
from multibody_xval.engines.rapier.joint import new_world, parameters_of
from multibody_xval.engines.shared.coordinates import JointCoordinates
from multibody_xval.engines.shared.force_loop import ExplicitForcesLane, Step
from multibody_xval.engines.shared.units import check_mass_ratio
from reference_lcp.chain.mass_in_mass import Chain
from reference_lcp.chain.simulation import Lane
from reference_lcp.validation import FloatArray

SPACING = 10.0
"""Between cells, across the row, where positions along it lose no digits by it."""

ROUNDINGS = 16
"""Of a slip velocity and of the forces in a step, which friction is read from."""

LARGEST_MASS_RATIO = 100.0
"""Of a cell's inner mass over the outer one, which carries it: with 1,000, a period is 5e-5 U0 off the scheme."""


def model_of(chain: Chain) -> str:
    """Give a chain's masses as an MJCF file: slides in the world, and on each one with a `frictionloss`."""
    cells = zip(chain.outer_mass.tolist(), chain.inner_mass.tolist(), chain.friction_bound.tolist(), strict=True)
    bodies = "".join(
        f'<body name="outer {cell}" pos="0 {SPACING * cell} 0"><joint name="u {cell}" type="slide" axis="1 0 0"/>'
        f'<inertial pos="0 0 0" mass="{outer!r}" diaginertia="1 1 1"/>'
        f'<body name="inner {cell}"><joint name="s {cell}" type="slide" axis="1 0 0" frictionloss="{bound!r}"/>'
        f'<inertial pos="0 0 0" mass="{inner!r}" diaginertia="1 1 1"/></body></body>'
        for cell, (outer, inner, bound) in enumerate(cells)
    )
    return f'<mujoco><option gravity="0 0 0"/><worldbody>{bodies}</worldbody></mujoco>'


class RapierNativeLane(ExplicitForcesLane):
    """One chain as a multibody; a run makes its world anew. Its coordinates are those of its joints, cell by cell."""

    coordinates = JointCoordinates()

    def __init__(self, lane: Lane, preset: Preset):
        check_mass_ratio([lane], LARGEST_MASS_RATIO, "a multibody of Rapier")
        super().__init__(lane, preset)
        self._file = model_of(self._chain)

    def _begin(self, motion: FloatArray) -> Step:
        world, bodies, multibody = self._new_world()
        position, velocity = np.split(motion, 2)
        multibody.apply_displacements(position.tolist())
        multibody.set_generalized_velocity(velocity.tolist())
        advance, loads = world.step, [(body.reset_forces, body.add_force) for body in bodies]

        def step(force: FloatArray) -> None:
            self._applied = force
            on_both, on_inner = force[0::2], force[1::2]
            pulls = np.column_stack([on_both - on_inner, on_inner])
            for (reset, push), pull in zip(loads, pulls.ravel().tolist(), strict=True):
                reset(True)
                push((pull, 0.0, 0.0), True)
            advance()
            position[:], velocity[:] = multibody.generalized_position(), multibody.generalized_velocity()

        return step

    def _new_world(self) -> tuple[Any, list[Any], Any]:
        """Make the world at rest; give it, its bodies in the order of the multibody's joints, and the multibody."""
        from rapier3d.loaders import mjcf

        world = new_world(self._time_step, parameters_of(self._preset))
        robot, _ = mjcf.MjcfRobot.from_str(self._file)
        loaded: Any = robot.insert_using_multibody_joints(
            world.rigid_bodies, world.colliders, world.multibody_joints, world.impulse_joints
        )
        # Until its first step, here at rest, a multibody has six coordinates of its root besides.
        world.step()
        # Links are numbered as the file has them, the fixed world first.
        bodies = [world.rigid_bodies[each.body] for each in loaded.bodies[1:]]
        return world, bodies, world.multibody_joints.multibody(loaded.joints[0].joint)

    def _contacts(self) -> FloatArray:
        """Give the forces of the step: Rapier does not tell the impulses of these joints."""
        return self._applied.copy()

    def _contact_forces(
        self, read: FloatArray, motions: FloatArray, given: FloatArray
    ) -> tuple[FloatArray, FloatArray]:
        """Read friction from slips, and take it for its bound where single precision cannot tell it from that."""
        slips = motions[:, 2 * self._chain.cells + 1 :: 2]
        outer, inner, bound = self._chain.outer_mass, self._chain.inner_mass, self._chain.friction_bound
        reduced = outer * inner / (outer + inner)
        rates = (read[:, 0::2] - read[:, 1::2]) / outer, read[:, 1::2] / inner
        friction = reduced * (np.diff(slips, axis=0) / self._time_step + rates[0] - rates[1])
        speed = (np.abs(slips[1:]) + np.abs(slips[:-1])) / self._time_step
        rounding = ROUNDINGS * SINGLE * reduced * (speed + np.abs(rates[0]) + np.abs(rates[1]))
        at_bound = np.abs(friction) > bound - rounding
        return np.where(at_bound, np.copysign(bound, friction), friction) * self._units.force, given
