"""The text of a scene in USD: of every lane an articulation, in which the heavier mass of a cell carries the other."""

from collections.abc import Sequence

from engines.interface.presets import Preset
from reference_lcp.validation import FloatArray

ARTICULATIONS = "/World/lane*"
"""Pattern of the paths of all articulations; their numbers have leading zeros, so that any order is that of lanes."""

STAGE = """#usda 1.0
(
    defaultPrim = "World"
    metersPerUnit = 1
    kilogramsPerUnit = 1
    upAxis = "Z"
)
def Xform "World"
{{
    def PhysicsScene "scene" (prepend apiSchemas = ["PhysxSceneAPI"])
    {{
        float physics:gravityMagnitude = 0
        uniform token physxScene:solverType = "{solver}"
        uniform token physxScene:broadphaseType = "MBP"
        bool physxScene:enableGPUDynamics = 0
    }}
{articulations}
}}
"""

ARTICULATION = """
    def Xform "{name}" (prepend apiSchemas = ["PhysicsArticulationRootAPI", "PhysxArticulationAPI"])
    {{
        int physxArticulation:solverPositionIterationCount = {positions}
        int physxArticulation:solverVelocityIterationCount = {velocities}
        def PhysicsFixedJoint "fixed"
        {{
            rel physics:body1 = <{path}/ground>
        }}
{links}
    }}
"""

LINK = """
        def Xform "{name}" (prepend apiSchemas = ["PhysicsRigidBodyAPI", "PhysicsMassAPI", "PhysxRigidBodyAPI"])
        {{
            float physics:mass = {mass!r}
            float3 physics:diagonalInertia = (1, 1, 1)
            point3f physics:centerOfMass = (0, 0, 0)
            float physxRigidBody:cfmScale = {softness}
        }}
"""

JOINT = """
        def PhysicsPrismaticJoint "joint_{child}" (prepend apiSchemas = ["PhysxJointAxisAPI:linear"])
        {{
            uniform token physics:axis = "X"
            rel physics:body0 = <{path}/{parent}>
            rel physics:body1 = <{path}/{child}>
        }}
"""


def stage_text(lanes: Sequence[tuple[FloatArray, FloatArray]], preset: Preset) -> str:
    """Give the text of a scene.

    Parameters
    ----------
    lanes
        Of every lane the masses that carry, and those that they carry, shape (n,) each, in its units.
    preset
        Solver, iterations and softness of links.
    """
    articulations = "".join(_articulation(index, *masses, preset) for index, masses in enumerate(lanes))
    return STAGE.format(solver=preset["solverType"], articulations=articulations)


def _articulation(index: int, carriers: FloatArray, carried: FloatArray, preset: Preset) -> str:
    """Give the articulation of a lane: its degrees of freedom are those of the carriers, then of what they carry."""
    name = f"lane{index:06d}"
    path = f"/World/{name}"
    links = [_link("ground", 1.0, preset)]
    for cell, masses in enumerate(zip(carriers.tolist(), carried.tolist(), strict=True)):
        names = f"a{cell:05d}", f"b{cell:05d}"
        for child, mass, parent in zip(names, masses, ("ground", names[0]), strict=True):
            links += [_link(child, mass, preset), JOINT.format(path=path, parent=parent, child=child)]
    return ARTICULATION.format(
        name=name,
        path=path,
        positions=preset["solverPositionIterationCount"],
        velocities=preset["solverVelocityIterationCount"],
        links="".join(links),
    )


def _link(name: str, mass: float, preset: Preset) -> str:
    return LINK.format(name=name, mass=mass, softness=preset["cfmScale"])
