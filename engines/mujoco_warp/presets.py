"""MuJoCo Warp's presets: MuJoCo's settings, changed for single precision, and its laws, solved to another tolerance."""

from dataclasses import replace

from multibody_xval.engines.interface.law import Law, NotModelled
from multibody_xval.engines.interface.presets import ACROSS, NormalForce, Option, Preset
from multibody_xval.engines.mujoco import presets as mujoco
from multibody_xval.engines.mujoco import step_model

NEWTON_PERIOD = 4e-5
"""Of U0: MuJoCo Warp stops at a tolerance of 1e-6, a hundred times MuJoCo's, which leaves ten times the acceleration,
and ten times the 4e-6 U0 that this makes of a period; roundings in single precision are some 3e-6 U0."""

NEWTON_REASON = "MuJoCo Warp's Newton solver stops at a tolerance of 1e-6, and computes in single precision"


HOPS = NotModelled(
    "MuJoCo's law to round-off until a sphere hops; in single precision it may land a step earlier or later"
)


def joint_friction(preset: Preset) -> Law | NotModelled:
    """Give the law of a joint's frictionloss."""
    law = step_model.joint_friction(preset)
    if isinstance(law, NotModelled):
        return law
    return replace(law, period_bound=NEWTON_PERIOD, bound_reason=NEWTON_REASON)


def pyramidal_contact(preset: Preset) -> Law | NotModelled:
    """Give the law of a sphere that is held at a fixed depth."""
    if preset.is_free:
        return HOPS
    return replace(step_model.pyramidal_contact(preset), period_bound=NEWTON_PERIOD, bound_reason=NEWTON_REASON)


TUNED = {
    "units": ("lane", "Numbers near one, of which single precision keeps seven digits."),
    "solver": ("Newton", "MuJoCo Warp has no dual solver but the sweep after it."),
    "iterations": (1, "The sweep after it decides what friction is."),
    "noslip_iterations": (
        1,
        "One sweep without softness: frictions do not touch each other's masses, so that it is exact.",
    ),
    "jacobian": ("auto", "MuJoCo Warp takes no dense matrices above 60 degrees of freedom."),
    "integrator": mujoco.TUNED["integrator"],
    "disable": (
        ("eulerdamp", "warmstart", "island"),
        "Damping at the start of the step; no warm start; no search for islands.",
    ),
}
"""What the tuned presets of both formulations change alike."""

JOINT_TUNED = Preset(
    "One step of Newton, then one sweep without softness: friction stops a contact within a step, as in equation (5).",
    mujoco.JOINT_OPTIONS,
    {**TUNED, "cone": mujoco.NO_CONTACTS, "solref_friction": mujoco.stops_in_one_step(step_model.LARGEST_IMPEDANCE)},
    shares_scheme=True,
    normal_force=NormalForce.MODULATED,
    judged=("chain", "blocks"),
)

JOINT_DEFAULT = replace(mujoco.JOINT_DEFAULT, law=joint_friction, split_tolerance=1e-6, judged=())

CONTACT_TUNED = Preset(
    "The elliptic cone under a normal force that friction hardly changes, and a sweep without softness: equation (5).",
    {**mujoco.CONTACT_OPTIONS, **mujoco.PRESSED_HARDER},
    {
        **TUNED,
        ACROSS: mujoco.IS_HELD,
        "cone": mujoco.ELLIPTIC,
        "solreffriction": mujoco.stops_in_one_step(mujoco.SOFTEST),
        "normal time constant": mujoco.CHOSEN_STIFFNESS,
    },
    shares_scheme=True,
    turns=True,
    judged=("chain", "blocks"),
)

CONTACT_DEFAULT = replace(mujoco.CONTACT_DEFAULT, law=pyramidal_contact, split_tolerance=1e-6, judged=())


def _without_tolerance(preset: Preset) -> dict[str, Option]:
    """Leave out the solver's tolerance: MuJoCo Warp raises what a model has to 1e-6."""
    return {name: option for name, option in preset.options.items() if name != "tolerance"}


JOINT_RECOMMENDED = replace(
    mujoco.JOINT_RECOMMENDED,
    options=_without_tolerance(mujoco.JOINT_RECOMMENDED),
    law=joint_friction,
    split_tolerance=1e-6,
    judged=("scenes",),
)

CONTACT_RECOMMENDED = replace(
    mujoco.CONTACT_RECOMMENDED,
    options=_without_tolerance(mujoco.CONTACT_RECOMMENDED),
    split_tolerance=1e-6,
    judged=("scenes",),
)
