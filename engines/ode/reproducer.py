"""Options of ODE's presets as the arguments of its calls, in SI units."""

from collections.abc import Mapping
from typing import Any

from engines.interface.presets import Preset
from engines.interface.reproducer import Reproducer
from reference_lcp.chain.simulation import Lane
from reference_lcp.chain.trajectory import State

BOX, PLATE, SPACING = 4.0, 2.0**20, 32.0
"""Sizes over the displacement scale, as in `server`, which nothing of the suite is imported in: half of a box's edge,
half of a plate's length, and the distance of cells."""


def joint_numbers(_lane: Lane, preset: Preset, _start: State) -> Mapping[str, Any]:
    """Give the softness where it is not ODE's own, and which springs are used."""
    return {"cfm": _changed(preset, "cfm"), "stops": preset["springs"] == "stops"}


def contact_numbers(lane: Lane, preset: Preset, _start: State) -> Mapping[str, Any]:
    """Give the softness and the layer where they are not ODE's own, and shapes, sizes and inertia."""
    options = preset if lane.preload is None else preset.modulated()
    scale = lane.drive.displacement_scale(lane.chain)
    layer = _changed(options, "surface_layer")
    return {
        "cfm": _changed(options, "cfm"),
        "surface_layer": None if layer is None else layer * scale,
        "sphere": options["shape"] == "sphere",
        "half": BOX * scale,
        "plate": 2 * PLATE * scale,
        "spacing": SPACING * scale,
        "depth": options["depth"] * scale,
        "inertia": options["inertia"] * (BOX * scale) ** 2,
        "mode": options["mode"],
    }


def _changed(preset: Preset, name: str) -> Any:
    option = preset.options[name]
    return None if option.value == option.default else option.value


JOINT = Reproducer("reproducer_joint.py.jinja", joint_numbers)
CONTACT = Reproducer("reproducer_contact.py.jinja", contact_numbers)
