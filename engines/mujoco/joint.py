"""MuJoCo's joint formulation: the dry friction of a slide joint between outer and inner mass."""

from typing import Any

import numpy as np

from engines.interface.presets import NormalForce, Option, Preset
from engines.mujoco.law import joint_friction
from engines.mujoco.model import DEFAULT_OPTIONS, TUNED_OPTIONS, add_chain, add_masses, new_spec
from engines.shared.units import Units
from reference_lcp.chain.simulation import Lane

JOINT_TUNED = Preset(
    "The dual solver without its softness: friction stops a contact at the end of the step, as equation (5) does.",
    {
        **TUNED_OPTIONS,
        "units": Option("lane", "SI", "No number comes near MuJoCo's built-in smallest and largest ones."),
        "solver": Option("PGS", "Newton", "The friction forces are the unknowns, and each solves its own equation."),
        "cone": Option("pyramidal", "pyramidal", "There are no contacts."),
        "solref_friction": Option(
            (-1.0, -1.0), (0.02, 1.0), "Direct form, in units of d_width / dt: a stuck contact stops in one step."
        ),
    },
    shares_scheme=True,
    split_tolerance=1e-12,
    normal_force=NormalForce.MODULATED,
    varied={"noslip_iterations": (0, 2)},
)

JOINT_DEFAULT = Preset(
    "A joint's frictionloss in SI units, and MuJoCo's own options.",
    {
        **DEFAULT_OPTIONS,
        "solref_friction": Option(
            (0.02, 1.0), (0.02, 1.0), "MuJoCo's own: a time constant of 0.02 s, whatever the time step."
        ),
    },
    known_deviation=(
        "friction is a soft constraint with a time constant, whatever the time step: a stuck contact comes to rest "
        "with one of 10.6 ms and creeps, and a finer step does not help"
    ),
    law=joint_friction,
    split_tolerance=1e-9,
    normal_force=NormalForce.MODULATED,
)


def joint_model(lane: Lane, units: Units, preset: Preset) -> Any:
    """Compile a lane: an outer slide in the world, on each an inner slide, tendons between outer slides."""
    chain, time_step = units.scaled(lane.chain), lane.time_step / units.time
    spec = new_spec(time_step, preset)
    for cell in range(chain.cells):
        joint = add_masses(spec, chain, cell)[1].joints[0]
        joint.frictionloss = chain.friction_bound[cell]
        if "solimp_friction" in preset.options:
            joint.solimp_friction[:2] = preset["solimp_friction"]
        solref = np.array(preset["solref_friction"])
        # A direct solref, negative, is divided by d_width: this makes the reference acceleration -ġ_T / dt.
        joint.solref_friction = solref if solref[0] > 0 else solref * joint.solimp_friction[1] / time_step
    add_chain(spec, chain)
    return spec.compile()
