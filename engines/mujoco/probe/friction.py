"""Friction of contacts and joints in a model that runs: load, force and slip of one step, and their means."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any, NamedTuple

import numpy as np

from multibody_xval.engines.mujoco.softness import damping_rate, relative_softness
from reference_lcp.validation import FloatArray

MARGIN = 1e-3
"""Part of the bound that friction leaves, at least, where it holds, and that it takes, at least, where it is loaded."""

OVERLAP = 0.1
"""Depth beyond which bodies overlap, and no longer touch: a part of the smaller geom's radius."""

RESTING = 0.1
"""A mean slip velocity beyond is a motion, and no drift [m/s], [rad/s]."""


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


@dataclass(frozen=True)
class NotJudged:
    """What a model does at the start that is no drift."""

    overlaps: Mapping[frozenset[int], float] = field(default_factory=dict)
    """Depth by pair of geoms [m]."""
    own_base: frozenset[int] = frozenset()
    """Geoms of a robot that are welded to the world."""
    dofs: frozenset[int] = frozenset()
    """Of joints between bodies that overlap."""

    def skips(self, model: Any, first: int, second: int) -> bool:
        """Whether a contact says nothing about friction: of bodies that overlap, or of a robot with its own base."""
        return frozenset((first, second)) in self.overlaps or self.is_own_base(model, first, second)

    def is_own_base(self, model: Any, first: int, second: int) -> bool:
        """Whether one of two geoms is welded to the world and the other is of the same robot."""
        bodies = model.geom_bodyid[[first, second]]
        if self.own_base & {first, second}:
            return True
        return any(
            base != 0 and model.body_weldid[base] == 0 and base in ancestors(model, other)
            for base, other in (bodies, bodies[::-1])
        )


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
    def drift(self) -> float:
        """Mean slip velocity of the fastest point [m/s] or [rad/s]."""
        return max(float(np.linalg.norm(total)) for total in self.slips) / self.steps

    @property
    def loaded(self) -> bool:
        """Whether friction has something to hold."""
        return bool(self.load >= MARGIN)

    @property
    def held(self) -> bool:
        """Whether friction should hold by Coulomb's law."""
        return self.load < 1 - MARGIN and self.drift < RESTING


def ancestors(model: Any, body: int) -> set[int]:
    """Give a body and all that it hangs on, without the world."""
    found = set[int]()
    while body > 0:
        found.add(int(body))
        body = model.body_parentid[body]
    return found


def not_judged(model: Any, data: Any, own_base: frozenset[int]) -> NotJudged:
    """Find bodies that overlap, and the joints between them, where a model starts."""
    overlaps, dofs, welded = dict[frozenset[int], float](), set[int](), NotJudged(own_base=own_base)
    for (first, second), depth in zip(data.contact.geom.tolist(), -data.contact.dist, strict=True):
        if min(first, second) < 0 or welded.is_own_base(model, first, second):
            continue
        sizes = model.geom_rbound[[first, second]]
        if depth > OVERLAP * min(sizes[sizes > 0], default=np.inf):
            pair = frozenset((first, second))
            overlaps[pair] = max(depth, overlaps.get(pair, 0.0))
            one, other = (ancestors(model, model.geom_bodyid[geom]) for geom in (first, second))
            dofs |= set(np.flatnonzero(np.isin(model.dof_bodyid, list(one ^ other))).tolist())
    return NotJudged(overlaps, own_base, frozenset(dofs))


def contacts(model: Any, data: Any, skipped: NotJudged) -> Iterator[Act]:
    """Give the friction of all pairs of geoms that touch and are judged."""
    import mujoco

    pairs: dict[tuple[int, int], list[int]] = {}
    for index in np.flatnonzero((data.contact.efc_address >= 0) & (data.contact.dim > 1)):
        first, second = (int(geom) for geom in data.contact.geom[index])
        if min(first, second) >= 0 and data.contact.friction[index, 0] > mujoco.mjMINMU:
            pairs.setdefault((first, second), []).append(int(index))
    wrench = np.zeros(6)
    for (first, second), own in pairs.items():
        if skipped.skips(model, first, second):
            continue
        normal, tangential, part, slips = 0.0, 0.0, 0.0, []
        for contact in own:
            mujoco.mj_contactForce(model, data, contact, wrench)
            normal += wrench[0]
            tangential += float(np.hypot(*wrench[1:3]))
            part += float(np.hypot(*(wrench[1:3] / data.contact.friction[contact, :2])))
            slips.append(_slip(model, data, contact))
        if normal > 0:
            name = f"{element_name(model, 'geom', first)} / {element_name(model, 'geom', second)}"
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


def joints(model: Any, data: Any, skipped: NotJudged) -> Iterator[Act]:
    """Give the friction of all joints and tendons that have a frictionloss and are judged."""
    import mujoco

    kinds = {int(mujoco.mjtConstraint.mjCNSTR_FRICTION_DOF): "dof"}
    kinds[int(mujoco.mjtConstraint.mjCNSTR_FRICTION_TENDON)] = "tendon"
    for row in np.flatnonzero(np.isin(data.efc_type, list(kinds))):
        kind, number, force = kinds[int(data.efc_type[row])], int(data.efc_id[row]), float(data.efc_force[row])
        if kind == "dof" and number in skipped.dofs:
            continue
        name, unit = friction_name(model, kind, number)
        load = abs(force) / data.efc_frictionloss[row]
        yield Act(name, unit, load, force, [data.efc_vel[row : row + 1].copy()], (kind, number))


def friction_name(model: Any, kind: str, number: int) -> tuple[str, str]:
    """Give the name and the unit of what has a frictionloss; joints with several have a number each."""
    import mujoco

    if kind == "tendon":
        return element_name(model, "tendon", number), "µm/s"
    joint = model.dof_jntid[number]
    several = model.jnt_type[joint] in (mujoco.mjtJoint.mjJNT_FREE, mujoco.mjtJoint.mjJNT_BALL)
    own = number - model.jnt_dofadr[joint]
    slides = model.jnt_type[joint] == mujoco.mjtJoint.mjJNT_SLIDE
    slides |= model.jnt_type[joint] == mujoco.mjtJoint.mjJNT_FREE and own < 3
    name = element_name(model, "joint", joint) + (f", {own + 1}" if several else "")
    return name, "µm/s" if slides else "µrad/s"


def element_name(model: Any, kind: str, number: int) -> str:
    """Give the name of an element, or its number and the body that has it."""
    element = getattr(model, kind)(number)
    if element.name:
        return str(element.name) if kind == "geom" else f"{kind} {element.name}"
    if kind == "tendon":
        return f"tendon {number}"
    body = int(np.ravel(element.bodyid)[0])
    return f"{kind} {number} of {model.body(body).name or f'body {body}'}"


def predicted_drift(model: Any, motion: Motion) -> float | None:
    """Give the drift that MuJoCo's soft friction of a joint has under the mean force, R λ / b."""
    import mujoco

    kind, dof = motion.row
    without = model.opt.noslip_iterations > 0 or model.opt.disableflags & int(mujoco.mjtDisableBit.mjDSBL_REFSAFE)
    if kind != "dof" or without or model.dof_solref[dof, 0] <= 0:
        return None
    least, largest = model.dof_solimp[dof, :2]
    softness = relative_softness(least) * model.dof_invweight0[dof]
    rate = damping_rate(model.dof_solref[dof, 0], largest, model.opt.timestep)
    return float(softness * abs(motion.force) / motion.steps / rate)
