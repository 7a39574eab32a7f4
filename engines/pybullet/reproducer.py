"""Options of PyBullet's presets as the arguments of its calls, in SI units."""

from collections.abc import Mapping
from typing import Any

from engines.interface.presets import Preset
from engines.interface.reproducer import Reproducer
from engines.pybullet.contact import PLATE, REST_DEPTH, SPACING
from engines.shared.box_geometry import BOX
from engines.shared.units import power_of_two
from reference_lcp.chain.simulation import Lane
from reference_lcp.chain.trajectory import State


def joint_numbers(_lane: Lane, preset: Preset, _start: State) -> Mapping[str, Any]:
    """Give the arguments that differ from Bullet's own, and its damping: in single precision before it is set."""
    velocity = _changed(preset, "maxJointVelocity")
    damping = f"linearDamping={preset['linearDamping']}"
    return {"changed": f"{damping}, {velocity}" if velocity else damping}


def contact_numbers(lane: Lane, preset: Preset, _start: State) -> Mapping[str, Any]:
    """Give the arguments that differ from Bullet's own, and the geometry."""
    scale = power_of_two(lane.drive.displacement_scale(lane.chain))
    threshold = _changed(preset, "solverResidualThreshold")
    return {
        "engine_options": f"{threshold}, contactSlop={REST_DEPTH}" if threshold else f"contactSlop={REST_DEPTH}",
        "damping": preset["linearDamping"],  # bodies of maximal coordinates have none before it is set
        "box": BOX * scale,
        "plate": PLATE * scale,
        "spacing": SPACING * scale,
        "height": BOX * scale - REST_DEPTH,
    }


def _changed(preset: Preset, *names: str) -> str:
    options = {name: preset.options[name] for name in names}
    return ", ".join(f"{name}={option.value}" for name, option in options.items() if option.value != option.default)


JOINT = Reproducer("reproducer_joint.py.jinja", joint_numbers)
CONTACT = Reproducer("reproducer_contact.py.jinja", contact_numbers)
