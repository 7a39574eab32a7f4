"""Box2D: the motor of a joint, a friction joint, or a box pressed on a plate."""

from pathlib import Path
from typing import ClassVar

from multibody_xval.engines.box2d.contact import CLEARANCE_OVER_SLOP, GAP_OVER_SLOP, Box2DContactLane
from multibody_xval.engines.box2d.joint import SPRING_LENGTH, Box2DJointLane
from multibody_xval.engines.box2d.scene import STEP, contacts, joints
from multibody_xval.engines.interface.preset_file import presets_of
from multibody_xval.engines.interface.presets import Capabilities, Formulation, FrictionLaw
from multibody_xval.engines.interface.tolerances import SINGLE_RESIDUAL
from multibody_xval.engines.shared.pip_engine import PipEngine
from multibody_xval.engines.shared.script_units import script_in_units


class Box2D(PipEngine):
    """Box2D 2.3, in single precision."""

    name: ClassVar[str] = "box2d"
    module: ClassVar[str] = "Box2D"
    capabilities: ClassVar[Capabilities] = Capabilities(
        title="Box2D",
        optional=True,
        package="Box2D",
        licence="Zlib",
        friction_law=FrictionLaw.COULOMB,
        presets=presets_of(Path(__file__).with_name("presets.toml"), "Box2D"),
        precision="single",
        residual=SINGLE_RESIDUAL,
        notes=(
            "Coulomb's law, exact in stick, in single precision: a motion repeats to some 1e-6 of its size, and no "
            "closer. By default springs are distance joints, implicit and therefore damping, and bodies that move "
            "slower than 0.01 m/s for half a second are stopped."
        ),
    )
    lane_models: ClassVar = {Formulation.JOINT: Box2DJointLane, Formulation.CONTACT: Box2DContactLane}
    reproducers: ClassVar = {
        Formulation.JOINT: script_in_units("reproducer_joint.py.jinja", Box2DJointLane.units_of, length=SPRING_LENGTH),
        Formulation.CONTACT: script_in_units(
            "reproducer_contact.py.jinja",
            Box2DContactLane.units_of,
            length=SPRING_LENGTH,
            gap=GAP_OVER_SLOP,
            clearance=CLEARANCE_OVER_SLOP,
        ),
    }
    scene_step: ClassVar[float] = STEP
    scene_worlds: ClassVar = {Formulation.JOINT: joints, Formulation.CONTACT: contacts}
