"""ovphysx's joint formulation: in every cell the static and dynamic friction of an articulation's joint.

PhysX lets no joint move faster than 100 units of length in one of time, whatever `maxJointVelocity` and the tensor of
largest velocities say. In the units of a lane that is a hundred displacement scales in a step.
"""

from engines.interface.presets import NormalForce, Option, Preset
from engines.ovphysx.law import temporal_substeps

SHARED_OPTIONS = {
    "units": Option("lane", "SI", "Its time step is the unit of time: all lanes of a scene have one."),
    "friction": Option(
        ("F", "F", 0.0), (0.0, 0.0, 0.0), "Static and dynamic friction, and none in proportion to velocity."
    ),
    "NUM_THREADS": Option(0, 8, "Waiting threads of PhysX cost as much as fifty steps of a chain."),
}
"""What both presets set."""

JOINT_TUNED = Preset(
    "Friction of joints in one articulation; springs, dashpots and load as forces at the start of the step.",
    {
        **SHARED_OPTIONS,
        "solverType": Option("PGS", "TGS", "Projected Gauss–Seidel finds friction before masses move."),
        "solverPositionIterationCount": Option(4, 32, "Each leaves at most 6e-4 of a slip, two its roundings."),
        "solverVelocityIterationCount": Option(1, 1, "PhysX's own."),
        "cfmScale": Option(0.025, 0.025, "PhysX's own softness of links, which iterations make up for."),
    },
    shares_scheme=True,
    normal_force=NormalForce.MODULATED,
)

JOINT_DEFAULT = Preset(
    "The same joints and forces with PhysX's own solver and iterations.",
    {
        **SHARED_OPTIONS,
        "solverType": Option("TGS", "TGS", "PhysX's own solver, the temporal Gauss–Seidel."),
        "solverPositionIterationCount": Option(32, 32, "An articulation's own: each is a substep."),
        "solverVelocityIterationCount": Option(1, 1, "PhysX's own: what slips is stopped once more."),
        "cfmScale": Option(
            0.025, 0.025, "PhysX's own softness of links: a substep leaves a stuck contact 2 % of its slip."
        ),
    },
    known_deviation=(
        "forces of the start of a step act in 32 substeps of it, of which each moves masses, so that springs and "
        "dashpots act late by half a step"
    ),
    law=temporal_substeps,
    normal_force=NormalForce.MODULATED,
)
