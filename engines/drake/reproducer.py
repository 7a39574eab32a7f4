"""Options of Drake's presets as the arguments of its calls, in SI units."""

from collections.abc import Mapping
from typing import Any

import numpy as np

from engines.drake.contact import RADIUS, WIDTH
from engines.drake.sizes import contact_scale, sphere_depth, stiction_speed
from engines.interface.presets import Preset
from engines.interface.reproducer import Reproducer
from reference_lcp.chain.simulation import Lane
from reference_lcp.chain.trajectory import State


def joint_numbers(lane: Lane, preset: Preset, _start: State) -> Mapping[str, Any]:
    """Give the gain of every actuator [N s/m]."""
    chain = lane.chain
    if "PdControllerGains.d" in preset.options:
        return {"gain": np.full(chain.cells, preset["PdControllerGains.d"])}
    reduced = 1 / (1 / chain.outer_mass + 1 / chain.inner_mass)
    return {"gain": preset["d"] * reduced / lane.time_step}


def contact_numbers(lane: Lane, preset: Preset, _start: State) -> Mapping[str, Any]:
    """Give what differs from Drake's own, and sizes, depths and stiffnesses of the spheres."""
    chain, options = lane.chain, preset.options
    if "point_stiffness" in options:
        stiffness = np.full(chain.cells, preset["point_stiffness"])
        speed = preset["v_stiction"]
    else:
        stiffness = 2 * chain.normal_force / sphere_depth(lane, preset["depth"])  # of two equal springs in series
        speed = stiction_speed(lane, preset["stiction"])
    return {
        "model": _changed(preset, "contact_model"),
        "approximation": _changed(preset, "approximation"),
        "stiffness": stiffness,
        "dissipation": preset["hunt_crossley_dissipation"],
        "relaxation_time": preset["relaxation_time"] if "relaxation_time" in options else None,
        "stiction": speed,
        "radius": RADIUS * contact_scale(lane),
        "width": WIDTH * contact_scale(lane),
    }


def _changed(preset: Preset, name: str) -> Any:
    option = preset.options[name]
    return None if option.value == option.default else option.value


JOINT = Reproducer("reproducer_joint.py.jinja", joint_numbers)
CONTACT = Reproducer("reproducer_contact.py.jinja", contact_numbers)
