"""SAPIEN, which is PhysX 5: drives of bounded force in an articulation, or spheres pressed on plates."""

from typing import ClassVar

from engines.interface.presets import Capabilities, Formulation, FrictionLaw
from engines.sapien.contact import CONTACT_DEFAULT, CONTACT_TUNED, SapienContactLane
from engines.sapien.joint import JOINT_DEFAULT, JOINT_TUNED, SapienJointLane
from engines.sapien.reproducer import CONTACT, JOINT
from engines.shared.wheel_engine import WheelEngine


class Sapien(WheelEngine):
    """SAPIEN on the processor, in single precision."""

    name: ClassVar[str] = "sapien"
    module: ClassVar[str] = "sapien"
    capabilities: ClassVar[Capabilities] = Capabilities(
        title="SAPIEN (PhysX)",
        optional=True,
        package="sapien",
        licence="MIT",
        friction_law=FrictionLaw.COULOMB,
        presets={
            Formulation.JOINT: {"tuned": JOINT_TUNED, "default": JOINT_DEFAULT},
            Formulation.CONTACT: {"tuned": CONTACT_TUNED, "default": CONTACT_DEFAULT},
        },
        precision="single",
        # Positions and velocities are rounded by 2^-24 of themselves in every step, and roundings add up as the root of
        # their number: 1e-6 of the displacement scale or somewhat more over a period of 400 steps, and somewhat more
        # where ten substeps make one. No mixing of iterates removes it.
        residual=2e-5,
        notes=(
            "Coulomb's law, in single precision: a motion repeats to some 1e-6 of its size, and no closer. Of PhysX's "
            "two solvers of contacts, the projected Gauss–Seidel takes the reference's step; the temporal one, "
            "which is SAPIEN's own, moves masses while it is still solving for their friction."
        ),
    )
    lane_models: ClassVar = {Formulation.JOINT: SapienJointLane, Formulation.CONTACT: SapienContactLane}
    reproducers: ClassVar = {Formulation.JOINT: JOINT, Formulation.CONTACT: CONTACT}
