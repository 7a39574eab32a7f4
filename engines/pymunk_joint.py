"""pymunk's joint formulation: in every cell a pivot joint of bounded force, without its pull on positions."""

from typing import Any

import numpy as np

from engines.interface import Option, Preset, constant_normal_force
from engines.pymunk_bodies import PymunkLane
from engines.units import power_of_two
from reference_lcp.simulation import Lane
from reference_lcp.validation import FloatArray

JOINT_TUNED = Preset(
    "Pivot joints of bounded force; springs, dashpots and drive as forces at the start of equation (5)'s step.",
    {
        "units": Option("lane", "SI", "No number comes near Chipmunk's built-in smallest ones."),
        "springs": Option("forces", "damped springs", "At the start of the step, as in equation (5)."),
        "positions": Option(
            "of the step before", "as they are", "Chipmunk advances positions first: forces are evaluated after that."
        ),
        "max_bias": Option(0.0, "infinite", "A pivot joint pulls its anchors together, as no friction does."),
        "iterations": Option(1, 10, "Frictions do not touch each other's masses, so that the first sweep is exact."),
    },
    shares_scheme=True,
    split_tolerance=1e-12,
)

JOINT_DEFAULT = Preset(
    "Pivot joints as pymunk's own examples use them for friction, and its damped springs, in SI units.",
    {
        "units": Option("SI", "SI", "The numbers of the chain as they are."),
        "springs": Option("damped springs", "damped springs", "pymunk's own, with dashpots that are implicit."),
        "positions": Option("as they are", "as they are", "What Body.position and Body.velocity hold."),
        "max_bias": Option(0.0, "infinite", "Needed: a pivot joint pulls its anchors together, as no friction does."),
        "iterations": Option(10, 10, "pymunk's own."),
    },
    split_tolerance=1e-12,
)

LENGTH = 2.0**10
"""Length of a damped spring over the displacement scale: it acts along the line of its anchors."""


class PymunkJointLane(PymunkLane):
    """One chain; what a joint did is read as the size of its impulse."""

    def __init__(self, lane: Lane, preset: Preset):
        """Take the lane's parameters in its units."""
        self._own_springs = preset["springs"] == "damped springs"
        super().__init__(lane, preset)

    def _force_matrix(self) -> FloatArray:
        """Only the drive is left where pymunk has the springs."""
        matrix = super()._force_matrix()
        return np.zeros_like(matrix) if self._own_springs else matrix

    def _new_space(self, motion: FloatArray) -> tuple[Any, list[Any]]:
        import pymunk

        space, cells = pymunk.Space(), self._chain.cells
        space.iterations = self._preset["iterations"]
        bodies = self._new_bodies(space, motion)
        joints = []
        for outer, inner, bound in zip(bodies[:cells], bodies[cells:], self._chain.friction_bound, strict=True):
            joint = pymunk.PivotJoint(outer, inner, (0.0, 0.0), (0.0, 0.0))
            joint.max_force, joint.max_bias = float(bound), self._preset["max_bias"]
            joints.append(joint)
        space.add(*joints)
        if self._own_springs:
            self._add_springs(space, bodies)
        return space, joints

    def _add_springs(self, space: Any, bodies: list[Any]) -> None:
        """Add the springs."""
        import pymunk

        chain, cells = self._chain, self._chain.cells
        length = LENGTH * power_of_two(self.lane.drive.displacement_scale(self.lane.chain)) / self._units.length
        # All bodies stand in one place; the right end of a spring is an anchor that its body carries ahead of it.
        anchors = (0.0, 0.0), (length, 0.0)
        outer, inner = bodies[:cells], bodies[cells:]
        for left, right, stiffness, damping in (
            *zip([space.static_body, *outer[:-1]], outer, chain.chain_stiffness, chain.chain_damping, strict=True),
            *zip(outer, inner, chain.inner_stiffness, chain.inner_damping, strict=True),
        ):
            space.add(pymunk.DampedSpring(left, right, *anchors, length, float(stiffness), float(damping)))

    def _contacts(self) -> list[float]:
        return [joint.impulse for joint in self._holders]

    def _contact_forces(self, read: FloatArray, motions: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Give the sizes of impulses the sign of the momentum that the other forces do not explain."""
        cells = self._chain.cells
        before, velocity = motions[:-1].copy(), motions[:, 3 * cells :]
        forces = super()._force_matrix()
        if self._own_springs:
            # They act at the positions that a step ends with.
            before[:, : 2 * cells] = motions[1:, : 2 * cells]
        gained = self._chain.inner_mass * np.diff(velocity, axis=0) / self._time_step
        unexplained = gained - before @ forces[cells:].T
        friction = np.copysign(read / self._time_step, unexplained)
        return friction * self._units.force, constant_normal_force(self.lane, len(read))
