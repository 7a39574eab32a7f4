"""Scenes of Genesis: environments with one chain each, which take their steps together, each with its own numbers."""

import functools
import importlib
from collections.abc import Mapping
from typing import Any
from xml.etree import ElementTree

import numpy as np

from multibody_xval.engines.interface.presets import Preset
from multibody_xval.engines.mujoco.softness import WIDTH
from reference_lcp.validation import FloatArray

SOLVER_OPTIONS = (
    "integrator", "iterations", "tolerance", "noslip_iterations", "friction_cone", "contact_resolution", "impratio",
    "enable_adjacent_collision", "enable_neutral_collision",
)  # fmt: skip
"""Options of presets that Genesis's rigid solver takes under the same name."""

CHOICES = ("integrator", "friction_cone", "contact_resolution")
"""Options of which the value is the name of a choice of Genesis's."""

CANDIDATES = 150
"""Of contacts in a scene, Genesis's own; more where the chain has more cells."""

FREE_STRIDE = 4
"""Coordinates of a cell whose inner mass is free across the row: the last one is how far that is above."""

REST = (WIDTH, 0.5, 2.0)
"""Width [m], midpoint and power of Genesis's constraints, behind d_0 and d_max: MuJoCo's `solimp`."""


class Chains:
    """Environments that hold one chain each, with a time step that they share.

    In each cell, coordinates are those of the outer mass, of the inner one relative to it and, where that is free
    across the row, how far it is aside and above. `model` is the chain as an MJCF model of unit masses, with bodies
    ``outer 0``, ``inner 0``, ``outer 1``, …; `masses`, shape (environments, 2n), are those of all bodies.
    """

    def __init__(self, model: ElementTree.Element, masses: FloatArray, time_step: float, preset: Preset):
        genesis = import_genesis()
        environments, self._bodies = masses.shape
        self._scene = genesis.Scene(
            show_viewer=False,
            sim_options=genesis.options.SimOptions(dt=time_step, substeps=1, gravity=(0, 0, 0)),
            rigid_options=genesis.options.RigidOptions(
                batch_links_info=True, batch_joints_info=True, batch_dofs_info=True, enable_joint_limit=False,
                max_collision_pairs=max(CANDIDATES, self._bodies),
                **as_choices({name: preset[name] for name in SOLVER_OPTIONS if name in preset.options}),
            ),
        )  # fmt: skip
        self._chain = self._scene.add_entity(genesis.morphs.MJCF(file=model))
        self._scene.build(n_envs=environments)
        names = [f"{kind} {cell}" for cell in range(self._bodies // 2) for kind in ("outer", "inner")]
        self._joints = [joint.get("name") for joint in model.iter("joint")]
        self._stride = 2 * len(self._joints) // self._bodies
        self._links = [self._chain.get_link(name).idx_local for name in names]
        numbers = [self._chain.get_joint(name).dofs_idx_local[0] for name in self._joints]
        assert numbers == list(range(len(numbers))), "joints in this order"
        self._chain.set_dofs_armature(_tensor(np.zeros((environments, len(numbers)))))
        self._chain.set_links_mass(_tensor(masses), self._links)
        self._pressing = np.zeros((environments, self._bodies // 2))
        self.close = self._scene.destroy

    def set_joint_constraints(self, parameters: FloatArray) -> None:
        """Set the parameters of the constraints that the frictions of joints are, shape (environments, 7)."""
        for joint in self._joints:
            self._chain.get_joint(joint).set_sol_params(_tensor(parameters)[:, None])

    def set_bounds(self, bounds: FloatArray) -> None:
        """Set the bound of the friction of every joint of an inner mass, shape (environments, n)."""
        frictionloss = np.zeros((len(bounds), self._bodies))
        frictionloss[:, 1::2] = bounds
        self._chain.set_dofs_frictionloss(_tensor(frictionloss))

    def press(self, forces: FloatArray) -> None:
        """Set what presses the inner masses that are free across the row in the next step, shape (environments, n)."""
        self._pressing = forces

    def set_contact_constraints(self, parameters: FloatArray) -> None:
        """Set the parameters of the contact of every cell, those of all environments, shape (n, 7)."""
        for body, link in enumerate(self._links):
            for geometry in self._chain.links[link].geoms:
                geometry.set_sol_params(_tensor(parameters[body // 2]))

    def set_coefficients(self, coefficients: FloatArray) -> None:
        """Set the coefficient of friction of every contact, shape (environments, n)."""
        self._chain.set_friction_ratio(_tensor(np.repeat(coefficients, 2, axis=1)), self._links)

    def set_motion(self, coordinates: FloatArray, velocities: FloatArray) -> None:
        """Give every environment a motion, shape (environments, coordinates) each, and nothing that it had before."""
        self._chain.set_dofs_position(_tensor(coordinates), zero_velocity=False)
        self._chain.set_dofs_velocity(_tensor(velocities))

    def step(self, forces: FloatArray | None = None) -> FloatArray:
        """Take a step under forces, shape (environments, coordinates); gives coordinates, then velocities."""
        if forces is not None:
            if self._stride == FREE_STRIDE:
                forces = forces.copy()
                forces[:, 3::FREE_STRIDE] = -self._pressing
            self._chain.control_dofs_force(_tensor(forces))
        self._scene.step()
        return np.concatenate([self._chain.get_dofs_position(), self._chain.get_dofs_velocity()], axis=1)

    def friction(self, forces: FloatArray) -> FloatArray:
        """Give the friction on the inner masses in the step that was taken under these forces."""
        return (self._chain.get_dofs_force().numpy() - forces)[:, 1 :: self._stride]

    def normal_force(self) -> FloatArray:
        """Give the normal force on the inner masses in the step that was taken."""
        return self._chain.get_links_net_contact_force().numpy()[:, self._links[1::2], 2]


def constraint_parameters(time_constant: float, ratio: float, impedance: tuple[float, float]) -> FloatArray:
    """Give the seven parameters of a constraint: MuJoCo's `solref`, then its `solimp`."""
    return np.array([time_constant, ratio, *impedance, *REST])


def chain_model(
    cells: int, shapes: Mapping[int, tuple[str, str, float]] | None = None, *, free: bool = False
) -> ElementTree.Element:
    """Give an MJCF model of a chain of unit masses without springs.

    `shapes` are geoms of the outer and inner mass of a cell, and how far it is aside; if `free`, inner masses slide
    across the row too.
    """
    mass = '<inertial pos="0 0 0" mass="1" diaginertia="1 1 1"/>'
    bodies = []
    for cell in range(cells):
        plate, sphere, aside = (shapes or {}).get(cell, ("", "", 0.0))
        joints = {f"inner {cell}": "1 0 0"} | ({f"aside {cell}": "0 1 0", f"above {cell}": "0 0 1"} if free else {})
        inner = f'<body name="inner {cell}">{mass}{_slides(joints)}{sphere}</body>'
        outer = f'name="outer {cell}" pos="0 {aside!r} 0"'
        bodies.append(f"<body {outer}>{mass}{_slides({f'outer {cell}': '1 0 0'})}{inner}{plate}</body>")
    return ElementTree.fromstring(f"<mujoco><worldbody>{''.join(bodies)}</worldbody></mujoco>")


def _slides(axes: Mapping[str, str]) -> str:
    return "".join(f'<joint name="{name}" type="slide" axis="{axis}"/>' for name, axis in axes.items())


def _tensor(values: FloatArray) -> Any:
    return importlib.import_module("torch").from_numpy(np.ascontiguousarray(values, np.float64))


def as_choices(options: Mapping[str, Any]) -> dict[str, Any]:
    """Give options as Genesis takes them: choices are its own, of these names."""
    genesis = import_genesis()
    chosen = {name: getattr(getattr(genesis, name), options[name]) for name in CHOICES if options.get(name)}
    return {**options, **chosen}


@functools.cache
def import_genesis() -> Any:
    """Import Genesis, and start it once in this process: on the processor, one thread, in double precision."""
    importlib.import_module("torch").set_num_threads(1)
    genesis = importlib.import_module("genesis")
    genesis.init(backend=genesis.cpu, precision="64", logging_level="error")
    return genesis
