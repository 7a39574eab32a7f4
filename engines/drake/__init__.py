"""Drake: friction of a joint's actuator with bounded effort, or of spheres pressed on planes."""

from typing import ClassVar

from engines.drake.contact import (
    CONTACT_DEFAULT,
    CONTACT_SAP,
    CONTACT_SIMILAR,
    CONTACT_TUNED,
    DrakeContactLane,
)
from engines.drake.joint import JOINT_DEFAULT, JOINT_TUNED, DrakeJointLane
from engines.drake.reproducer import CONTACT, JOINT
from engines.interface.presets import Capabilities, Formulation, FrictionLaw
from engines.shared.wheel_engine import WheelEngine


class Drake(WheelEngine):
    """Drake's discrete `MultibodyPlant`, advanced by its own simulator."""

    name: ClassVar[str] = "drake"
    module: ClassVar[str] = "pydrake"
    capabilities: ClassVar[Capabilities] = Capabilities(
        title="Drake",
        optional=True,
        package="drake",
        licence="BSD-3-Clause",
        friction_law=FrictionLaw.REGULARISED,
        presets={
            Formulation.JOINT: {"tuned": JOINT_TUNED, "default": JOINT_DEFAULT},
            Formulation.CONTACT: {
                "tuned": CONTACT_TUNED,
                "sap": CONTACT_SAP,
                "similar": CONTACT_SIMILAR,
                "default": CONTACT_DEFAULT,
            },
        },
        notes=(
            "Friction is regularised within a narrow band of velocities, in the tuned presets so narrow that a stuck "
            "contact creeps at 1e-5 of the motion. Springs act with their force at the start of a step, dashpots of "
            "joints with the velocity at its end. Of the approximations of contact, kLagged, Drake's own, keeps the "
            "normal force; with kSap and kSimilar friction lifts a sliding body, which then bounces."
        ),
    )
    lane_models: ClassVar = {Formulation.JOINT: DrakeJointLane, Formulation.CONTACT: DrakeContactLane}
    reproducers: ClassVar = {Formulation.JOINT: JOINT, Formulation.CONTACT: CONTACT}
