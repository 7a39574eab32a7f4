"""What slides, since the load on its friction is above the limit: from when on, and how far."""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass

import numpy as np

from multibody_xval.engines.mujoco.probe.friction import MARGIN, RESTING, Act


@dataclass
class Slide:
    """How one pair or joint slides in a run."""

    unit: str
    """Of its slip velocity: µm/s or µrad/s."""
    first: float
    last: float
    """Times since the start, settling included [s]."""
    way: float = 0.0
    """While it touches and slides [m] or [rad]."""
    apart: bool = False
    """Whether nothing touches any more while the model is watched."""


def note_slides(slides: dict[str, Slide], acts: Iterable[Act], time: float, step: float) -> None:
    """Take what slides at a time, and its way in a step."""
    for act in acts:
        speed = max(float(np.linalg.norm(slip)) for slip in act.slips)
        if act.load >= 1 - MARGIN or speed >= RESTING:
            slide = slides.setdefault(act.name, Slide(act.unit, time, time))
            slide.last = time
            slide.way += speed * step


def overloaded(slides: Mapping[str, Slide], watched: Iterable[str], begin: float) -> dict[str, Slide]:
    """Give what still slides while the model is watched, or does not touch any more; the rest has settled."""
    touching = set(watched)
    for name, slide in slides.items():
        slide.apart = name not in touching
    return {name: slide for name, slide in slides.items() if slide.apart or slide.last >= begin}
