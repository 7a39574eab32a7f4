"""The motion of a small scene, in an engine as its users call it."""

import json
import math
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cache, cached_property
from typing import Any, ClassVar

from pydantic import TypeAdapter

from multibody_xval.engines.interface.scene import ArmScene, ContactScene, JointScene, Scene, Vector, formulation_of
from reference_lcp.validation import checked_scalar

SCENES: dict[str, Any] = {"boxes": ContactScene, "joint": JointScene, "arm": ArmScene}
"""Scenes by what plain data call them."""


@dataclass(frozen=True, kw_only=True)
class Tone:
    """A force on a box that swings as a sine, from the start."""

    force: float
    """Its amplitude, along the box's own x axis [N]."""
    frequency: float
    """[Hz]."""

    def __post_init__(self) -> None:
        checked_scalar("force", self.force)
        checked_scalar("frequency", self.frequency, "> 0")


def swinging(tones: Sequence[Tone], time: float) -> float:
    """Give the force of tones at a time [N]."""
    return sum(tone.force * math.sin(2 * math.pi * tone.frequency * time) for tone in tones)


@dataclass(frozen=True, kw_only=True)
class SceneMotion:
    """One scene: how long it is left alone, launched and followed."""

    kind: ClassVar[str] = "scene"
    cells: ClassVar[int] = 0
    scene: Scene
    time: float
    """How long the motion is followed, after settling and launch [s]."""
    settling: float = 0.0
    """How long the scene is left alone before [s]."""
    launch: Vector = (0.0, 0.0, 0.0)
    """Velocity that the followed box then gets, along the plane, across and off it [m/s]."""
    spin: float = 0.0
    """Angular velocity about the vertical that it then gets [rad/s]."""
    push: float = 0.0
    """Constant force along the box's own x axis that then begins to act on it [N]."""
    drive: float = 0.0
    """Speed along the box's own x axis at which a force then keeps it, see `compute.driven` [m/s]."""
    sleeping: bool = False
    """Bodies may be put to sleep, as far as the engine does so as it comes."""
    shake: tuple[Tone, ...] = ()
    """Forces on the followed box, or on its shaker, from the start to the end."""

    def __post_init__(self) -> None:
        checked_scalar("time", self.time, "> 0")
        checked_scalar("settling", self.settling, ">= 0")

    def __hash__(self) -> int:
        return hash(self._text)

    @cached_property
    def _text(self) -> str:
        return json.dumps(self.as_data())

    def as_data(self) -> dict[str, Any]:
        """Give plain data, without what is as it usually is."""
        data = _adapter(SceneMotion).dump_python(self, mode="json", exclude_defaults=True)
        name = next(name for name, own in SCENES.items() if isinstance(self.scene, own))
        return {"kind": self.kind, "of": name, **data}

    @property
    def formulation(self) -> str:
        """Where the friction acts."""
        return str(formulation_of(self.scene))

    @property
    def title(self) -> str:
        """What it is of, and for how long."""
        return f"{self.kind} of {self.as_data()['of']}, {self.time:.4g} s"


def scene_motion_of(data: dict[str, Any]) -> SceneMotion:
    """Read what `SceneMotion.as_data` gives, out of JSON."""
    values = {name: value for name, value in data.items() if name not in ("kind", "of", "scene")}
    scene = _adapter(SCENES[data["of"]]).validate_python(data["scene"])
    motion: SceneMotion = _adapter(SceneMotion).validate_python({**values, "scene": scene})
    return motion


@cache
def _adapter(of: Any) -> TypeAdapter[Any]:
    return TypeAdapter(of)
