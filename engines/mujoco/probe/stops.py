"""Joints that move at the start: when friction stops them, in a run and by Coulomb's law."""

import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from multibody_xval.engines.mujoco.probe.friction import RESTING, friction_name
from multibody_xval.engines.mujoco.softness import damping_rate
from reference_lcp.validation import FloatArray

STOPPED = 1e-3
"""Velocity below which a joint has stopped [m/s], [rad/s]."""

LATE = 0.5
"""Damping × step / inertia beyond which noslip stops a joint later than MuJoCo does without it, and so does the recipe
of joints without damping than one that knows of it."""

WRITTEN = 0.99
"""Part of the rate from which on a model has it already, in the direct form of solref."""

HARDEST = 0.9999
"""Both impedances of the recipe."""

ALONE = 1e-6
"""Part of the friction that all else may be where the exact time is known."""


@dataclass(frozen=True)
class Stop:
    """When friction stops a joint."""

    name: str
    exact: float
    """By Coulomb's law [s]; NaN where more than damping and friction acts on the joint."""
    times: Mapping[str, float]
    """By line [s]; infinite where it has not stopped until the end."""


def thrown(model: Any, data: Any) -> list[int]:
    """Give the degrees of freedom that have friction and move."""
    return np.flatnonzero((model.dof_frictionloss > 0) & (np.abs(data.qvel) > RESTING)).tolist()


def exact_time(model: Any, data: Any, dof: int) -> float:
    """Give the time in which constant friction and linear damping stop a joint that is alone [s]; NaN of others."""
    import mujoco

    column, unit = np.zeros(model.nv), np.zeros(model.nv)
    unit[dof] = 1.0
    mujoco.mj_mulM(model, data, column, unit)
    inertia, damping, friction = column[dof], model.dof_damping[dof], model.dof_frictionloss[dof]
    speed, way = abs(data.qvel[dof]), mujoco.MjData(model)
    ratio = damping * speed / friction
    time = inertia * speed / friction * (math.log1p(ratio) / ratio if ratio else 1.0)
    others = np.count_nonzero(column) > 1 or data.ncon > 0 or data.ne > 0
    for part in (0.0, 0.3, 0.7):  # a weight may act on the way that does not at the start
        way.qpos[:], way.qvel[:], way.ctrl[:], way.act[:] = data.qpos, data.qvel, data.ctrl, data.act
        mujoco.mj_integratePos(model, way.qpos, unit * data.qvel[dof], part * time)
        mujoco.mj_forward(model, way)
        others |= abs(way.qfrc_smooth[dof] + damping * data.qvel[dof]) > ALONE * friction
    return math.nan if others else time


def warnings(model: Any) -> Iterator[str]:
    """Say where damping makes friction stop joints late, and what to write."""
    for dof in damped(model):
        name, rate = friction_name(model, "dof", dof)[0], stopping_rate(model)[dof]
        step = model.opt.timestep
        ratio = rate * step - 1
        worse = f'; with "{2 * step:g} 1" it would stop later than as it is' if _stops_sooner(model, dof, ratio) else ""
        yield (
            f"Damping makes friction stop {name} late: damping × step / inertia is {ratio:.3g}, above {LATE}. "
            f'Give it solreffriction="{-rate:.6g} {-rate:.6g}" (1 / step + damping / inertia){worse}.'
        )
        if model.opt.noslip_iterations > 0:
            yield f'noslip_iterations="{model.opt.noslip_iterations}" stops {name} later: write noslip_iterations="0".'


def _stops_sooner(model: Any, dof: int, ratio: float) -> bool:
    """Tell whether friction as it is takes more of a slip in a step than the recipe of joints without damping does."""
    least, largest = model.dof_solimp[dof, :2]
    step, time_constant = model.opt.timestep, model.dof_solref[dof, 0]
    rate = damping_rate(time_constant, largest, step) if time_constant > 0 else -model.dof_solref[dof, 1] / largest
    recipe = _taken(HARDEST, damping_rate(2 * step, HARDEST, step) * step, ratio)
    return bool(_taken(least, rate * step, ratio) > recipe)


def _taken(least: float, part: float, ratio: float) -> float:
    """Give what is taken of a slip in a step, over 1 / (1 + ratio): soft friction hardly opposes damping."""
    return least * part + (1 - least) * ratio


def damped(model: Any) -> list[int]:
    """Give the degrees of freedom with friction that stop late, since MuJoCo applies much damping after friction."""
    import mujoco

    integrator, euler = model.opt.integrator, int(mujoco.mjtIntegrator.mjINT_EULER)
    explicit = integrator == mujoco.mjtIntegrator.mjINT_RK4 or (
        integrator == euler and model.opt.disableflags & int(mujoco.mjtDisableBit.mjDSBL_EULERDAMP)
    )
    rates = stopping_rate(model)
    late = (rates * model.opt.timestep - 1 > LATE) & (-model.dof_solref[:, 1] < WRITTEN * rates)
    return [] if explicit else np.flatnonzero((model.dof_frictionloss > 0) & late).tolist()


def stopping_rate(model: Any) -> FloatArray:
    """Give the rates with which friction stops slips within a step, damping or not [1/s]; shape (nv,).

    Damping acts after friction, and makes that part of a step 1 + damping × step / inertia times less.
    """
    rates: FloatArray = 1 / model.opt.timestep + model.dof_damping / model.dof_M0
    return rates
