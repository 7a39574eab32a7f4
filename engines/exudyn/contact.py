"""Exudyn's contact formulation: in every cell a disc, the inner mass, pressed on a plane, the outer one."""

from functools import cached_property
from typing import Any

import numpy as np

from multibody_xval.engines.exudyn.joint import reduced_mass, zone_widths
from multibody_xval.engines.exudyn.simulation import ExudynLane
from reference_lcp.chain.mass_in_mass import Chain
from reference_lcp.chain.trajectory import State
from reference_lcp.validation import FloatArray

INERTIA = 2.0**40
"""Inertia of a disc in the units of the lane: so large that friction does not make it roll."""


def contact_springs(chain: Chain, time_step: float, substeps: int) -> tuple[FloatArray, FloatArray]:
    """Give stiffness and dashpot of every contact, shape (n,): normal oscillations would take some six steps."""
    mass = reduced_mass(chain)
    stiffness = mass * (substeps / time_step) ** 2
    return stiffness, 2 * np.sqrt(stiffness * mass)


class ContactLane(ExudynLane):
    """Discs that slide on planes; both press each other with λ_N, and start as deep as that takes.

    Every mass has three coordinates: along the chain, across the plane, and its angle. At the static
    equilibrium nothing moves across the plane, so that a state needs the first ones only.
    """

    _force_variable = "ForceLocal"

    @cached_property
    def _springs(self) -> tuple[FloatArray, FloatArray]:
        return contact_springs(self._chain, self._time_step, self._substeps)

    @cached_property
    def _depth(self) -> FloatArray:
        """Depth of every disc in its plane at the static equilibrium; none where nothing rubs."""
        depth: FloatArray = np.zeros(self._chain.cells)
        depth[self._rubbing] = (self._chain.normal_force / self._springs[0])[self._rubbing]
        return depth

    def _along(self, coordinates: FloatArray) -> FloatArray:
        return coordinates[..., 0::3]

    def _coordinates(self, along: FloatArray) -> FloatArray:
        coordinates = np.zeros(3 * along.shape[0])
        coordinates[0::3] = along
        return coordinates

    def _recorded_forces(self, steps: int) -> tuple[FloatArray, FloatArray]:
        friction, normal = np.zeros((steps, self._chain.cells)), self.lane.preloads(0, steps).copy()
        for cell, sensor in zip(self._rubbing, self._force_sensors, strict=True):
            force = self._recorded(sensor, steps) * self._units.force
            friction[:, cell], normal[:, cell] = -force[:, 1], force[:, 2]
        return friction, normal

    def _solver_settings(self) -> Any:
        settings = super()._solver_settings()
        settings.timeIntegration.discontinuous.iterationTolerance = self._preset["discontinuous_tolerance"]
        return settings

    def _set_friction_state(self, state: State, start: int) -> None:
        outer, inner = np.split(state.velocities[0] / self._units.velocity, 2)
        # Of the last step: slip across and along, of the plane under the disc, and minus the depth.
        data = np.stack([np.zeros_like(outer), outer - inner, -self._depth], axis=1)[self._rubbing]
        self._system.systemData.SetDataCoordinates(data.ravel(), self._exudyn.ConfigurationType.Initial)

    def _assemble(self) -> None:
        from exudyn import itemInterface

        system, chain = self._system, self._chain
        heights = np.concatenate([np.zeros(chain.cells), 1 - self._depth])
        nodes = [
            system.AddNode(itemInterface.NodeRigidBody2D(referenceCoordinates=[0.0, height, 0.0]))
            for height in heights.tolist()
        ]
        along, across, turning = (np.diag(direction) for direction in np.eye(3))
        masses = np.diag(chain.mass_matrix)
        system.AddObject(
            itemInterface.ObjectGenericODE2(
                nodeNumbers=nodes,
                massMatrix=np.kron(np.diag(masses), along + across) + np.kron(np.eye(masses.size), INERTIA * turning),
                stiffnessMatrix=np.kron(chain.stiffness_matrix, along),
                dampingMatrix=np.kron(chain.damping_matrix, along),
            )
        )
        contacts = [self._add_contact(nodes[cell], nodes[chain.cells + cell], cell) for cell in self._rubbing.tolist()]
        self._add_load(system.AddMarker(itemInterface.MarkerNodeCoordinate(nodeNumber=nodes[0], coordinate=0)))
        self._add_sensors(nodes, contacts)
        system.Assemble()

    def _add_contact(self, outer: Any, inner: Any, cell: int) -> Any:
        """Press a disc on its plane: λ_N acts on both, at its static depth."""
        from exudyn import itemInterface

        system, chain = self._system, self._chain
        for node, force in ((outer, float(chain.normal_force[cell])), (inner, -float(chain.normal_force[cell]))):
            marker = system.AddMarker(itemInterface.MarkerNodeCoordinate(nodeNumber=node, coordinate=1))
            system.AddLoad(itemInterface.LoadCoordinate(markerNumber=marker, load=force))
        stiffness, damping = self._springs
        node = system.AddNode(itemInterface.NodeGenericData(initialCoordinates=[0.0] * 3, numberOfDataCoordinates=3))
        return system.AddObject(
            itemInterface.ObjectConnectorRollingDiscPenalty(
                markerNumbers=[system.AddMarker(itemInterface.MarkerNodeRigid(nodeNumber=n)) for n in (outer, inner)],
                nodeNumber=node,
                discRadius=1.0,
                discAxis=[0.0, 0.0, 1.0],
                planeNormal=[0.0, 1.0, 0.0],
                contactStiffness=float(stiffness[cell]),
                contactDamping=float(damping[cell]),
                dryFriction=[float(chain.friction_coefficient[cell])] * 2,
                dryFrictionProportionalZone=float(zone_widths(self.lane, self._preset)[cell]) / self._units.velocity,
                useLinearProportionalZone=self._preset["useLinearProportionalZone"],
            )
        )
