"""Options of Box2D's presets as the arguments of its calls, in the units of the preset."""

import dataclasses
from collections.abc import Mapping
from typing import Any

from engines.box2d.bodies import SPRING_LENGTH
from engines.box2d.contact import CLEARANCE_OVER_SLOP, GAP_OVER_SLOP
from engines.box2d.contact import FINENESS as CONTACT_FINENESS
from engines.box2d.joint import FINENESS as JOINT_FINENESS
from engines.interface.presets import Preset
from engines.interface.reproducer import Reproducer
from engines.shared.box_geometry import PressedBoxes
from engines.shared.script_units import script_units
from engines.shared.units import Units, power_of_two
from reference_lcp.chain.simulation import Lane
from reference_lcp.chain.trajectory import State


def joint_numbers(lane: Lane, preset: Preset, _start: State) -> Mapping[str, Any]:
    """Give the arguments, and what rubs."""
    numbers = {"motor": preset["joint"] == "prismatic", "height": "0.0", "pressing": "[0.0] * 2 * cells"}
    return {**_world(lane, preset, _units(lane, preset, JOINT_FINENESS)), **numbers}


def contact_numbers(lane: Lane, preset: Preset, _start: State) -> Mapping[str, Any]:
    """Give the arguments, and the geometry: cells stand apart, and boxes on plates, by parts of linearSlop."""
    units = _units(lane, preset, CONTACT_FINENESS)
    sizes = PressedBoxes.of(lane, units)
    apart = f"({sizes.spacing} + {CLEARANCE_OVER_SLOP} * Box2D.b2_linearSlop)"
    return {
        **_world(lane, preset, units),
        "box": sizes.box,
        "plate": sizes.plate,
        "height": f"k % cells * {apart} + k // cells * {GAP_OVER_SLOP} * Box2D.b2_linearSlop",
        "pressing": "NORMAL_FORCE + [-force for force in NORMAL_FORCE]",
    }


def _units(lane: Lane, preset: Preset, fineness: float) -> Units:
    units = Units.named(preset["units"], lane)
    return units if preset["units"] == "SI" else dataclasses.replace(units, length=fineness * units.length)


def _world(lane: Lane, preset: Preset, units: Units) -> Mapping[str, Any]:
    scale = power_of_two(lane.drive.displacement_scale(lane.chain)) / units.length
    return {
        **script_units(units),
        "changed": not preset["warmStarting"] and not preset["AllowSleeping"],
        "springs": preset["springs"] == "distance joints",
        "length": SPRING_LENGTH * scale,
        "sweeps": preset["velocityIterations"],
        "corrections": preset["positionIterations"],
    }


JOINT = Reproducer("reproducer_joint.py.jinja", joint_numbers, own_units=True)
CONTACT = Reproducer("reproducer_contact.py.jinja", contact_numbers, own_units=True)
