"""MuJoCo Warp: MuJoCo's equations in single precision, all lanes of a batch as worlds of one model."""

from typing import ClassVar

from engines.interface.preparation import Preparation
from engines.interface.presets import Capabilities, Formulation, FrictionLaw, Preset
from engines.mujoco.worlds_simulation import worlds_simulation
from engines.mujoco_warp.contact import CONTACT_DEFAULT, CONTACT_TUNED
from engines.mujoco_warp.joint import JOINT_DEFAULT, JOINT_TUNED
from engines.mujoco_warp.reproducer import CONTACT, JOINT
from engines.mujoco_warp.worlds import MuJoCoWarpWorlds
from engines.shared.mass_ratio import check_mass_ratio
from engines.shared.wheel_engine import WheelEngine
from reference_lcp.chain.simulation import Lane, Simulation

LARGEST_MASS_RATIO = {Formulation.JOINT: 100.0, Formulation.CONTACT: 20.0}
"""Largest inner mass over the outer one of a cell.

The inner body hangs in the outer one, so that in single precision the outer mass is lost beside the inner: a period of
joints is off by 4e-6 of the motion at 50, 1e-5 at 100, 5e-2 at 1,000. Contacts hold to 24, and lose their friction at
26.
"""


class MuJoCoWarp(WheelEngine):
    """MuJoCo Warp on the processor, one thread, its step recorded as a graph."""

    name: ClassVar[str] = "mujoco-warp"
    module: ClassVar[str] = "mujoco_warp"
    # Half a minute of a processor, for contacts half as long; ten times as much where it is busy with other things.
    preparation: ClassVar[Preparation | None] = Preparation("compiles its kernels", 300.0)
    capabilities: ClassVar[Capabilities] = Capabilities(
        title="MuJoCo Warp",
        optional=True,
        package="mujoco-warp",
        licence="Apache-2.0",
        friction_law=FrictionLaw.REGULARISED,
        presets={
            Formulation.JOINT: {"tuned": JOINT_TUNED, "default": JOINT_DEFAULT},
            Formulation.CONTACT: {"tuned": CONTACT_TUNED, "default": CONTACT_DEFAULT},
        },
        batch_lanes=64,
        precision="single",
        # Positions and velocities are rounded by 2^-24 of themselves in every step: of one period of 400 steps,
        # this adds up to 1e-6 of the displacement scale or somewhat more, at a resonance to 9e-6.
        residual=1e-5,
        notes=(
            "MuJoCo's laws, in single precision: by default friction is a soft constraint with a time constant. The "
            "no-slip sweep of the tuned presets removes the softness; then a motion equals equation (5) to some 1e-6 "
            "of its size."
        ),
    )
    reproducers: ClassVar = {Formulation.JOINT: JOINT, Formulation.CONTACT: CONTACT}

    def _build(self, lanes: tuple[Lane, ...], formulation: Formulation, preset: Preset) -> Simulation:
        check_mass_ratio(lanes, LARGEST_MASS_RATIO[formulation], self.capabilities.title)
        return worlds_simulation(lanes, formulation, preset, MuJoCoWarpWorlds)
