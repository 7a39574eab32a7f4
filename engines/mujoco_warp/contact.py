"""MuJoCo Warp's contact formulation: MuJoCo's own model, a sphere that dips into a plate at a fixed depth."""

from dataclasses import replace

import numpy as np

from engines.interface.presets import NormalForce, Option, Preset
from engines.mujoco import contact as mujoco_contact
from engines.mujoco.contact import contact_units
from engines.mujoco_warp.law import pyramidal_contact
from engines.mujoco_warp.model import TUNED_OPTIONS
from engines.shared.units import Units, power_of_two
from reference_lcp.chain.simulation import Lane

CONTACT_TUNED = Preset(
    "The elliptic cone under a normal force that friction hardly changes, and a sweep without softness: equation (5).",
    {
        **TUNED_OPTIONS,
        "cone": Option("elliptic", "pyramidal", "The pyramid's edges change the normal force with friction."),
        "solimp": Option((1e-4, 1e-4), (0.9, 0.95), "MuJoCo's softest: friction hardly raises the normal force."),
        "solreffriction": Option(
            (-1.0, -1.0), (0.0, 0.0), "Direct form, in units of d_width / dt: a stuck contact stops in one step."
        ),
        "normal time constant": Option(0.02, 0.02, "Of solref [s]; its stiffness is chosen so that N = λ_N."),
        "coefficient": Option(
            0.01, None, "Contacts are pressed with F / 0.01: what friction adds to the normal force goes with μ²."
        ),
    },
    shares_scheme=True,
)

CONTACT_DEFAULT = replace(
    mujoco_contact.CONTACT_DEFAULT,
    law=pyramidal_contact,
    split_tolerance=1e-6,
    normal_force=NormalForce.CONSTANT,
    modulated_options={},
)


def light_units(lane: Lane, preset: Preset) -> Units:
    """Choose units in which the masses that contacts stop are near one: MuJoCo Warp takes small ones for none."""
    units, chain = contact_units(lane, preset), lane.chain
    if preset["units"] == "SI":
        return units
    stopped = 1 / (1 / chain.outer_mass + 1 / chain.inner_mass)
    return replace(units, mass=power_of_two(float(np.exp(np.mean(np.log(stopped))))))


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
