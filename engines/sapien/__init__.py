"""SAPIEN, which is PhysX 5: friction emulated by drives of an articulation, or of spheres pressed on plates."""

from pathlib import Path
from typing import ClassVar

from multibody_xval.engines.interface.preset_file import presets_of
from multibody_xval.engines.interface.presets import Capabilities, Formulation, FrictionLaw
from multibody_xval.engines.interface.tolerances import SUBSTEPS_RESIDUAL
from multibody_xval.engines.sapien.contact import SapienContactLane
from multibody_xval.engines.sapien.joint import SapienJointLane
from multibody_xval.engines.sapien.scene import STEP, contacts, joints
from multibody_xval.engines.shared.pip_engine import PipEngine
from multibody_xval.engines.shared.script_units import script_in_units


class Sapien(PipEngine):
    """SAPIEN on the processor, in single precision."""

    name: ClassVar[str] = "sapien"
    module: ClassVar[str] = "sapien"
    versions: ClassVar[str] = ">=3.0.3"
    capabilities: ClassVar[Capabilities] = Capabilities(
        title="SAPIEN (PhysX)",
        optional=True,
        package="sapien",
        licence="MIT",
        friction_law=FrictionLaw.COULOMB,
        presets=presets_of(Path(__file__).with_name("presets.toml"), "SAPIEN"),
        precision="single",
        residual=SUBSTEPS_RESIDUAL,
        notes=(
            "Coulomb's law, in single precision: a motion repeats to some 1e-6 of its size, and no closer. In the "
            "joint a drive of bounded force emulates it. Of PhysX's two solvers of contacts, the projected "
            "Gauss–Seidel takes the reference's step; the temporal one, which is SAPIEN's own, moves masses while it "
            "is still solving for their friction."
        ),
    )
    lane_models: ClassVar = {Formulation.JOINT: SapienJointLane, Formulation.CONTACT: SapienContactLane}
    reproducers: ClassVar = {
        Formulation.JOINT: script_in_units("reproducer_joint.py.jinja"),
        Formulation.CONTACT: script_in_units("reproducer_contact.py.jinja"),
    }
    scene_step: ClassVar[float] = STEP
    scene_worlds: ClassVar = {Formulation.JOINT: joints, Formulation.CONTACT: contacts}
