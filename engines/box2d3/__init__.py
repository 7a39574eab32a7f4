"""Box2D 3: the motor of a prismatic joint, or a disc pressed on a plate."""

from pathlib import Path
from typing import ClassVar

from multibody_xval.engines.box2d3.contact import STIFFEST, Box2DContactLane
from multibody_xval.engines.box2d3.joint import Box2DJointLane
from multibody_xval.engines.box2d3.scene import STEP, contacts, joints
from multibody_xval.engines.interface.preset_file import presets_of
from multibody_xval.engines.interface.presets import Capabilities, Formulation, FrictionLaw
from multibody_xval.engines.interface.tolerances import SUBSTEPS_RESIDUAL
from multibody_xval.engines.shared.pip_engine import PipEngine
from multibody_xval.engines.shared.script_units import script_in_units


class Box2D3(PipEngine):
    """Box2D 3.1 and later, in single precision, by its bindings pyb2d3."""

    name: ClassVar[str] = "box2d3"
    module: ClassVar[str] = "pyb2d3"
    capabilities: ClassVar[Capabilities] = Capabilities(
        title="Box2D 3",
        optional=True,
        package="pyb2d3",
        licence="MIT",
        friction_law=FrictionLaw.COULOMB,
        presets=presets_of(Path(__file__).with_name("presets.toml"), "Box2D"),
        precision="single",
        residual=SUBSTEPS_RESIDUAL,
        notes=(
            "Coulomb's law, in single precision. Contacts are soft across, and exact along. By default a step has four "
            "substeps, springs are joints, implicit and therefore damping, and bodies that move slower than 0.05 m/s "
            "for half a second are stopped."
        ),
    )
    lane_models: ClassVar = {Formulation.JOINT: Box2DJointLane, Formulation.CONTACT: Box2DContactLane}
    reproducers: ClassVar = {
        Formulation.JOINT: script_in_units("reproducer.py.jinja", contact=False),
        Formulation.CONTACT: script_in_units("reproducer.py.jinja", contact=True, stiffest=STIFFEST),
    }
    scene_step: ClassVar[float] = STEP
    scene_worlds: ClassVar = {Formulation.JOINT: joints, Formulation.CONTACT: contacts}
