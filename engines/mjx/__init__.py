"""MJX: MuJoCo's equations on JAX, all lanes of a batch as worlds of one model."""

from typing import ClassVar

from engines.interface.presets import Capabilities, Formulation, FrictionLaw, Preparation, Preset
from engines.mjx.presets import JOINT_RECOMMENDED, JOINT_TUNED
from engines.mjx.scene import joints
from engines.mjx.worlds import SIZES, MJXWorlds
from engines.mujoco.presets import JOINT_DEFAULT
from engines.mujoco.scene import STEP
from engines.mujoco.worlds import ModelsSimulation
from engines.shared.pip_engine import PipEngine
from reference_lcp.chain.simulation import Lane, Simulation
from reference_lcp.errors import ParameterError


class MJX(PipEngine):
    """MJX on the processor, in double precision, one thread."""

    name: ClassVar[str] = "mjx"
    module: ClassVar[str] = "mujoco.mjx"
    versions: ClassVar[str] = ">=3.17,<3.18"
    # JAX starts threads, after which no process of the suite could be forked. MuJoCo is that of the same release.
    apart: ClassVar[bool] = True
    environment_packages: ClassVar[tuple[str, ...]] = ("mujoco>=3.17,<3.18", "jax>=0.10.2,<0.11")
    # Three sizes of batches, four seconds of a processor each, ten where it is busy; ten times as much is a hang.
    preparation: ClassVar[Preparation | None] = Preparation("compiles its steps", 300.0, SIZES)
    capabilities: ClassVar[Capabilities] = Capabilities(
        title="MJX",
        optional=True,
        package="mujoco-mjx",
        licence="Apache-2.0",
        friction_law=FrictionLaw.REGULARISED,
        presets={
            Formulation.JOINT: {"tuned": JOINT_TUNED, "recommended": JOINT_RECOMMENDED, "default": JOINT_DEFAULT},
        },
        batch_lanes=SIZES[-1],
        # A stuck joint creeps to where its spring is slack, with a time constant of 1e5 periods at 400 steps a
        # period: a chain whose cells stuck a hundredth of U0 away from there is 1e-7 U0 nearer after a period.
        residual=1e-7,
        notes=(
            "MuJoCo's laws by another code: by default friction is a soft constraint with a time constant. MJX ignores "
            "noslip_iterations, so that the tuned preset has no sweep without softness; its friction is as hard "
            "as MuJoCo lets it be, and a stuck joint keeps a ten-thousandth of its velocity in a step. Contacts are "
            "left out: its line search fails in steps in which one of them starts or stops."
        ),
    )
    scene_step: ClassVar[float] = STEP
    scene_worlds: ClassVar = {Formulation.JOINT: joints}
    no_scenes: ClassVar[str] = "its line search fails in steps in which a contact starts or stops"

    def _build(self, lanes: tuple[Lane, ...], formulation: Formulation, preset: Preset) -> Simulation:
        sweeps = preset["noslip_iterations"]
        if sweeps != 0:
            raise ParameterError(f"noslip_iterations = {sweeps}; allowed: 0 in MJX, which ignores it")
        return ModelsSimulation.of(lanes, formulation, preset, MJXWorlds)
