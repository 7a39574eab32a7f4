"""MJX as it is served, with what tests look at in its process: it is imported there, where there is no pytest."""

import copy
from dataclasses import replace
from typing import Any

import numpy as np

from engines.interface.presets import Formulation, Option, Preset
from engines.mjx import MJX
from engines.mjx.presets import JOINT_TUNED
from engines.mjx.worlds import MJXWorlds
from engines.mujoco.contact import compiled_contacts, light_units
from engines.mujoco_warp.presets import CONTACT_TUNED
from engines.shared.worlds import Rows
from reference_lcp.chain.simulation import Lane
from reference_lcp.validation import FloatArray

TEN_ITERATIONS = replace(JOINT_TUNED, options={**JOINT_TUNED.options, "iterations": Option(10, 100, "Too few.")})

CONTACT = replace(
    CONTACT_TUNED,
    options={
        **CONTACT_TUNED.options,
        "noslip_iterations": Option(0, 0, "It has none."),
        "iterations": Option(100, 100, "MuJoCo's own."),
        "tolerance": Option(1e-20, 1e-8, "The solver ends where a step of it gains no more than round-off."),
        "jacobian": Option("dense", "auto", "The matrices are small."),
        "disable": Option(("eulerdamp", "warmstart"), (), "As in joints."),
    },
)
"""What would be MJX's contact: MuJoCo Warp's without a sweep, so that a ratio of impedances has to make it hard."""


class Probed:
    """A simulation of MJX that is looked into."""

    def __init__(self, simulation: Any):
        self._simulation = simulation

    def __getattr__(self, name: str) -> Any:
        return getattr(self._simulation, name)

    def compiled(self) -> int:
        """How many shapes of batches the steps are compiled for in this process."""
        return self._simulation._worlds._compiled.recorded_steps._cache_size()

    def without_and_with_sweeps(self, sweeps: int) -> tuple[Rows, Rows]:
        """Ten steps of the first lane, as its model is, and with sweeps without softness."""
        model = self._simulation._models[0]
        swept = copy.copy(model)
        swept.opt.noslip_iterations = sweeps
        return _ten_steps(model), _ten_steps(swept)

    def friction_of_contacts(self, impedance_ratio: float, steps: int) -> tuple[FloatArray, FloatArray]:
        """Friction over its bound in steps of the first lane, by MuJoCo, and by MJX from the same states."""
        import mujoco

        lane = self.lanes[0]
        model, force = _contact_model(lane)
        model.opt.impratio, model.opt.ls_iterations = impedance_ratio, 50
        data, before, friction = mujoco.MjData(model), [], []
        for load in lane.loads(0, steps) / force:
            data.ctrl = load
            before.append([values.copy() for values in (data.qpos, data.qvel, data.ctrl)])
            mujoco.mj_step(model, data)
            friction.append(data.qfrc_constraint[1::3].copy())
        bound = lane.chain.friction_bound / force
        return np.array(friction) / bound, _friction_by_mjx(model, *map(np.array, zip(*before, strict=True))) / bound


def _contact_model(lane: Lane) -> tuple[Any, float]:
    """Compile the lane with contacts; gives its unit of force too."""
    compiled = compiled_contacts(lane, CONTACT, units_of=light_units)
    return compiled.model, compiled.units.force


def _friction_by_mjx(model: Any, *before: FloatArray) -> FloatArray:
    """Take a step of MJX from each state; gives the friction in it."""
    import jax
    from mujoco import mjx

    put, blank = mjx.put_model(model), mjx.make_data(model)

    def friction(qpos: Any, qvel: Any, ctrl: Any) -> Any:
        return mjx.step(put, blank.replace(qpos=qpos, qvel=qvel, ctrl=ctrl)).qfrc_constraint[1::3]

    return np.array(jax.jit(jax.vmap(friction))(*before))


def _ten_steps(model: Any) -> Rows:
    worlds = MJXWorlds([model], False)
    worlds.set(*np.ones((2, 1, model.nv)))
    return worlds.steps(np.zeros((10, 1)), np.ones((10, 1, model.nv // 2)))


class ProbedMJX(MJX):
    """MJX with one preset more."""

    capabilities = replace(
        MJX.capabilities,
        presets={Formulation.JOINT: {**MJX.capabilities.presets[Formulation.JOINT], "ten iterations": TEN_ITERATIONS}},
    )

    def _build(self, lanes: tuple[Lane, ...], formulation: Formulation, preset: Preset) -> Any:
        return Probed(super()._build(lanes, formulation, preset))
