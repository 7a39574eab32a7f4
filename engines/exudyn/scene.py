"""Scenes as users of Exudyn write them: a kinematic tree, and a connector with dry friction on every coordinate."""

from typing import Any

import numpy as np

from multibody_xval.engines.exudyn.simulation import imported, silent
from multibody_xval.engines.interface.scene import (
    GRAVITY,
    LINK_INERTIA,
    LINK_LENGTH,
    LINK_MASS,
    ArmScene,
    JointScene,
    SceneSetting,
    Vector,
    not_launched,
    not_pushed,
)
from reference_lcp.validation import FloatArray

STEP = 0.01
"""Exudyn's own time step [s]: a second in a hundred."""

NO_CONTACTS = "its contacts with friction are those of spheres and discs; boxes have none"


class JointWorld:
    """A tree of links, whose solver takes all steps of a run itself; see `SceneWorld`."""

    def __init__(self, scene: JointScene | ArmScene, setting: SceneSetting):
        self._setting, self._steps = setting, 0
        with imported() as exudyn:
            self._exudyn, self._container = exudyn, exudyn.SystemContainer()
            self._system = self._container.AddSystem()
            self._sensor = self._assemble(scene)

    def run(self, steps: int) -> FloatArray:
        """Take so many steps, and give the coordinates after each, shape (steps, joints)."""
        step, settings = self._setting.time_step, self._exudyn.SimulationSettings()
        settings.solution.file.write = False
        # A little less than a step, for times in seconds add up with round-off.
        settings.solution.sensors.writePeriod = step * (1 - 1e-6)
        integration = settings.timeIntegration
        integration.verboseMode = 0
        integration.startTime, integration.endTime = self._steps * step, (self._steps + steps) * step
        integration.numberOfSteps = steps
        iterations = self._setting.changed("discontinuous_iterations")
        if iterations is not None:
            integration.discontinuous.maxIterations = iterations
        with silent(self._exudyn):
            self._system.SolveDynamic(settings)
        self._steps += steps
        data, kinds = self._system.systemData, self._exudyn.ConfigurationType
        data.SetSystemState(data.GetSystemState(configuration=kinds.Current), configuration=kinds.Initial)
        rows: FloatArray = self._system.GetSensorStoredData(self._sensor)[1:, 1:]
        return rows

    def launch(self, velocity: Vector, spin: float) -> None:
        """Refuse: there is no box."""
        not_launched(velocity, spin)

    def push(self, force: float) -> None:
        """Refuse: there is no box."""
        not_pushed(force)

    def close(self) -> None:
        """Empty the system."""
        self._container.Reset()

    def _assemble(self, scene: JointScene | ArmScene) -> Any:
        """Add the tree, its friction and its load; give the sensor of its coordinates."""
        from exudyn import itemInterface

        system = self._system
        bounds = (scene.friction,) if isinstance(scene, JointScene) else scene.friction
        still = [0.0] * len(bounds)
        node = system.AddNode(itemInterface.NodeGenericODE2(
            numberOfODE2Coordinates=len(bounds), referenceCoordinates=still,
            initialCoordinates=still, initialCoordinates_t=still,
        ))  # fmt: skip
        system.AddObject(itemInterface.ObjectKinematicTree(nodeNumber=node, **self._links(scene, len(bounds))))
        ground = system.AddNode(itemInterface.NodePointGround())
        fixed = system.AddMarker(itemInterface.MarkerNodeCoordinate(nodeNumber=ground, coordinate=0))
        for joint, bound in enumerate(bounds):
            marker = system.AddMarker(itemInterface.MarkerNodeCoordinate(nodeNumber=node, coordinate=joint))
            system.AddObject(itemInterface.CoordinateSpringDamperExt(
                markerNumbers=[fixed, marker], dynamicFrictionForce=bound, **self._friction()
            ))  # fmt: skip
            if isinstance(scene, JointScene):
                system.AddLoad(itemInterface.LoadCoordinate(markerNumber=marker, load=scene.load))
        kind = self._exudyn.OutputVariableType.Coordinates
        sensor = itemInterface.SensorNode(
            nodeNumber=node, outputVariableType=kind, storeInternal=True, writeToFile=False
        )
        sensor = system.AddSensor(sensor)
        system.Assemble()
        return sensor

    def _links(self, scene: JointScene | ArmScene, number: int) -> dict[str, Any]:
        """Give joints and links, of a tree without branches."""
        exudyn, single = self._exudyn, isinstance(scene, JointScene)
        kinds = exudyn.JointType
        kind = kinds.RevoluteY
        if isinstance(scene, JointScene):
            kind = kinds.PrismaticX if scene.kind == "slide" else kinds.RevoluteZ
        inertia, centre = ((1.0, 1.0, 1.0), 0.0) if single else (LINK_INERTIA, LINK_LENGTH / 2)
        return {
            "gravity": [0.0, 0.0, 0.0 if single else -GRAVITY],
            "jointTypes": [kind] * number,
            "linkParents": np.arange(number) - 1,
            "jointTransformations": exudyn.Matrix3DList([np.eye(3)] * number),
            "jointOffsets": exudyn.Vector3DList([[LINK_LENGTH if link else 0.0, 0.0, 0.0] for link in range(number)]),
            "linkInertiasCOM": exudyn.Matrix3DList([np.diag(inertia)] * number),
            "linkCOMs": exudyn.Vector3DList([[centre, 0.0, 0.0]] * number),
            "linkMasses": [LINK_MASS] * number,
        }

    def _friction(self) -> dict[str, Any]:
        """Give the law of a joint's friction: a zone, or a bristle with its own data."""
        from exudyn import itemInterface

        preset = self._setting.preset
        if "frictionProportionalZone" in preset.options:
            return {"frictionProportionalZone": preset["frictionProportionalZone"]}
        data = itemInterface.NodeGenericData(initialCoordinates=[0.0] * 3, numberOfDataCoordinates=3)
        bristle = {name: preset[name] for name in ("stickingStiffness", "stickingDamping")}
        return {"nodeNumber": self._system.AddNode(data), **bristle}
