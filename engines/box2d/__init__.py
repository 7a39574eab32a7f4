"""Box2D: the motor of a joint, a friction joint, or a box pressed on a plate."""

from typing import ClassVar

from engines.box2d.contact import CONTACT_DEFAULT, CONTACT_TUNED, Box2DContactLane
from engines.box2d.joint import JOINT_DEFAULT, JOINT_TUNED, Box2DJointLane
from engines.box2d.reproducer import CONTACT, JOINT
from engines.interface.presets import Capabilities, Formulation, FrictionLaw
from engines.shared.wheel_engine import WheelEngine


class Box2D(WheelEngine):
    """Box2D 2.3, in single precision."""

    name: ClassVar[str] = "box2d"
    module: ClassVar[str] = "Box2D"
    capabilities: ClassVar[Capabilities] = Capabilities(
        title="Box2D",
        optional=True,
        package="Box2D",
        licence="Zlib",
        friction_law=FrictionLaw.COULOMB,
        presets={
            Formulation.JOINT: {"tuned": JOINT_TUNED, "default": JOINT_DEFAULT},
            Formulation.CONTACT: {"tuned": CONTACT_TUNED, "default": CONTACT_DEFAULT},
        },
        precision="single",
        # Positions and velocities are rounded by 2^-24 of themselves in every step: of one period of 400 steps,
        # this adds up to 1e-6 of the displacement scale or somewhat more, and no mixing of iterates removes it.
        residual=1e-5,
        notes=(
            "Coulomb's law, exact in stick, in single precision: a motion repeats to some 1e-6 of its size, and no "
            "closer. By default springs are distance joints, implicit and therefore damping, and bodies that move "
            "slower than 0.01 m/s for half a second are stopped."
        ),
    )
    lane_models: ClassVar = {Formulation.JOINT: Box2DJointLane, Formulation.CONTACT: Box2DContactLane}
    reproducers: ClassVar = {Formulation.JOINT: JOINT, Formulation.CONTACT: CONTACT}
