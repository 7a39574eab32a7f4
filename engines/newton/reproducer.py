"""Options of Newton's presets as the arguments of its calls, in the units of the preset."""

from collections.abc import Mapping
from typing import Any

from engines.interface.presets import Preset
from engines.interface.reproducer import Reproducer
from engines.newton.contact import ContactWorlds
from engines.shared.box_geometry import PressedBoxes
from engines.shared.script_units import script_units
from engines.shared.units import Units
from reference_lcp.chain.simulation import Lane
from reference_lcp.chain.trajectory import State


def joint_numbers(lane: Lane, preset: Preset, _start: State) -> Mapping[str, Any]:
    """Give the options of drives."""
    own = script_units(Units.in_steps(preset["units"], lane))
    return {**own, "mode": preset["drive_mode"], "damping": preset["target_kd"], "pressed": False}


def contact_numbers(lane: Lane, preset: Preset, _start: State) -> Mapping[str, Any]:
    """Give the option of contacts, and the radius of spheres."""
    units = Units.in_steps(preset["units"], lane)
    radius = PressedBoxes.of(lane, units).box
    rows = ContactWorlds.rows_of_a_cell * lane.chain.cells
    options = {"beta": preset["friction_anchor_beta"], "radius": radius, "rows": rows, "pressed": True}
    return {**script_units(units), **options}


JOINT = Reproducer("reproducer_joint.py.jinja", joint_numbers, own_units=True)
CONTACT = Reproducer("reproducer_contact.py.jinja", contact_numbers, own_units=True)
