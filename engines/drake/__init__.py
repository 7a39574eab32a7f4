"""Drake: friction emulated by a joint's actuator of bounded effort, or of spheres pressed on planes."""

from pathlib import Path
from typing import ClassVar

from multibody_xval.engines.drake import contact, joint, scene
from multibody_xval.engines.interface.preset_file import presets_of
from multibody_xval.engines.interface.presets import Capabilities, Formulation, FrictionLaw
from multibody_xval.engines.shared.pip_engine import PipEngine
from multibody_xval.engines.shared.script_units import script_in_si


class Drake(PipEngine):
    """Drake's discrete `MultibodyPlant`, advanced by its own simulator."""

    name: ClassVar[str] = "drake"
    module: ClassVar[str] = "pydrake"
    capabilities: ClassVar[Capabilities] = Capabilities(
        title="Drake",
        optional=True,
        package="drake",
        licence="BSD-3-Clause",
        friction_law=FrictionLaw.REGULARISED,
        presets=presets_of(Path(__file__).with_name("presets.toml"), "Drake"),
        notes=(
            "In the joint friction is emulated by an actuator of bounded effort. It is regularised within a narrow "
            "band of velocities, in the tuned presets so narrow that a stuck contact creeps at 1e-5 of the motion. "
            "Springs act with their force at the start of a step, dashpots of joints with the velocity at its end. Of "
            "the approximations of contact, kLagged, Drake's own, keeps the normal force; with kSap and kSimilar "
            "friction lifts a sliding body, which then bounces."
        ),
    )
    lane_models: ClassVar = {Formulation.JOINT: joint.DrakeJointLane, Formulation.CONTACT: contact.DrakeContactLane}
    reproducers: ClassVar = {
        Formulation.JOINT: script_in_si("reproducer_joint.py.jinja", joint.script_numbers),
        Formulation.CONTACT: script_in_si(
            "reproducer_contact.py.jinja", contact.script_numbers, radius=contact.RADIUS, width=contact.WIDTH
        ),
    }
    scene_step: ClassVar[float] = scene.TIME_STEP
    scene_worlds: ClassVar = {Formulation.JOINT: scene.joints, Formulation.CONTACT: scene.contacts}
