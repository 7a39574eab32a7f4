"""MuJoCo: dry friction of a joint, or of a sphere pressed on a plate."""

from pathlib import Path
from typing import ClassVar

from multibody_xval.engines.interface.preset_file import presets_of
from multibody_xval.engines.interface.presets import Capabilities, Formulation, FrictionLaw, Preset
from multibody_xval.engines.mujoco.contact import compiled_contacts
from multibody_xval.engines.mujoco.joint import compiled_joints
from multibody_xval.engines.mujoco.reproducer import CONTACT, JOINT
from multibody_xval.engines.mujoco.scene import STEP, contacts, joints
from multibody_xval.engines.mujoco.simulation import ModulatedJointSimulation, MuJoCoSimulation
from multibody_xval.engines.shared.pip_engine import PipEngine
from reference_lcp.chain.simulation import Lane, Simulation


class MuJoCo(PipEngine):
    """MuJoCo, advanced by `mujoco.batch.Batch` on one thread."""

    name: ClassVar[str] = "mujoco"
    module: ClassVar[str] = "mujoco"
    versions: ClassVar[str] = ">=3.3.6,<5"
    same_files: ClassVar[str] = "mujoco-core"
    capabilities: ClassVar[Capabilities] = Capabilities(
        title="MuJoCo",
        package="mujoco",
        licence="Apache-2.0",
        friction_law=FrictionLaw.REGULARISED,
        presets=presets_of(Path(__file__).with_name("presets.toml"), "MuJoCo"),
        notes=(
            "Friction is a convex regularisation of Coulomb's law with a time constant: by default, in joint and "
            "contact alike, a stuck contact creeps, and no finer time step helps. The no-slip sweep of the tuned "
            "presets removes the softness; then the motion equals equation (5) to round-off."
        ),
    )

    reproducers: ClassVar = {Formulation.JOINT: JOINT, Formulation.CONTACT: CONTACT}
    scene_step: ClassVar[float] = STEP
    scene_shakers: ClassVar[bool] = True
    scene_worlds: ClassVar = {Formulation.JOINT: joints, Formulation.CONTACT: contacts}

    def _build(self, lanes: tuple[Lane, ...], formulation: Formulation, preset: Preset) -> Simulation:
        modulated = any(lane.preload is not None for lane in lanes)
        options = preset.modulated() if modulated else preset
        if formulation is Formulation.JOINT:
            kind = ModulatedJointSimulation if modulated else MuJoCoSimulation
            return kind([compiled_joints(lane, options) for lane in lanes])
        return MuJoCoSimulation([compiled_contacts(lane, options, lifting=modulated) for lane in lanes])
