"""Rapier: a motor of bounded force, or a sphere pressed on a plate."""

from typing import ClassVar

from engines.interface.presets import Capabilities, Formulation, FrictionLaw
from engines.rapier.contact import CONTACT_DEFAULT, CONTACT_TUNED, RapierContactLane
from engines.rapier.joint import JOINT_DEFAULT, JOINT_TUNED, RapierJointLane
from engines.rapier.reproducer import CONTACT, JOINT
from engines.shared.wheel_engine import WheelEngine


class Rapier(WheelEngine):
    """Rapier in three dimensions, in single precision."""

    name: ClassVar[str] = "rapier"
    module: ClassVar[str] = "rapier3d"
    capabilities: ClassVar[Capabilities] = Capabilities(
        title="Rapier",
        optional=True,
        package="rapier3d",
        licence="Apache-2.0",
        friction_law=FrictionLaw.COULOMB,
        presets={
            Formulation.JOINT: {"tuned": JOINT_TUNED, "default": JOINT_DEFAULT},
            Formulation.CONTACT: {"tuned": CONTACT_TUNED, "default": CONTACT_DEFAULT},
        },
        precision="single",
        # Positions and velocities are rounded by 2^-24 of themselves in every substep, as Box2D's in every step, and
        # roundings add up as the root of their number: 1e-6 of the displacement scale or somewhat more over a period of
        # 400 of them, four times as much over the 6,400 of the default at 1,600 steps. No mixing of iterates removes
        # it.
        residual=2e-5,
        notes=(
            "Coulomb's law, exact in stick, in single precision: a motion repeats to some 1e-6 of its size, and no "
            "closer. What Rapier calls iterations of its solver are substeps over which forces do not change: with "
            "its own four, springs act late by up to a step."
        ),
    )
    lane_models: ClassVar = {Formulation.JOINT: RapierJointLane, Formulation.CONTACT: RapierContactLane}
    reproducers: ClassVar = {Formulation.JOINT: JOINT, Formulation.CONTACT: CONTACT}
