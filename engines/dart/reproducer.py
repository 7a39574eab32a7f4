"""Options of DART's presets as the arguments of its calls, in SI units."""

from collections.abc import Mapping
from typing import Any

from engines.dart.contact import DEPTH
from engines.interface.presets import Preset
from engines.interface.reproducer import Reproducer
from engines.shared.box_geometry import PressedBoxes
from engines.shared.units import Units
from reference_lcp.chain.simulation import Lane
from reference_lcp.chain.trajectory import State


def joint_numbers(_lane: Lane, preset: Preset, _start: State) -> Mapping[str, Any]:
    """Give whether bodies may be put to sleep, and whether the joints have the springs."""
    return {"awake": not preset["deactivation"], "own_springs": preset["springs"] == "of the joints"}


def contact_numbers(lane: Lane, preset: Preset, _start: State) -> Mapping[str, Any]:
    """Give whether bodies may be put to sleep, and shapes and sizes."""
    sizes = PressedBoxes.of(lane, Units.named("SI", lane))
    return {
        "awake": not preset["deactivation"],
        "sphere": preset["shape"] == "sphere",
        "half": sizes.box,
        "plate": 2 * sizes.plate,
        "spacing": sizes.spacing,
        "height": (2 - DEPTH) * sizes.box,
    }


JOINT = Reproducer("reproducer_joint.py.jinja", joint_numbers)
CONTACT = Reproducer("reproducer_contact.py.jinja", contact_numbers)
