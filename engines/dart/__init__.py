"""DART: the Coulomb friction of a joint, or a body pressed on a plate."""

from pathlib import Path
from typing import ClassVar

from multibody_xval.engines.dart.contact import DEPTH, DartContactLane
from multibody_xval.engines.dart.joint import DartJointLane
from multibody_xval.engines.dart.scene import STEP, contacts, joints
from multibody_xval.engines.interface.preset_file import presets_of
from multibody_xval.engines.interface.presets import Capabilities, Formulation, FrictionLaw
from multibody_xval.engines.shared.pip_engine import PipEngine
from multibody_xval.engines.shared.script_units import script_in_si


class Dart(PipEngine):
    """DART, without graphics."""

    name: ClassVar[str] = "dart"
    module: ClassVar[str] = "dartpy"
    capabilities: ClassVar[Capabilities] = Capabilities(
        title="DART",
        optional=True,
        package="dartpy",
        licence="BSD-2-Clause",
        friction_law=FrictionLaw.COULOMB,
        presets=presets_of(Path(__file__).with_name("presets.toml"), "DART"),
        notes=(
            "Coulomb's law as a boxed LCP, solved by pivoting, whose diagonal is enlarged by a part that cannot be set "
            "to less than 1e-9 in joints, and not at all in contacts, "
            "where normal forces err by 2.5e-6 at first. By default joints have their own springs and dashpots, "
            "implicit ones, which damp the motion by as much as the time step is long."
        ),
    )
    lane_models: ClassVar = {Formulation.JOINT: DartJointLane, Formulation.CONTACT: DartContactLane}
    reproducers: ClassVar = {
        Formulation.JOINT: script_in_si("reproducer_joint.py.jinja"),
        Formulation.CONTACT: script_in_si("reproducer_contact.py.jinja", depth=DEPTH),
    }
    scene_step: ClassVar[float] = STEP
    scene_worlds: ClassVar = {Formulation.JOINT: joints, Formulation.CONTACT: contacts}
