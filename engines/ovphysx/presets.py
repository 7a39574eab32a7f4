"""PhysX's own settings of an articulation's joints, and the presets that change them.

PhysX lets no joint move faster than 100 units of length in one of time, whatever `maxJointVelocity` and the tensor of
largest velocities say. In the units of a lane that is a hundred displacement scales in a step.
"""

from engines.interface.presets import NormalForce, Option, Preset
from engines.ovphysx.step_model import temporal_substeps

JOINT_OPTIONS = {
    "units": Option("lane", "SI", "Its time step is the unit of time: all lanes of a scene have one."),
    "friction": Option(
        ("F", "F", 0.0), (0.0, 0.0, 0.0), "Static and dynamic friction, and none in proportion to velocity."
    ),
    "NUM_THREADS": Option(0, 8, "Waiting threads of PhysX cost as much as fifty steps of a chain."),
    "solverType": Option.own("TGS", "PhysX's own solver, the temporal Gauss–Seidel."),
    "solverPositionIterationCount": Option.own(32, "An articulation's own: each is a substep."),
    "solverVelocityIterationCount": Option.own(1, "PhysX's own: what slips is stopped once more."),
    "cfmScale": Option.own(0.025, "PhysX's own softness of links: a substep leaves a stuck contact 2 % of its slip."),
}

JOINT_TUNED = Preset(
    "Friction of joints in one articulation; springs, dashpots and load as forces at the start of the step.",
    JOINT_OPTIONS,
    {
        "solverType": ("PGS", "Projected Gauss–Seidel finds friction before masses move."),
        "solverPositionIterationCount": (4, "Each leaves at most 6e-4 of a slip, two its roundings."),
        "solverVelocityIterationCount": (1, "PhysX's own."),
        "cfmScale": (0.025, "PhysX's own softness of links, which iterations make up for."),
    },
    shares_scheme=True,
    normal_force=NormalForce.MODULATED,
)

JOINT_DEFAULT = Preset(
    "The same joints and forces with PhysX's own solver and iterations.",
    JOINT_OPTIONS,
    known_deviation=(
        "forces of the start of a step act in 32 substeps of it, of which each moves masses, so that springs and "
        "dashpots act late by half a step"
    ),
    law=temporal_substeps,
    normal_force=NormalForce.MODULATED,
)
