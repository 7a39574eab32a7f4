"""Contacts that are pressed harder, with a smaller coefficient of friction, for the same bounds.

What friction adds to the normal force goes with the square of the coefficient.
"""

from dataclasses import replace

import numpy as np

from engines.interface.presets import Preset
from engines.mujoco.contact import contact_units
from engines.shared.units import Units, power_of_two
from reference_lcp.chain.simulation import Lane
from reference_lcp.validation import FloatArray


def light_units(lane: Lane, preset: Preset) -> Units:
    """Choose units in which the masses that contacts stop are near one: single precision takes small ones for none."""
    units, chain = contact_units(lane, preset), lane.chain
    if preset["units"] == "SI":
        return units
    stopped = 1 / (1 / chain.outer_mass + 1 / chain.inner_mass)
    return replace(units, mass=power_of_two(float(np.exp(np.mean(np.log(stopped))))))


def normal_share(lane: Lane, pressed: Lane) -> FloatArray:
    """Give λ_N of each cell over that with which its contact is pressed, shape (n,); one where it does not rub."""
    rubs, given = lane.chain.friction_bound > 0, lane.chain.normal_force
    return np.divide(given, pressed.chain.normal_force, where=rubs, out=np.ones(rubs.size))


def pressed_harder(lane: Lane, preset: Preset) -> Lane:
    """Give the lane with the preset's coefficient of friction and the same bounds, if the preset has one."""
    if "coefficient" not in preset.options:
        return lane
    chain, coefficient = lane.chain, preset["coefficient"]
    rubs = chain.friction_bound > 0
    return replace(
        lane,
        chain=replace(
            chain,
            friction_coefficient=np.where(rubs, coefficient, chain.friction_coefficient),
            normal_force=np.where(rubs, chain.friction_bound / coefficient, chain.normal_force),
        ),
    )
