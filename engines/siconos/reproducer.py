"""Options of Siconos's presets as the arguments of its calls, in SI units."""

from collections.abc import Mapping
from typing import Any

from engines.interface.presets import Preset
from engines.interface.reproducer import Reproducer
from reference_lcp.chain.simulation import Lane
from reference_lcp.chain.trajectory import State

DEEP = 1e9
"""Depth of relays over the displacement scale, as in `server`, which nothing of the suite is imported in."""


def joint_numbers(lane: Lane, preset: Preset, _start: State) -> Mapping[str, Any]:
    """Give the settings of the scheme and of its solver, the depth of relays, and which springs are used."""
    return {
        **_scheme(preset),
        "own_springs": preset["springs"] == "own",
        "depth": DEEP * lane.drive.displacement_scale(lane.chain),
        "together": preset["interactions"] == "one a bound",
    }


def contact_numbers(lane: Lane, preset: Preset, _start: State) -> Mapping[str, Any]:
    """Give the settings of the scheme and of its solver, and the threshold of contacts."""
    tolerance, threshold = preset.options["tolerance"], preset.options["threshold"]
    return {
        **_scheme(preset),
        "tolerance": tolerance.value if tolerance.value != tolerance.default else None,
        "threshold": threshold.value * lane.drive.displacement_scale(lane.chain),
    }


def _scheme(preset: Preset) -> Mapping[str, Any]:
    return {"theta": preset["theta"], "linear": preset["newton"] == "linear", "solver": preset["solver"]}


JOINT = Reproducer("reproducer_joint.py.jinja", joint_numbers)
CONTACT = Reproducer("reproducer_contact.py.jinja", contact_numbers)
