"""An instance of PhysX that holds one scene: its text in USD, how it is made, set, stepped and read."""

import functools
import importlib
import tempfile
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

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
    """Give the text of a scene; `lanes` are the masses that carry, and those that they carry, shape (n,) each."""
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


SingleArray = NDArray[np.float32]

ORDINAL = 1
"""Of the one state of the stage that is ever read: what moves is PhysX's alone."""


class Scene:
    """Articulations of one structure, made of a text in USD, which take their steps together.

    The first scene of a process decides for all how many `threads` PhysX has beside this one.
    """

    def __init__(self, text: str, threads: int, time_step: float):
        physx = import_ovphysx(threads)
        self._time_step = time_step
        self._physx, self._stage = physx.PhysX(), _stage(text)
        self._physx.wait_task(self._physx.attach_ovstage(self._stage, read_ordinal=ORDINAL))
        self._physx.warmup()
        self._physx.wait_all()
        self._bindings: list[Any] = []
        self._position, self._velocity = self._bound("POSITION"), self._bound("VELOCITY")
        self._force, self._joint_force = self._bound("ACTUATION_FORCE"), self._bound("PROJECTED_JOINT_FORCE")
        self._friction = self._bound("FRICTION_PROPERTIES")
        self._rows = [np.zeros(self._position.shape, np.float32) for _ in range(3)]

    def _bound(self, quantity: str) -> Any:
        kind = getattr(importlib.import_module("ovphysx.types").TensorType, f"ARTICULATION_DOF_{quantity}")
        binding = self._physx.create_tensor_binding(pattern=ARTICULATIONS, tensor_type=kind, raise_if_empty=True)
        self._bindings.append(binding)
        return binding

    def set_motion(self, position: FloatArray, velocity: FloatArray) -> None:
        """Give every lane a motion, shape (lanes, 2n) each."""
        self._position.write(position.astype(np.float32))
        self._velocity.write(velocity.astype(np.float32))

    def set_friction(self, bounds: FloatArray) -> None:
        """Set the bound of the friction of what is carried, shape (lanes, n), static and dynamic."""
        properties = np.zeros(self._friction.shape, np.float32)
        properties[:, bounds.shape[1] :, :2] = bounds[..., None]
        self._friction.write(properties)

    def step(self, force: FloatArray) -> FloatArray:
        """Take one step under generalised forces, shape (lanes, 2n); gives coordinates, then velocities."""
        self._force.write(force.astype(np.float32))
        self._physx.step_sync(self._time_step)
        for binding, row in zip((self._position, self._velocity), self._rows, strict=False):
            binding.read(row)
        return np.hstack(self._rows[:2]).astype(np.float64)

    def read_joint_force(self) -> SingleArray:
        """Read what acted along the joints in the last step, shape (lanes, 2n): friction, and what was given."""
        self._joint_force.read(self._rows[2])
        return self._rows[2]

    def native_steps(self, steps: int) -> None:
        """Take steps of PhysX alone."""
        for _ in range(steps):
            self._physx.step_sync(self._time_step)

    def close(self) -> None:
        """Free what PhysX holds; Python would free it in any order."""
        for binding in self._bindings:
            binding.destroy()
        self._physx.wait_task(self._physx.detach_ovstage())
        self._physx.destroy()
        self._stage.destroy()


def _stage(text: str) -> Any:
    """Give the stage of a text, which ovstage takes from a file only."""
    ovstage = importlib.import_module("ovstage")
    stage = ovstage.Stage("scene")
    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder) / "scene.usda"
        file.write_text(text)
        ovstage.population.open_usd(stage, str(file), ordinal=ORDINAL, domains=ovstage.PopulationDomain.ALL)
    stage.advance_write_floor(ordinal=ORDINAL).wait()
    return stage


@functools.cache
def import_ovphysx(threads: int) -> Any:
    """Import ovphysx for the processor alone, and let the stage know what PhysX adds to USD."""
    ovphysx = importlib.import_module("ovphysx")
    types = importlib.import_module("ovphysx.types")
    keys = types.GlobalConfigKey
    ovphysx.set_global_config(keys.LOG_LEVEL, int(types.LogLevel.ERROR))
    ovphysx.set_global_config(keys.NUM_THREADS, threads)
    ovphysx.set_global_config(keys.DISABLE_CONTACT_PROCESSING, True)
    ovphysx.PhysX.set_cpu_mode(True)
    support = importlib.import_module("ovphysx.samples.python_samples.schema_support")
    schemas = [*support.physx_schema_paths(), ovphysx.newton_schema_root()]
    importlib.import_module("ovstage").population.register_usd_schemas([str(path) for path in schemas])
    return ovphysx
