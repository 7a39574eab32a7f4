"""Joints that move at the start: when friction stops them, in a run and by Coulomb's law."""

import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from multibody_xval.engines.mujoco.probe.friction import RESTING, friction_name

STOPPED = 1e-3
"""Velocity below which a joint has stopped [m/s], [rad/s]."""

LATE = 0.5
"""Damping × step / inertia beyond which noslip stops a joint later than MuJoCo does without it."""

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
    """Say where noslip meets damping: it then stops joints late."""
    if model.opt.noslip_iterations > 0:
        ratio = model.dof_damping * model.opt.timestep / model.dof_M0
        for dof in np.flatnonzero((model.dof_frictionloss > 0) & (ratio > LATE)).tolist():
            name = friction_name(model, "dof", dof)[0]
            yield f"noslip_iterations stops {name} late: damping × step / inertia is {ratio[dof]:.3g}, above {LATE}."
