"""Rapier's contact formulation: in every cell a sphere, the inner mass, pressed on a plate, the outer one.

Bodies do not turn, and a sphere touches in one point: a box does in four, which round four times as often.
"""

from typing import Any

import numpy as np

from multibody_xval.engines.interface.presets import Preset
from multibody_xval.engines.rapier.joint import RapierLane
from multibody_xval.engines.shared.force_loop import PressedLane, Step
from reference_lcp.chain.simulation import Lane
from reference_lcp.validation import FloatArray

CLEARANCE = 4.0
"""What cells stand further apart than spheres need, over the distance from which Rapier sees contacts."""


class RapierContactLane(PressedLane, RapierLane):
    """One chain with a sphere on a plate in every cell, side by side."""

    # Friction acts in the plane of a contact. A contact that could not slide in y either has none at all.
    FREE_INNER = (True, True, True)

    def __init__(self, lane: Lane, preset: Preset):
        import rapier3d

        super().__init__(lane, preset)
        apart = self._sizes.spacing + CLEARANCE * rapier3d.IntegrationParameters().prediction_distance()
        cells = lane.chain.cells
        self._places[:, 0] = np.tile(apart * np.arange(cells), 2)
        self._places[:, 1] = np.repeat([-self._sizes.box, self._sizes.box], cells)
        self._pressing[cells:] = -self._chain.normal_force

    def _hold(self, world: Any, outer: list[Any], inner: list[Any]) -> None:
        from rapier3d import Collider, FrictionModel

        world.integration_parameters.friction_model = getattr(FrictionModel, self._preset["friction_model"])
        radius, plate = self._sizes.box, self._sizes.plate
        self._colliders = []
        for below, above, friction in zip(outer, inner, self._chain.friction_coefficient.tolist(), strict=True):
            # Rapier takes the mean of the coefficients of the two.
            shapes = (below, Collider.cuboid(plate, radius, radius)), (above, Collider.ball(radius))
            rough = [(shape.density(0.0).friction(friction).restitution(0.0), body) for body, shape in shapes]
            self._colliders.append([world.add_collider(*each) for each in rough])

    def _begin(self, motion: FloatArray) -> Step:
        step, start = super()._begin(motion), motion.copy()
        cold = bool(self._preset["warmstart_coefficient"])

        def warm_step(force: FloatArray) -> None:
            nonlocal cold
            if cold:
                # The first step is taken, and bodies put back: contacts then start as if they had acted before.
                step(force)
                self._put(start)
                cold = False
            step(force)

        return warm_step if cold else step

    def _put(self, motion: FloatArray) -> None:
        """Give the bodies this motion; contacts remember their impulses."""
        places = zip(self._bodies, *motion.reshape(2, -1).tolist(), *self._places.T.tolist(), strict=True)
        for body, along, velocity, aside, z in places:
            body.translation, body.linvel = (along, aside, z), (velocity, 0.0, 0.0)

    def _set_normal_load(self, normal_load: FloatArray) -> None:
        self._pressing[normal_load.size :] = -normal_load

    def _contacts(self) -> FloatArray:
        impulses = np.zeros((2, self._chain.cells))
        pair_of = self._world.narrow_phase.contact_pair
        for cell, colliders in enumerate(self._colliders):
            pair = pair_of(*colliders)
            for manifold in [] if pair is None else pair.manifolds:
                for point in manifold.points:
                    impulses[0, cell] += point.tangent_impulse[1]
                    impulses[1, cell] += point.impulse
        return impulses / self._time_step
