"""MuJoCo: dry friction of a joint, or of a sphere pressed on a plate."""

from typing import ClassVar

from engines.interface.presets import Capabilities, Formulation, FrictionLaw, Preset
from engines.mujoco.contact import CONTACT_DEFAULT, CONTACT_TUNED, contact_model, contact_units, lifting_model
from engines.mujoco.joint import JOINT_DEFAULT, JOINT_TUNED, joint_model
from engines.mujoco.simulation import ModulatedJointSimulation, MuJoCoSimulation
from engines.shared.units import Units
from engines.shared.wheel_engine import WheelEngine
from reference_lcp.chain.simulation import Lane, Simulation


class MuJoCo(WheelEngine):
    """MuJoCo, advanced by `mujoco.batch.Batch` on one thread."""

    name: ClassVar[str] = "mujoco"
    module: ClassVar[str] = "mujoco"
    versions: ClassVar[str] = ">=3.3.7,<5"
    capabilities: ClassVar[Capabilities] = Capabilities(
        title="MuJoCo",
        package="mujoco",
        licence="Apache-2.0",
        friction_law=FrictionLaw.REGULARISED,
        presets={
            Formulation.JOINT: {"tuned": JOINT_TUNED, "default": JOINT_DEFAULT},
            Formulation.CONTACT: {"tuned": CONTACT_TUNED, "default": CONTACT_DEFAULT},
        },
        notes=(
            "Friction is a convex regularisation of Coulomb's law with a time constant: by default, in joint and "
            "contact alike, a stuck contact creeps, and no finer time step helps. The no-slip sweep of the tuned "
            "presets removes the softness; then the motion equals equation (5) to round-off."
        ),
    )

    def _build(self, lanes: tuple[Lane, ...], formulation: Formulation, preset: Preset) -> Simulation:
        modulated = any(lane.preload is not None for lane in lanes)
        options = preset.modulated() if modulated else preset
        if formulation is Formulation.JOINT:
            units = [Units.named(preset["units"], lane) for lane in lanes]
            compiled = joint_model
        else:
            units = [contact_units(lane, preset) for lane in lanes]
            compiled = lifting_model if modulated else contact_model
        models = [compiled(lane, unit, options) for lane, unit in zip(lanes, units, strict=True)]
        if modulated and formulation is Formulation.JOINT:
            return ModulatedJointSimulation(lanes, units, models)
        return MuJoCoSimulation(lanes, units, models)
