"""Blocks in plain Exudyn: friction of a coordinate, by a zone of velocity or by bristles, both as its own examples."""

import contextlib
import io

from blocks import run

with contextlib.redirect_stdout(io.StringIO()):
    import exudyn as exu
    from exudyn import itemInterface as items


def simulated(block, bristle):
    container = exu.SystemContainer()  # older versions do not keep it
    system = container.AddSystem()
    node = system.AddNode(
        items.Node1D(referenceCoordinates=[0], initialCoordinates=[0], initialVelocities=[block.velocity])
    )
    system.AddObject(items.Mass1D(physicsMass=block.mass, nodeNumber=node))
    ground = system.AddNode(items.NodePointGround())
    markers = [system.AddMarker(items.MarkerNodeCoordinate(nodeNumber=each, coordinate=0)) for each in (ground, node)]
    friction = {"fDynamicFriction": block.bound, "fStaticFrictionOffset": 0.0}
    if bristle:
        data = items.NodeGenericData(initialCoordinates=[1, 0, 0], numberOfDataCoordinates=3)
        friction["nodeNumber"] = system.AddNode(data)
        friction.update(stickingStiffness=1e4, stickingDamping=1e1, frictionProportionalZone=0.0)
    else:
        friction["frictionProportionalZone"] = 1e-3
    system.AddObject(items.CoordinateSpringDamperExt(markerNumbers=markers, **friction))

    def pull(_, time, __):
        return block.pull(time / block.step)

    system.AddLoad(items.LoadCoordinate(markerNumber=markers[1], load=0.0, loadUserFunction=pull))
    sensors = [
        system.AddSensor(
            items.SensorNode(nodeNumber=node, storeInternal=True, writeToFile=False, outputVariableType=kind)
        )
        for kind in (exu.OutputVariableType.Coordinates, exu.OutputVariableType.Coordinates_t)
    ]
    system.Assemble()
    settings = exu.SimulationSettings()
    settings.timeIntegration.numberOfSteps = block.steps
    settings.timeIntegration.endTime = block.steps * block.step
    settings.timeIntegration.verboseMode = 0
    settings.solutionSettings.writeSolutionToFile = False
    settings.solutionSettings.sensorsWritePeriod = block.step
    with contextlib.redirect_stdout(io.StringIO()):
        system.SolveDynamic(settings)
    rows = [system.GetSensorStoredData(sensor)[1:, 1] for sensor in sensors]
    return list(zip(*rows))


run({"zone": lambda block, _: simulated(block, False), "bristle": lambda block, _: simulated(block, True)})
