"""Scenes as users of Exudyn write them: a kinematic tree, and a connector with dry friction on every coordinate."""

from typing import Any

import numpy as np

from multibody_xval.engines.exudyn.simulation import import_exudyn, silent
from multibody_xval.engines.interface.scene import (
    GRAVITY,
    LINK_INERTIA,
    LINK_LENGTH,
    LINK_MASS,
    ArmScene,
    JointScene,
    SceneSetting,
    SolvedWorld,
)
from reference_lcp.validation import FloatArray

STEP = 0.01
"""Exudyn's own time step [s]: a second in a hundred."""

NO_CONTACTS = "its contacts with friction are those of spheres and discs; boxes have none"


def joints(scene: JointScene | ArmScene, setting: SceneSetting) -> SolvedWorld:
    """Build a tree of links, whose solver takes all steps of a run itself."""
    exudyn = import_exudyn()
    from exudyn import itemInterface

    container = exudyn.SystemContainer()
    system, steps_taken = container.AddSystem(), 0
    bounds = (scene.friction,) if isinstance(scene, JointScene) else scene.friction
    still = [0.0] * len(bounds)
    with silent(exudyn):
        node = system.AddNode(itemInterface.NodeGenericODE2(
            numberOfODE2Coordinates=len(bounds), referenceCoordinates=still,
            initialCoordinates=still, initialCoordinates_t=[scene.velocity] * len(bounds),
        ))  # fmt: skip
        add_links(system, node, scene)
        fixed = system.AddMarker(itemInterface.MarkerNodeCoordinate(
            nodeNumber=system.AddNode(itemInterface.NodePointGround()), coordinate=0,
        ))  # fmt: skip
        for joint, bound in enumerate(bounds):
            marker = system.AddMarker(itemInterface.MarkerNodeCoordinate(nodeNumber=node, coordinate=joint))
            system.AddObject(itemInterface.CoordinateSpringDamperExt(
                markerNumbers=[fixed, marker], dynamicFrictionForce=bound, damping=scene.damping,
                **friction(system, setting),
            ))  # fmt: skip
            if isinstance(scene, JointScene):
                system.AddLoad(itemInterface.LoadCoordinate(markerNumber=marker, load=scene.load))
        sensor = system.AddSensor(itemInterface.SensorNode(
            nodeNumber=node, outputVariableType=exudyn.OutputVariableType.Coordinates,
            storeInternal=True, writeToFile=False,
        ))  # fmt: skip
        system.Assemble()

    def run(steps: int) -> FloatArray:
        nonlocal steps_taken
        settings, end = exudyn.SimulationSettings(), steps_taken + steps
        settings.solution.file.write = False
        # A little less than a step, for times in seconds add up with round-off.
        settings.solution.sensors.writePeriod = setting.time_step * (1 - 1e-6)
        integration = settings.timeIntegration
        integration.verboseMode = 0
        integration.startTime, integration.endTime = steps_taken * setting.time_step, end * setting.time_step
        integration.numberOfSteps = steps
        if setting.changed("discontinuous_iterations") is not None:
            integration.discontinuous.maxIterations = setting.changed("discontinuous_iterations")
        with silent(exudyn):
            system.SolveDynamic(settings)
        steps_taken = end
        data, kinds = system.systemData, exudyn.ConfigurationType
        data.SetSystemState(data.GetSystemState(configuration=kinds.Current), configuration=kinds.Initial)
        return np.asarray(system.GetSensorStoredData(sensor)[1:, 1:])

    return SolvedWorld(run=run, close=container.Reset)


def add_links(system: Any, node: int, scene: JointScene | ArmScene) -> None:
    """Add joints and links, of a tree without branches."""
    exudyn = import_exudyn()
    from exudyn import itemInterface

    kinds = exudyn.JointType
    if isinstance(scene, JointScene):
        joint = kinds.PrismaticX if scene.kind == "slide" else kinds.RevoluteZ
        number, gravity, inertia, centre = 1, 0.0, (1.0, 1.0, 1.0), 0.0
    else:
        joint = kinds.RevoluteY
        number, gravity, inertia, centre = scene.links, -GRAVITY, LINK_INERTIA, LINK_LENGTH / 2
    system.AddObject(itemInterface.ObjectKinematicTree(
        nodeNumber=node, gravity=[0.0, 0.0, gravity], jointTypes=[joint] * number,
        linkParents=np.arange(number) - 1,
        jointTransformations=exudyn.Matrix3DList([np.eye(3)] * number),
        jointOffsets=exudyn.Vector3DList([[LINK_LENGTH if link else 0.0, 0.0, 0.0] for link in range(number)]),
        linkInertiasCOM=exudyn.Matrix3DList([np.diag(inertia)] * number),
        linkCOMs=exudyn.Vector3DList([[centre, 0.0, 0.0]] * number),
        linkMasses=[LINK_MASS] * number,
    ))  # fmt: skip


def friction(system: Any, setting: SceneSetting) -> dict[str, Any]:
    """Give the law of a joint's friction: a zone, or a bristle with its own data."""
    from exudyn import itemInterface

    preset = setting.preset
    if "frictionProportionalZone" in preset.options:
        return {"frictionProportionalZone": preset["frictionProportionalZone"]}
    data = system.AddNode(itemInterface.NodeGenericData(initialCoordinates=[0.0] * 3, numberOfDataCoordinates=3))
    bristle = {name: preset[name] for name in ("stickingStiffness", "stickingDamping")}
    return {"nodeNumber": data, **bristle}
