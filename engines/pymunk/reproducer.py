"""Options of pymunk's presets as the settings of its space, its bodies and its joints, in SI units."""

from collections.abc import Mapping
from typing import Any

from engines.interface.presets import Preset
from engines.interface.reproducer import Reproducer
from engines.pymunk.bodies import SPRING_LENGTH
from engines.pymunk.contact import DEPTH
from engines.shared.box_geometry import PressedBoxes
from engines.shared.script_units import SI
from engines.shared.units import power_of_two
from reference_lcp.chain.simulation import Lane
from reference_lcp.chain.trajectory import State


def joint_numbers(lane: Lane, preset: Preset, _start: State) -> Mapping[str, Any]:
    """Give the settings that differ from pymunk's own."""
    numbers = {"max_bias": preset["max_bias"], "height": "0.0", "pressing": "[0.0] * 2 * cells"}
    return {**_bodies(lane, preset), **numbers}


def contact_numbers(lane: Lane, preset: Preset, _start: State) -> Mapping[str, Any]:
    """Give the settings that differ from pymunk's own, and the geometry."""
    sizes, depth = PressedBoxes.of(lane, SI), DEPTH * PressedBoxes.of(lane, SI).box
    if preset["units"] != "SI":  # deeper ones are pushed out here, and not in the units of the lane
        depth = min(depth, preset["collision_slop"] / 2)
    return {
        **_bodies(lane, preset),
        "box": sizes.box,
        "plate": sizes.plate,
        "height": f"k % cells * {sizes.spacing} - k // cells * {depth}",
        "pressing": "[*NORMAL_FORCE, *(-np.array(NORMAL_FORCE))]",
    }


def _bodies(lane: Lane, preset: Preset) -> Mapping[str, Any]:
    scale = power_of_two(lane.drive.displacement_scale(lane.chain))
    return {
        "iterations": preset["iterations"],
        "lag": preset["positions"] == "of the step before",
        "springs": preset["springs"] == "damped springs",
        "length": SPRING_LENGTH * scale,
    }


JOINT = Reproducer("reproducer_joint.py.jinja", joint_numbers)
CONTACT = Reproducer("reproducer_contact.py.jinja", contact_numbers)
