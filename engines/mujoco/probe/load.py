"""Loading a model of the user: a floor where asked, a base that is free, and what keeps a URDF from loading."""

import itertools
import os
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any, NamedTuple
from xml.etree import ElementTree

import numpy as np

from multibody_xval.engines.interface.texts import checked_path
from reference_lcp.errors import ParameterError, shown

FLOOR = "added floor"

FAR = 100.0
"""Depth at which a floor begins to be raised, in units of length of the model."""

REPAIRS: tuple[Mapping[str, str], ...] = (
    {"balanceinertia": "true"},
    {"boundmass": "1e-6", "boundinertia": "1e-9"},
    {"inertiafromgeom": "true"},
)
"""Attributes of MuJoCo's compiler with which files load that other programs take."""


class Loaded(NamedTuple):
    """A model of the user."""

    model: Any
    controls_in_key: tuple[bool, ...]
    """Whether each keyframe names controls."""
    own_base: frozenset[int]
    """Geoms that a URDF has in the world: they are of the robot."""
    notes: tuple[str, ...]


def loaded(path: Path, floor: bool, free: bool) -> Loaded:
    """Load a model; what sleeps does not show whether it creeps."""
    import mujoco

    checked_path("MODEL", path)
    try:
        spec = mujoco.MjSpec.from_file(str(path))
        urdf = b"<robot" in path.read_bytes()
        if free:
            _set_free(spec, urdf)
        if floor:
            _add_floor(spec)
        model = spec.compile()
    except ParameterError:
        raise
    except (ValueError, OSError, RuntimeError) as problem:
        raise ParameterError(_refusal(path, problem)) from None
    sleep = getattr(mujoco.mjtEnableBit, "mjENBL_SLEEP", None)
    if sleep is not None:
        model.opt.enableflags &= ~int(sleep)
    world = np.flatnonzero(model.geom_bodyid == 0).tolist() if urdf else []
    own = frozenset(geom for geom in world if model.geom(geom).name != FLOOR)
    controls = tuple(len(key.ctrl) > 0 for key in spec.keys)
    return Loaded(model, controls, own, tuple(_notes(urdf, floor, free)))


def _notes(urdf: bool, floor: bool, free: bool) -> Iterator[str]:
    if urdf and not free:
        yield "MuJoCo welds the base of a URDF to the world; --free lets it move."
    if urdf and not floor:
        yield "A URDF has no floor; --floor puts one below it."


def _set_free(spec: Any, urdf: bool) -> None:
    """Give the bodies that a URDF welds to the world a free joint."""
    bodies = [body for body in spec.worldbody.bodies if not body.joints]
    if not urdf or not bodies:
        raise ParameterError("free = True needs a URDF with a base; allowed: without --free, MJCF says what is free")
    for body in bodies:
        body.add_freejoint()


def _add_floor(spec: Any) -> None:
    """Put a plane below the lowest point that collides, where the model starts."""
    import mujoco

    plane = mujoco.mjtGeom.mjGEOM_PLANE
    floor = spec.worldbody.add_geom(name=FLOOR, type=plane, size=[0, 0, 1], pos=[0, 0, -FAR], margin=2 * FAR)
    model = spec.compile()
    data = mujoco.MjData(model)
    if model.nkey:
        mujoco.mj_resetDataKeyframe(model, data, 0)
    mujoco.mj_forward(model, data)
    gaps = data.contact.dist[(data.contact.geom == model.geom(FLOOR).id).any(axis=1)]
    if not len(gaps):
        raise ParameterError(
            "floor = True meets nothing that collides; allowed: a model that could touch it, a URDF with --free"
        )
    floor.pos, floor.margin = [0, 0, min(gaps) - FAR], 0


def _refusal(path: Path, problem: Exception) -> str:
    """Say why a model does not load, and which line lets it."""
    reason = " ".join(str(problem).split())[:200]
    line = next(_lines_that_load(path), None)
    allowed = "MJCF or URDF as MuJoCo reads it" if line is None else f"with {line} in <robot> it loads"
    return f"MODEL = {shown(path.name)} does not load: {reason}; allowed: {allowed}"


def _lines_that_load(path: Path) -> Iterator[str]:
    """Try what the compiler may be told about a URDF, the shortest first."""
    import mujoco

    try:
        robot = ElementTree.parse(path).getroot()
    except (OSError, ElementTree.ParseError):
        return
    if robot.tag != "robot" or robot.find("mujoco") is not None:
        return
    compiler = ElementTree.SubElement(ElementTree.SubElement(robot, "mujoco"), "compiler")
    repairs = (*REPAIRS, *({"strippath": "true", "meshdir": folder} for folder in _mesh_folders(path, robot)))
    for count in (1, 2, 3):
        for chosen in itertools.combinations(repairs, count):
            attributes = {name: value for each in chosen for name, value in each.items()}
            folder = path.parent.resolve() / attributes.get("meshdir", "")
            compiler.attrib = {**attributes, "meshdir": str(folder)}
            try:
                mujoco.MjModel.from_xml_string(ElementTree.tostring(robot, encoding="unicode"))
            except (ValueError, RuntimeError):
                continue
            written = " ".join(f'{name}="{value}"' for name, value in attributes.items())
            yield f"<mujoco><compiler {written}/></mujoco>"


def _mesh_folders(path: Path, robot: ElementTree.Element) -> list[str]:
    """Give the folders, from that of the file, in which there are meshes that it names."""
    found = set()
    for mesh in robot.iterfind(".//collision/geometry/mesh"):
        parts = Path(mesh.get("filename", "").partition("://")[2] or mesh.get("filename", "")).parts
        for base, first in itertools.product(path.resolve().parents[:3], range(len(parts))):
            if base.joinpath(*parts[first:]).is_file():
                found.add(os.path.relpath(base.joinpath(*parts[first:]).parent, path.resolve().parent))
                break
    return sorted(found)
