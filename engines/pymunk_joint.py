"""pymunk's joint formulation: in every cell a pivot joint of bounded force, without its pull on positions."""

from typing import Any

import numpy as np

from engines.interface import Option, Preset, constant_normal_force
from engines.pymunk_bodies import PymunkLane
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


class PymunkJointLane(PymunkLane):
    """One chain with a joint in every cell; what it did is read as the size of its impulse."""

    def _hold(self, space: Any, outer: list[Any], inner: list[Any]) -> None:
        import pymunk

        self._joints = []
        for left, right, bound in zip(outer, inner, self._chain.friction_bound, strict=True):
            joint = pymunk.PivotJoint(left, right, (0.0, 0.0), (0.0, 0.0))
            joint.max_force, joint.max_bias = float(bound), self._preset["max_bias"]
            self._joints.append(joint)
        space.add(*self._joints)

    def _contacts(self) -> list[float]:
        return [joint.impulse for joint in self._joints]

    def _contact_forces(self, read: FloatArray, motions: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Give the sizes of impulses the sign of the momentum that the other forces do not explain."""
        cells = self._chain.cells
        before, velocity = motions[:-1].copy(), motions[:, 3 * cells :]
        if self._own_springs:
            # They act at the positions that a step ends with.
            before[:, : 2 * cells] = motions[1:, : 2 * cells]
        gained = self._chain.inner_mass * np.diff(velocity, axis=0) / self._time_step
        unexplained = gained - before @ self._spring_matrix()[cells:].T
        friction = np.copysign(read / self._time_step, unexplained)
        return friction * self._units.force, constant_normal_force(self.lane, len(read))
