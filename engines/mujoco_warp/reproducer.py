"""MuJoCo Warp's scripts: MuJoCo's models, in the units of the preset, and the steps of Warp."""

from collections.abc import Mapping
from typing import Any

from engines.interface.presets import Preset
from engines.interface.reproducer import Reproducer
from engines.mujoco import reproducer as mujoco_reproducer
from engines.mujoco.pressed_contact import light_units, pressed_harder
from engines.shared.units import Units
from reference_lcp.chain.simulation import Lane
from reference_lcp.chain.trajectory import State


def joint_numbers(lane: Lane, preset: Preset, start: State) -> Mapping[str, Any]:
    """Give the attributes of MuJoCo's model, and its units."""
    return mujoco_reproducer.joint_numbers(lane, preset, start, Units.named(preset["units"], lane))


def contact_numbers(lane: Lane, preset: Preset, start: State) -> Mapping[str, Any]:
    """Give the attributes of MuJoCo's model, and its units."""
    return mujoco_reproducer.contact_numbers(lane, preset, start, light_units(pressed_harder(lane, preset), preset))


JOINT = Reproducer("reproducer_joint.py.jinja", joint_numbers, own_units=True)
CONTACT = Reproducer("reproducer_contact.py.jinja", contact_numbers, own_units=True)
