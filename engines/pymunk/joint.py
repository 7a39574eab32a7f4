"""pymunk's joint formulation: in every cell a pivot joint of bounded force, without its pull on positions."""

from collections.abc import Callable
from typing import Any

import numpy as np

from multibody_xval.engines.pymunk.simulation import PymunkSimulation, World
from reference_lcp.chain.mass_in_mass import Chain
from reference_lcp.validation import FloatArray


class PymunkJoints(PymunkSimulation):
    """Lanes with a joint in every cell; what it did is read as the size of its impulse."""

    def _hold(self, space: Any, chain: Chain, outer: list[Any], inner: list[Any]) -> list[Any]:
        import pymunk

        joints = []
        for left, right, bound in zip(outer, inner, chain.friction_bound, strict=True):
            joint = pymunk.PivotJoint(left, right, (0.0, 0.0), (0.0, 0.0))
            joint.max_force, joint.max_bias = float(bound), self._preset["max_bias"]
            joints.append(joint)
        space.add(*joints)
        return joints

    def _set_normal_load(self, world: World, normal_load: FloatArray) -> None:
        bounds = [chain.friction_coefficient * row for chain, row in zip(self._chains, normal_load, strict=True)]
        for joint, bound in zip(world.holds, np.concatenate(bounds).tolist(), strict=True):
            joint.max_force = bound

    def _reader(self, world: World) -> Callable[[], list[float]]:
        return lambda: [joint.impulse for joint in world.holds]

    def _contact_forces(self, read: list[Any], motions: FloatArray, given: FloatArray) -> tuple[FloatArray, FloatArray]:
        # Sizes of impulses get the sign of the momentum that the other forces do not explain.
        cells, before = self._cells, motions[:-1].copy()
        if self._own_springs:
            # They act at the positions that a step ends with.
            before[..., : 2 * cells] = motions[1:, :, : 2 * cells]
        inner_mass = np.stack([chain.inner_mass for chain in self._chains])
        gained = inner_mass * np.diff(motions[..., 3 * cells :], axis=0) / self._time_step
        # One product a lane: it must not depend on what other lanes there are.
        explained = [before[:, lane] @ matrix[cells:].T for lane, matrix in enumerate(self._springs)]
        sizes = np.reshape(read, gained.shape) / self._time_step
        return np.copysign(sizes, gained - np.stack(explained, axis=1)), given
