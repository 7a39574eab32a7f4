"""Newton's own settings, and the presets that change them."""

from dataclasses import replace

from multibody_xval.engines.interface.presets import NormalForce, Option, Preset
from multibody_xval.engines.newton.step_model import friction_anchors

UNITS = Option.own("SI", "The chain in SI units.")

LANE_UNITS = ("lane", "Numbers near one, and the time step as the unit of time: worlds share it.")

# What makes a drive a friction; SolverSteel has joint friction of its own on CUDA devices only.
JOINT_OPTIONS = {
    "units": UNITS,
    "drive_mode": Option(
        "rows",
        "augmented",
        "The default adds all damping to the mass matrix and bounds only the rest: the joint locks, without friction.",
    ),
    "target_kd": Option(1e20, 0.0, "Damping of the drive: a smaller one lets stuck contacts creep."),
}

CONTACT_OPTIONS = {
    "units": UNITS,
    "friction_anchor_beta": Option.own(0.2, "SolverSteel's own: a fifth of what has slipped is taken back."),
}

JOINT_TUNED = Preset(
    "Dry friction emulated by velocity drives of bounded effort as rows of the solver; springs and load as forces.",
    JOINT_OPTIONS,
    {"units": LANE_UNITS},
    shares_scheme=True,
    normal_force=NormalForce.MODULATED,
    judged=("chain", "blocks"),
)

JOINT_DEFAULT = Preset(
    "The same emulation and forces in SI units, a lane at a time; without the rows there is no friction to compare.",
    JOINT_OPTIONS,
    shares_scheme=True,
    normal_force=NormalForce.MODULATED,
    batch_lanes=4,
)

CONTACT_TUNED = Preset(
    "Spheres pressed on planes, with friction in one point; springs, dashpots and load as forces at the step's start.",
    CONTACT_OPTIONS,
    {
        "units": LANE_UNITS,
        "friction_anchor_beta": (0.0, "Point friction: nothing is drawn back to where it once stuck."),
    },
    shares_scheme=True,
    normal_force=NormalForce.MODULATED,
    judged=("chain", "blocks"),
)

CONTACT_DEFAULT = Preset(
    "The same spheres and forces in SI units, a lane at a time, with SolverSteel's own anchors.",
    CONTACT_OPTIONS,
    known_deviation=(
        "a contact that slips by less than 1e-5 of its sphere's radius in a step is taken to stick there, and is drawn "
        "back by a fifth of it in every step that follows"
    ),
    law=friction_anchors,
    split_tolerance=1e-4,
    normal_force=NormalForce.MODULATED,
    batch_lanes=4,
)

ITERATIONS = Option.own(12, "SolverSteel's own.")
MORE = {"iterations": (50, "Stacks are solved by sweeps; at one world they cost little.")}

JOINT_RECOMMENDED = replace(
    JOINT_DEFAULT,
    description="For joints of any model: drives as rows of the solver, as they come; no more sweeps hold an arm.",
    optional=True,
    judged=("scenes",),
)

CONTACT_RECOMMENDED = replace(
    CONTACT_DEFAULT,
    description="For contacts of any model: SolverSteel with its own anchors, and more sweeps.",
    options={**CONTACT_OPTIONS, "iterations": ITERATIONS},
    changes=MORE,
    optional=True,
    varied={"iterations": (30, 100)},
    judged=("scenes",),
)
