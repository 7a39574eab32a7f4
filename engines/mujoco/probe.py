"""What creeps in a user's own model: as it is, and with the options of the presets ``recommended``.

Every contact pair and every joint with friction is watched that friction should hold by Coulomb's law.
"""

import copy
import math
import time as clock
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from multibody_xval.engines.interface.presets import Formulation, Preset
from multibody_xval.engines.interface.scene import SceneSetting
from multibody_xval.engines.mujoco.scene import JOINT_ATTRIBUTES, written
from multibody_xval.engines.mujoco.simulation import no_warning_file
from multibody_xval.engines.mujoco.step_model import damping_rate, relative_softness
from reference_lcp.errors import ParameterError, checked_path, shown
from reference_lcp.validation import FloatArray, checked_count, checked_scalar

AS_IT_IS, ALL = "as it is", "all"
"""Names of the model without the recipe, and with all lines of it."""

MARGIN = 1e-3
"""Part of the bound that friction leaves, at least, where it holds: solvers stop before a slip has all of it."""

RESTING = 0.1
"""A mean slip velocity beyond is a motion, and no creep [m/s], [rad/s]."""

BLOCKS, BLOCK_TIME = 8, 0.01
"""How often the cost of a step is taken, in turns, and for how long each time [s]; the least counts."""

ENUMERATIONS = {"cone": "mjtCone.mjCONE_", "solver": "mjtSolver.mjSOL_", "integrator": "mjtIntegrator.mjINT_"}
"""Of options that are words."""


class Act(NamedTuple):
    """Friction of one pair or joint in one step."""

    name: str
    unit: str
    load: float
    """Part of the bound of Coulomb's law."""
    force: float
    """[N] or [N m]."""
    slips: Sequence[FloatArray]
    """Slip velocities of its points."""
    row: tuple[str, int]
    """``dof`` or ``tendon`` or ``contact``, and its number."""


@dataclass
class Motion:
    """Friction of one pair or joint over a run."""

    unit: str
    row: tuple[str, int]
    steps: int = 0
    load: float = 0.0
    """The largest."""
    force: float = 0.0
    slips: list[FloatArray] = field(default_factory=list)
    """Sums over the steps."""

    def add(self, act: Act) -> None:
        """Take a step more."""
        self.steps += 1
        self.load = max(self.load, act.load)
        self.force += act.force
        self.slips += [np.zeros_like(slip) for slip in act.slips[len(self.slips) :]]
        for point, slip in enumerate(act.slips):
            self.slips[point] += slip

    @property
    def creep(self) -> float:
        """Mean slip velocity of the fastest point [m/s] or [rad/s]."""
        return max(float(np.linalg.norm(total)) for total in self.slips) / self.steps

    @property
    def held(self) -> bool:
        """Whether friction should hold by Coulomb's law."""
        return self.load < 1 - MARGIN and self.creep < RESTING


@dataclass(frozen=True)
class Creep:
    """What friction should hold: a pair of geoms, a joint or a tendon."""

    name: str
    unit: str
    load: float
    """Largest part of the bound, in the first line in which it is held."""
    creep: Mapping[str, float]
    """By line; NaN where it lost touch, or the model exploded."""
    law: Mapping[str, float]
    """What the law of a joint's friction predicts, by line; none of contacts and of what the law does not have."""


@dataclass(frozen=True)
class Probe:
    """What was measured in a model."""

    costs: Mapping[str, float]
    """Cost of a step, by line, over that of the model as it is; NaN where it exploded."""
    held: tuple[Creep, ...]


Recipe = Mapping[str, tuple[tuple[str, Any], ...]]
"""Options and values by line: none as it is, each alone, all."""


def probe(path: Path, presets: Sequence[Preset], time: float, settling: float) -> Probe:
    """Measure creep and cost of a model, as it is and with the options that `presets` change.

    Parameters
    ----------
    path
        MJCF, or URDF as MuJoCo reads it.
    time, settling
        How long the model is watched, and left alone before [s].

    Raises
    ------
    ParameterError
        If the model does not load, has no friction, explodes, or nothing in it rests.
    """
    checked_scalar("time", time, "> 0")
    checked_scalar("settling", settling, ">= 0")
    with no_warning_file():
        model = _loaded(path)
        steps = checked_count("steps", round(time / model.opt.timestep))
        lines = recipe_lines(presets, model.opt.timestep)
        models = {name: _with_options(model, options) for name, options in lines.items()}
        runs = {name: _run(own, round(settling / own.opt.timestep), steps) for name, own in models.items()}
        held = tuple(_held(models, {name: run.motions for name, run in runs.items()}, steps))
        _check(path, runs[AS_IT_IS], held, settling)
        return Probe(_costs(models, runs), held)


def recipe_lines(presets: Sequence[Preset], time_step: float) -> Recipe:
    """Give the lines of a recipe, named as they are written in MJCF."""
    lines = {}
    for preset in presets:
        setting = SceneSetting(preset, time_step)
        for name in preset.options:
            value = setting.changed(name)
            if value is not None:
                lines[f'{JOINT_ATTRIBUTES.get(name, name)}="{written(setting, name)}"'] = ((name, value),)
    return {AS_IT_IS: (), **lines, ALL: tuple(each for line in lines.values() for each in line)}


def recommended(presets: Mapping[Formulation, Mapping[str, Preset]]) -> list[Preset]:
    """Give the presets that a recipe is made of, contacts first."""
    return [presets[formulation]["recommended"] for formulation in (Formulation.CONTACT, Formulation.JOINT)]


def _loaded(path: Path) -> Any:
    """Load a model; what sleeps does not show whether it creeps."""
    import mujoco

    checked_path("MODEL", path)
    try:
        model = mujoco.MjModel.from_xml_path(str(path))
    except (ValueError, OSError, RuntimeError) as problem:
        reason = " ".join(str(problem).split())[:200]
        raise ParameterError(
            f"MODEL = {shown(path.name)} does not load: {reason}; allowed: MJCF or URDF as MuJoCo reads it"
        ) from None
    sleep = getattr(mujoco.mjtEnableBit, "mjENBL_SLEEP", None)
    if sleep is not None:
        model.opt.enableflags &= ~int(sleep)
    return model


def _with_options(model: Any, options: Sequence[tuple[str, Any]]) -> Any:
    """Give a copy of a model with options as the recipe says it in Python."""
    import mujoco

    changed = copy.copy(model)
    for name, value in options:
        if name == "solref_friction":
            changed.dof_solref[:], changed.tendon_solref_fri[:] = value, value
        elif name == "solimp_friction":
            changed.dof_solimp[:, :2], changed.tendon_solimp_fri[:, :2] = value, value
        elif name in ENUMERATIONS:
            kind, _, prefix = ENUMERATIONS[name].partition(".")
            setattr(changed.opt, name, getattr(getattr(mujoco, kind), f"{prefix}{value.upper()}"))
        else:
            setattr(changed.opt, name, value)
    return changed


@dataclass
class _Run:
    """A model that was watched."""

    data: Any
    motions: dict[str, Motion]
    exploded: float = math.nan
    """When [s]."""


def _run(model: Any, settling: int, steps: int) -> _Run:
    """Let a model settle and watch it, from its initial state with controls at zero."""
    import mujoco

    data, motions = mujoco.MjData(model), dict[str, Motion]()
    bad = [int(getattr(mujoco.mjtWarning, f"mjWARN_{name}")) for name in ("BADQPOS", "BADQVEL", "BADQACC")]
    for step in range(settling + steps):
        mujoco.mj_step(model, data)
        if any(data.warning.number[bad]):
            return _Run(data, {}, step * model.opt.timestep)
        if step >= settling:
            for act in (*_contacts(model, data), *_joints(model, data)):
                motions.setdefault(act.name, Motion(act.unit, act.row)).add(act)
    return _Run(data, motions)


def _contacts(model: Any, data: Any) -> Iterator[Act]:
    """Give the friction of all pairs of geoms that touch."""
    import mujoco

    pairs: dict[tuple[int, int], list[int]] = {}
    for index in np.flatnonzero((data.contact.efc_address >= 0) & (data.contact.dim > 1)):
        first, second = (int(geom) for geom in data.contact.geom[index])
        if min(first, second) >= 0 and data.contact.friction[index, 0] > mujoco.mjMINMU:
            pairs.setdefault((first, second), []).append(int(index))
    wrench = np.zeros(6)
    for (first, second), own in pairs.items():
        normal, tangential, part, slips = 0.0, 0.0, 0.0, []
        for contact in own:
            mujoco.mj_contactForce(model, data, contact, wrench)
            normal += wrench[0]
            tangential += float(np.hypot(*wrench[1:3]))
            part += float(np.hypot(*(wrench[1:3] / data.contact.friction[contact, :2])))
            slips.append(_slip(model, data, contact))
        if normal > 0:
            name = f"{_name(model, 'geom', first)} / {_name(model, 'geom', second)}"
            yield Act(name, "µm/s", part / normal, tangential, slips, ("contact", own[0]))


def _slip(model: Any, data: Any, index: int) -> FloatArray:
    """Give the velocity of a contact's second body on its first, in the plane of the contact [m/s]."""
    point, frame = data.contact.pos[index], data.contact.frame[index].reshape(3, 3)
    velocities = []
    for body in model.geom_bodyid[data.contact.geom[index]]:
        arm = point - data.subtree_com[model.body_rootid[body]]
        velocities.append(data.cvel[body, 3:] + np.cross(data.cvel[body, :3], arm))
    relative: FloatArray = velocities[1] - velocities[0]
    return relative - (relative @ frame[0]) * frame[0]


def _joints(model: Any, data: Any) -> Iterator[Act]:
    """Give the friction of all joints and tendons that have a frictionloss."""
    import mujoco

    kinds = {int(mujoco.mjtConstraint.mjCNSTR_FRICTION_DOF): "dof"}
    kinds[int(mujoco.mjtConstraint.mjCNSTR_FRICTION_TENDON)] = "tendon"
    for row in np.flatnonzero(np.isin(data.efc_type, list(kinds))):
        kind, number, force = kinds[int(data.efc_type[row])], int(data.efc_id[row]), float(data.efc_force[row])
        name, unit = _friction_name(model, kind, number)
        load = abs(force) / data.efc_frictionloss[row]
        yield Act(name, unit, load, force, [data.efc_vel[row : row + 1].copy()], (kind, number))


def _friction_name(model: Any, kind: str, number: int) -> tuple[str, str]:
    """Give the name and the unit of what has a frictionloss; joints with several have a number each."""
    import mujoco

    if kind == "tendon":
        return _name(model, "tendon", number), "µm/s"
    joint = model.dof_jntid[number]
    several = model.jnt_type[joint] in (mujoco.mjtJoint.mjJNT_FREE, mujoco.mjtJoint.mjJNT_BALL)
    own = number - model.jnt_dofadr[joint]
    slides = model.jnt_type[joint] == mujoco.mjtJoint.mjJNT_SLIDE
    slides |= model.jnt_type[joint] == mujoco.mjtJoint.mjJNT_FREE and own < 3
    name = _name(model, "joint", joint) + (f", {own + 1}" if several else "")
    return name, "µm/s" if slides else "µrad/s"


def _name(model: Any, kind: str, number: int) -> str:
    """Give the name of an element, or its number and the body that has it."""
    element = getattr(model, kind)(number)
    if element.name:
        return str(element.name) if kind == "geom" else f"{kind} {element.name}"
    if kind == "tendon":
        return f"tendon {number}"
    body = int(np.ravel(element.bodyid)[0])
    return f"{kind} {number} of {model.body(body).name or f'body {body}'}"


def _held(models: Mapping[str, Any], runs: Mapping[str, Mapping[str, Motion]], steps: int) -> Iterator[Creep]:
    """Give what is held in a line or more, with its creep in all."""
    whole = {
        line: {name: motion for name, motion in motions.items() if motion.steps == steps}
        for line, motions in runs.items()
    }
    for name in dict.fromkeys(name for motions in whole.values() for name in motions):
        own = {line: motions[name] for line, motions in whole.items() if name in motions}
        first = next((motion for motion in own.values() if motion.held), None)
        if first is not None:
            laws = {line: _law(models[line], motion) for line, motion in own.items()}
            creep = {line: own[line].creep if line in own else math.nan for line in runs}
            known = {line: value for line, value in laws.items() if value is not None}
            yield Creep(name, first.unit, first.load, creep, known)


def _law(model: Any, motion: Motion) -> float | None:
    """Give the creep that the law of a joint's friction predicts under the mean force, R λ / b."""
    import mujoco

    kind, dof = motion.row
    without = model.opt.noslip_iterations > 0 or model.opt.disableflags & int(mujoco.mjtDisableBit.mjDSBL_REFSAFE)
    if kind != "dof" or without or model.dof_solref[dof, 0] <= 0:
        return None
    least, largest = model.dof_solimp[dof, :2]
    softness = relative_softness(least) * model.dof_invweight0[dof]
    rate = damping_rate(model.dof_solref[dof, 0], largest, model.opt.timestep)
    return float(softness * abs(motion.force) / motion.steps / rate)


def _check(path: Path, installed: _Run, held: Sequence[Creep], settling: float) -> None:
    """Refuse a model in which there is nothing to measure."""
    problem = None
    if not math.isnan(installed.exploded):
        problem = f"explodes after {installed.exploded:.3g} s; allowed: one that MuJoCo simulates as it is"
    elif not installed.motions:
        problem = "has no friction that acts: no joint has a frictionloss, and nothing touches; allowed: one that rubs"
    elif not held:
        problem = f"does not rest after {settling:g} s: all that rubs slides; allowed: a longer --settling, or another"
    if problem is not None:
        raise ParameterError(f"MODEL = {shown(path.name)} {problem}")


def _costs(models: Mapping[str, Any], runs: Mapping[str, _Run]) -> dict[str, float]:
    """Time steps of all lines in turns."""
    import mujoco

    least, count = dict.fromkeys(models, math.inf), 1
    for _ in range(BLOCKS):
        for line, model in models.items():
            if math.isnan(runs[line].exploded):
                begin = clock.perf_counter()
                mujoco.mj_step(model, runs[line].data, count)
                least[line] = min(least[line], (clock.perf_counter() - begin) / count)
        count = max(count, math.ceil(BLOCK_TIME / least[AS_IT_IS]))
    return {line: own / least[AS_IT_IS] if math.isfinite(own) else math.nan for line, own in least.items()}
