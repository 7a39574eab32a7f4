"""MuJoCo: dry friction of a joint, or of a sphere pressed on a plate."""

from typing import ClassVar

from engines.interface.presets import Capabilities, Formulation, FrictionLaw, Preset
from engines.mujoco.contact import (
    CONTACT_DEFAULT,
    CONTACT_NEWTON,
    CONTACT_TUNED,
    contact_model,
    contact_units,
    lifting_model,
)
from engines.mujoco.joint import JOINT_DEFAULT, JOINT_TUNED, joint_model
from engines.mujoco.pressed_contact import pressed_harder
from engines.mujoco.reproducer import CONTACT, JOINT
from engines.mujoco.simulation import ModulatedJointSimulation, MuJoCoSimulation
from engines.mujoco.yielding_simulation import yielding_simulation
from engines.mujoco.yielding_spring import YIELD
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
            Formulation.JOINT: {"tuned": JOINT_TUNED, "yield": YIELD, "default": JOINT_DEFAULT},
            Formulation.CONTACT: {"tuned": CONTACT_TUNED, "newton": CONTACT_NEWTON, "default": CONTACT_DEFAULT},
        },
        notes=(
            "Friction is a convex regularisation of Coulomb's law with a time constant: by default, in joint and "
            "contact alike, a stuck contact creeps, and no finer time step helps. The no-slip sweep of the tuned "
            "presets removes the softness; then the motion equals equation (5) to round-off."
        ),
    )

    reproducers: ClassVar = {Formulation.JOINT: JOINT, Formulation.CONTACT: CONTACT}

    def _build(self, lanes: tuple[Lane, ...], formulation: Formulation, preset: Preset) -> Simulation:
        if "spring_phase" in preset.options:
            return yielding_simulation(lanes, preset)
        modulated = any(lane.preload is not None for lane in lanes)
        options = preset.modulated() if modulated else preset
        if formulation is Formulation.JOINT:
            pressed, compiled = lanes, joint_model
            units = [Units.named(preset["units"], lane) for lane in lanes]
        else:
            pressed = tuple(pressed_harder(lane, preset) for lane in lanes)
            units = [contact_units(lane, preset) for lane in pressed]
            compiled = lifting_model if modulated else contact_model
        models = [compiled(lane, unit, options) for lane, unit in zip(pressed, units, strict=True)]
        kind = ModulatedJointSimulation if modulated and formulation is Formulation.JOINT else MuJoCoSimulation
        return kind(lanes, pressed, units, models)
