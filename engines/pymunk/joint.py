"""pymunk's joint formulation: in every cell a pivot joint of bounded force, without its pull on positions."""

from collections.abc import Callable, Sequence
from typing import Any

import numpy as np

from engines.interface.presets import Preset
from engines.pymunk.simulation import PymunkBodies, World
from reference_lcp.chain.mass_in_mass import Chain
from reference_lcp.chain.simulation import Lane
from reference_lcp.validation import FloatArray


class PymunkJoints(PymunkBodies):
    """Lanes with a joint in every cell; what it did is read as the size of its impulse."""

    def __init__(self, lanes: Sequence[Lane], preset: Preset):
        super().__init__(lanes, preset)
        self._bounds = np.concatenate([chain.friction_bound for chain in self.chains]).tolist()
        self._reusable: World | None = None

    def fresh(self) -> World:
        """Give the space of the run before if its joints' impulses can be cleared: to make it anew takes longer."""
        if self._reusable is None or not self._cleared(self._reusable):
            self._reusable = super().fresh()
        return self._reusable

    def _hold(self, space: Any, chain: Chain, outer: list[Any], inner: list[Any]) -> list[Any]:
        import pymunk

        joints = []
        for left, right, bound in zip(outer, inner, chain.friction_bound, strict=True):
            joint = pymunk.PivotJoint(left, right, (0.0, 0.0), (0.0, 0.0))
            joint.max_force, joint.max_bias = float(bound), self._preset["max_bias"]
            joints.append(joint)
        space.add(*joints)
        return joints

    def _cleared(self, world: World) -> bool:
        """Take a step without any friction, after which no joint has an impulse to begin the next one with."""
        joints = world.holds
        self.place(world, np.zeros((len(self.lanes), 4 * self.cells)))
        for joint in joints:
            joint.max_force = 0.0
        world.space.step(self.time_step)
        for joint, bound in zip(joints, self._bounds, strict=True):
            joint.max_force = bound
        return not any(joint.impulse for joint in joints)

    def set_normal_load(self, world: World, normal_load: FloatArray) -> None:
        """Set the bounds; see `PymunkBodies.set_normal_load`."""
        bounds = [chain.friction_coefficient * row for chain, row in zip(self.chains, normal_load, strict=True)]
        for joint, bound in zip(world.holds, np.concatenate(bounds).tolist(), strict=True):
            joint.max_force = bound

    def reader(self, world: World) -> Callable[[], list[float]]:
        """Give what reads the sizes of all impulses."""
        joints = world.holds
        return lambda: [joint.impulse for joint in joints]

    def contact_forces(
        self, read: list[list[float]], motions: FloatArray, given: FloatArray
    ) -> tuple[FloatArray, FloatArray]:
        """Give the sizes of impulses the sign of the momentum that the other forces do not explain."""
        cells, lanes = self.cells, len(self.lanes)
        before, velocity = motions[:-1].copy(), motions[..., 3 * cells :]
        if self.own_springs:
            # They act at the positions that a step ends with.
            before[..., : 2 * cells] = motions[1:, :, : 2 * cells]
        inner_mass = np.stack([chain.inner_mass for chain in self.chains])
        gained = inner_mass * np.diff(velocity, axis=0) / self.time_step
        # One product a lane: it must not depend on what other lanes there are.
        explained = [before[:, lane] @ matrix[cells:].T for lane, matrix in enumerate(self.spring_matrix())]
        sizes = np.reshape(read, (len(read), lanes, cells)) / self.time_step
        return np.copysign(sizes, gained - np.stack(explained, axis=1)), given
