"""Exudyn's contact formulation: in every cell a disc, the inner mass, pressed on a plane, the outer one."""

from typing import Any

import numpy as np

from engines.exudyn.joint import REGULARISED_DEFAULT, REGULARISED_TUNED, proportional_zone
from engines.exudyn.lane import ExudynLane
from engines.exudyn.law import disc
from engines.interface.presets import Option, Preset
from reference_lcp.chain.trajectory import State
from reference_lcp.validation import FloatArray

CONTACT_TUNED = Preset(
    "As in the joint formulation: steps and proportional zone small enough for a transmittance.",
    {
        **REGULARISED_TUNED.options,
        "zone": Option(5e-4, 0.0, "As in the joint, but twice as wide: in a narrower one some orbits do not repeat."),
        "zone_per_kick": Option(
            0.15,
            0.0,
            "Smallest width over F h / m_red: a disc does not leave its zone within Newton's iteration.",
        ),
        "substeps": Option(4, 1, "An eighth of those in the joint formulation: a step costs five times as much."),
        "discontinuous_tolerance": Option(
            1e-9, 1.0, "iterationTolerance: at 1 a disc leaves the zone at the end of a step only, and orbits stall."
        ),
        "useLinearProportionalZone": Option(True, False, "The zone of the joint formulation; the other is quadratic."),
    },
    known_deviation=REGULARISED_TUNED.known_deviation,
    law=disc,
    split_tolerance=1e-9,
    varied={"zone": (2e-3, 8e-3)},
)

CONTACT_DEFAULT = Preset(
    "The solver with its own settings, and a proportional zone that a newcomer would write.",
    {
        **REGULARISED_DEFAULT.options,
        "discontinuous_tolerance": Option(1.0, 1.0, "Exudyn's own."),
        "useLinearProportionalZone": Option(False, False, "Exudyn's own."),
    },
    known_deviation=(
        "friction is F s (2 − s) within a zone of 1e-3 m/s, s the slip velocity over its width, which a disc leaves at "
        "the end of a correction only: until then friction falls again beyond the zone"
    ),
    law=disc,
    split_tolerance=0.05,
)

INERTIA = 2.0**40
"""Inertia of a disc in the units of the lane: so large that friction does not make it roll."""


class ContactLane(ExudynLane):
    """Discs that slide on planes; both press each other with λ_N, and start as deep as that takes.

    Every mass has three coordinates: along the chain, across the plane, and its angle. At the static
    equilibrium nothing moves across the plane, so that a state needs the first ones only.
    """

    _force_variable = "ForceLocal"

    @property
    def _stiffness(self) -> FloatArray:
        """Contact stiffness: normal oscillations would take some six steps."""
        stiffness: FloatArray = self._reduced_mass * (self._substeps / self._time_step) ** 2
        return stiffness

    @property
    def _depth(self) -> FloatArray:
        """Depth of every disc in its plane at the static equilibrium; none where nothing rubs."""
        depth: FloatArray = np.zeros(self._chain.cells)
        depth[self._rubbing] = (self._chain.normal_force / self._stiffness)[self._rubbing]
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
        stiffness = float(self._stiffness[cell])
        node = system.AddNode(itemInterface.NodeGenericData(initialCoordinates=[0.0] * 3, numberOfDataCoordinates=3))
        return system.AddObject(
            itemInterface.ObjectConnectorRollingDiscPenalty(
                markerNumbers=[system.AddMarker(itemInterface.MarkerNodeRigid(nodeNumber=n)) for n in (outer, inner)],
                nodeNumber=node,
                discRadius=1.0,
                discAxis=[0.0, 0.0, 1.0],
                planeNormal=[0.0, 1.0, 0.0],
                contactStiffness=stiffness,
                contactDamping=2 * float(np.sqrt(stiffness * self._reduced_mass[cell])),
                dryFriction=[float(chain.friction_coefficient[cell])] * 2,
                dryFrictionProportionalZone=proportional_zone(self.lane, cell, self._preset) / self._units.velocity,
                useLinearProportionalZone=self._preset["useLinearProportionalZone"],
            )
        )
