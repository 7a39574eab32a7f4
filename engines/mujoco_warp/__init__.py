"""MuJoCo Warp: MuJoCo's equations in single precision, all lanes of a batch as worlds of one model."""

from pathlib import Path
from typing import ClassVar

from multibody_xval.engines.interface.preset_file import presets_of
from multibody_xval.engines.interface.presets import Capabilities, Formulation, FrictionLaw, Preparation, Preset
from multibody_xval.engines.interface.reproducer import Reproducer
from multibody_xval.engines.interface.tolerances import SINGLE_RESIDUAL
from multibody_xval.engines.mujoco.contact import pressed_harder
from multibody_xval.engines.mujoco.reproducer import contact_numbers, joint_numbers
from multibody_xval.engines.mujoco.scene import STEP
from multibody_xval.engines.mujoco_warp.scene import contacts, joints
from multibody_xval.engines.mujoco_warp.worlds import TOUCH_IN_SINGLE, MuJoCoWarpSimulation, light_units
from multibody_xval.engines.shared.pip_engine import PipEngine
from multibody_xval.engines.shared.units import Units, check_mass_ratio
from multibody_xval.engines.shared.worlds_simulation import LaneAlone, rub_alike
from reference_lcp.chain.simulation import Lane, Simulation
from reference_lcp.schemes.sequential import SequentialSimulation

LARGEST_MASS_RATIO = {Formulation.JOINT: 100.0, Formulation.CONTACT: 20.0}
"""Largest inner mass over the outer one of a cell.

The inner body hangs in the outer one, so that in single precision the outer mass is lost beside the inner: a period of
joints is off by 4e-6 of the motion at 50, 1e-5 at 100, 5e-2 at 1,000. Contacts hold to 24, and lose their friction at
26.
"""


class MuJoCoWarp(PipEngine):
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
        presets=presets_of(Path(__file__).with_name("presets.toml"), "MuJoCo Warp"),
        batch_lanes=64,
        precision="single",
        residual=SINGLE_RESIDUAL,
        notes=(
            "MuJoCo's laws, in single precision: by default friction is a soft constraint with a time constant. The "
            "no-slip sweep of the tuned presets removes the softness; then a motion equals equation (5) to some 1e-6 "
            "of its size."
        ),
    )
    reproducers: ClassVar = {
        Formulation.JOINT: Reproducer(
            "reproducer_joint.py.jinja",
            lambda lane, preset, start: joint_numbers(lane, preset, start, Units.named(preset["units"], lane)),
            own_units=True,
        ),
        Formulation.CONTACT: Reproducer(
            "reproducer_contact.py.jinja",
            lambda lane, preset, start: contact_numbers(
                lane, preset, start, light_units(pressed_harder(lane, preset), preset), TOUCH_IN_SINGLE
            ),
            own_units=True,
        ),
    }

    scene_step: ClassVar[float] = STEP
    scene_shakers: ClassVar[bool] = True
    scene_worlds: ClassVar = {Formulation.JOINT: joints, Formulation.CONTACT: contacts}

    def _build(self, lanes: tuple[Lane, ...], formulation: Formulation, preset: Preset) -> Simulation:
        check_mass_ratio(lanes, LARGEST_MASS_RATIO[formulation], self.capabilities.title)
        if formulation is Formulation.CONTACT and any(lane.preload for lane in lanes) and not rub_alike(lanes):
            # What does not rub has a contact of another kind, and worlds share these.
            alone = [MuJoCoWarpSimulation.of([lane], formulation, preset) for lane in lanes]
            return SequentialSimulation([LaneAlone(each) for each in alone])
        return MuJoCoWarpSimulation.of(lanes, formulation, preset)
