"""Options of SAPIEN's presets as the arguments of its calls, in the units of the preset."""

from collections.abc import Mapping
from typing import Any

from engines.interface.presets import Preset
from engines.interface.reproducer import Reproducer
from engines.sapien.contact import contact_units
from engines.shared.box_geometry import PressedBoxes
from engines.shared.script_units import script_units
from engines.shared.units import Units
from reference_lcp.chain.simulation import Lane
from reference_lcp.chain.trajectory import State


def joint_numbers(lane: Lane, preset: Preset, _start: State) -> Mapping[str, Any]:
    """Give the options of the scene, of links and of joints."""
    return {
        **_scene(Units.named(preset["units"], lane), preset),
        "link_damping": preset["linear damping"],
        "link_speed": preset["max linear velocity"],
        "joint_speed": preset["max joint velocity"],
        "joint_friction": preset["joint friction"],
        "drive": preset["drive damping"],
    }


def contact_numbers(lane: Lane, preset: Preset, _start: State) -> Mapping[str, Any]:
    """Give the options of the scene, the inertia, and the geometry."""
    units = contact_units(preset["units"], lane)
    sizes = PressedBoxes.of(lane, units)
    geometry = {"box": sizes.box, "plate": sizes.plate, "spacing": sizes.spacing}
    return {**_scene(units, preset), "inertia": preset["inertia"], **geometry}


def _scene(units: Units, preset: Preset) -> Mapping[str, Any]:
    return {
        **script_units(units),
        "tgs": preset["enable_tgs"],
        "iterations": preset["solver_position_iterations"],
        "corrections": preset["solver_velocity_iterations"],
    }


JOINT = Reproducer("reproducer_joint.py.jinja", joint_numbers, own_units=True)
CONTACT = Reproducer("reproducer_contact.py.jinja", contact_numbers, own_units=True)
