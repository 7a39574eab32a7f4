"""Options of Rapier's presets as its parameters, in the units of the preset."""

from collections.abc import Mapping
from typing import Any

from engines.interface.presets import Preset
from engines.interface.reproducer import Reproducer
from engines.rapier.contact import CLEARANCE
from engines.shared.box_geometry import PressedBoxes
from engines.shared.script_units import script_units
from engines.shared.units import Units
from reference_lcp.chain.simulation import Lane
from reference_lcp.chain.trajectory import State

CONTACT_OPTIONS = ("friction_in_bias_pass", "warmstart_coefficient", "contact_recycling")
"""Parameters of contacts."""


def joint_numbers(lane: Lane, preset: Preset, _start: State) -> Mapping[str, Any]:
    """Give the parameters that differ from Rapier's own, and the damping of motors."""
    numbers = {"damping": preset["motor factor"], "places": "", "pressing": "", "twice": False}
    return {**_world(Units.named(preset["units"], lane), preset), **numbers}


def contact_numbers(lane: Lane, preset: Preset, _start: State) -> Mapping[str, Any]:
    """Give the parameters that differ from Rapier's own, and the geometry."""
    units = Units.named(preset["units"], lane)
    sizes = PressedBoxes.of(lane, units)
    return {
        **_world(units, preset),
        "friction_model": preset["friction_model"],
        "changed": _changed(preset, CONTACT_OPTIONS),
        "box": sizes.box,
        "plate": sizes.plate,
        "spacing": sizes.spacing,
        "clearance": CLEARANCE,
        "places": f"k % cells * apart, {sizes.box} if k // cells else {-sizes.box}",
        "pressing": "[0.0] * cells + [-force for force in NORMAL_FORCE]",
        "twice": bool(preset["warmstart_coefficient"]),
    }


def _world(units: Units, preset: Preset) -> Mapping[str, Any]:
    tuned = _changed(preset, ("num_solver_iterations", "normalized_max_linear_velocity"))
    return {**script_units(units), "tuned": tuned}


def _changed(preset: Preset, names: tuple[str, ...]) -> str:
    """Give the values of options, one after the other; nothing where all are Rapier's own."""
    options = [preset.options[name] for name in names]
    changed = any(option.value != option.default for option in options)
    return ", ".join(repr(option.value) for option in options) if changed else ""


JOINT = Reproducer("reproducer_joint.py.jinja", joint_numbers, own_units=True)
CONTACT = Reproducer("reproducer_contact.py.jinja", contact_numbers, own_units=True)
