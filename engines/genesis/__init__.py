"""Genesis: MuJoCo's formulation, written again, in which the normal force of a contact need not feel its friction."""

from pathlib import Path
from typing import ClassVar

from multibody_xval.engines.genesis.contact import ContactSimulation, FreeContactSimulation, share_a_scene
from multibody_xval.engines.genesis.joint import JointSimulation
from multibody_xval.engines.genesis.scene import STEP, contacts, joints
from multibody_xval.engines.interface.preset_file import presets_of
from multibody_xval.engines.interface.presets import Capabilities, Formulation, FrictionLaw, Preparation, Preset
from multibody_xval.engines.shared.pip_engine import PipEngine
from multibody_xval.engines.shared.worlds_simulation import LaneAlone
from reference_lcp.chain.simulation import Lane, Simulation
from reference_lcp.schemes.sequential import SequentialSimulation


class Genesis(PipEngine):
    """Genesis on the processor, one thread, in double precision."""

    name: ClassVar[str] = "genesis"
    module: ClassVar[str] = "genesis"
    versions: ClassVar[str] = ">=1.4.5,<1.5"
    extra: ClassVar[str] = "genesis"
    # Half a minute of a processor a formulation; ten times as much where it is busy with other things.
    preparation: ClassVar[Preparation | None] = Preparation("compiles its kernels", 600.0)
    capabilities: ClassVar[Capabilities] = Capabilities(
        title="Genesis",
        optional=True,
        package="genesis-world",
        licence="Apache-2.0",
        friction_law=FrictionLaw.REGULARISED,
        presets=presets_of(Path(__file__).with_name("presets.toml"), "Genesis"),
        batch_lanes=64,
        notes=(
            "MuJoCo's laws with half of its time constant: by default friction is a soft constraint, and a stuck "
            "contact creeps. Unlike MuJoCo, Genesis can bound the friction of a contact by the normal force that the "
            "contact has, so that friction does not press; then, and with the no-slip sweep of joints, a motion "
            "equals equation (5)."
        ),
    )

    scene_step: ClassVar[float] = STEP
    scene_worlds: ClassVar = {Formulation.JOINT: joints, Formulation.CONTACT: contacts}

    def _build(self, lanes: tuple[Lane, ...], formulation: Formulation, preset: Preset) -> Simulation:
        if formulation is Formulation.JOINT:
            return JointSimulation(lanes, preset)
        kind = ContactSimulation if lanes[0].preload is None else FreeContactSimulation
        if share_a_scene(lanes, preset):
            return kind(lanes, preset)
        return SequentialSimulation([LaneAlone(kind([lane], preset)) for lane in lanes])
