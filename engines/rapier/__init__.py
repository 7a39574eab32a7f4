"""Rapier: friction emulated by a motor of bounded force, a joint's own, or of a sphere pressed on a plate."""

from pathlib import Path
from typing import ClassVar

from multibody_xval.engines.interface.preset_file import presets_of
from multibody_xval.engines.interface.presets import Capabilities, Formulation, FrictionLaw, Preset
from multibody_xval.engines.interface.tolerances import SUBSTEPS_RESIDUAL
from multibody_xval.engines.rapier.contact import CLEARANCE, RapierContactLane
from multibody_xval.engines.rapier.joint import RapierJointLane
from multibody_xval.engines.rapier.native import RapierNativeLane
from multibody_xval.engines.rapier.scene import STEP, contacts, joints
from multibody_xval.engines.shared.pip_engine import PipEngine
from multibody_xval.engines.shared.script_units import script_in_units
from reference_lcp.chain.simulation import Lane


def joint_lane(lane: Lane, preset: Preset) -> RapierJointLane | RapierNativeLane:
    """Give the model of a lane: with motors, or with friction of Rapier's own."""
    return RapierJointLane(lane, preset) if "motor factor" in preset.options else RapierNativeLane(lane, preset)


class Rapier(PipEngine):
    """Rapier in three dimensions, in single precision."""

    name: ClassVar[str] = "rapier"
    module: ClassVar[str] = "rapier3d"
    versions: ClassVar[str] = ">=0.36.1"
    capabilities: ClassVar[Capabilities] = Capabilities(
        title="Rapier",
        optional=True,
        package="rapier3d",
        licence="Apache-2.0",
        friction_law=FrictionLaw.COULOMB,
        presets=presets_of(Path(__file__).with_name("presets.toml"), "Rapier"),
        precision="single",
        residual=SUBSTEPS_RESIDUAL,
        notes=(
            "Coulomb's law, exact in stick, in single precision: a motion repeats to some 1e-6 of its size, and no "
            "closer. What Rapier calls iterations of its solver are substeps over which forces do not change: with "
            "its own four, springs act late by up to a step."
        ),
    )
    lane_models: ClassVar = {Formulation.JOINT: joint_lane, Formulation.CONTACT: RapierContactLane}
    reproducers: ClassVar = {
        Formulation.JOINT: script_in_units("reproducer_joint.py.jinja")._replace(without=("native",)),
        Formulation.CONTACT: script_in_units("reproducer_contact.py.jinja", clearance=CLEARANCE),
    }
    scene_step: ClassVar[float] = STEP
    scene_worlds: ClassVar = {Formulation.JOINT: joints, Formulation.CONTACT: contacts}
