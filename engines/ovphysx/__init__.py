"""ovphysx, which is PhysX 5: the friction of an articulation's joints, all lanes of a batch in one scene."""

from typing import ClassVar

from engines.interface.presets import Capabilities, Formulation, FrictionLaw, Preset
from engines.interface.tolerances import SUBSTEPS_RESIDUAL
from engines.ovphysx.presets import JOINT_DEFAULT, JOINT_TUNED
from engines.ovphysx.simulation import OvphysxSimulation
from engines.shared.pip_engine import PipEngine
from reference_lcp.chain.simulation import Lane, Simulation


class Ovphysx(PipEngine):
    """ovphysx on the processor, one thread, in an environment of its own."""

    name: ClassVar[str] = "ovphysx"
    module: ClassVar[str] = "ovphysx"
    versions: ClassVar[str] = ">=0.7,<0.8"
    # It takes packaging before 24 only, which would hold back other packages beside the suite.
    apart: ClassVar[bool] = True
    environment_packages: ClassVar[tuple[str, ...]] = ("ovstage", "physx-usd-schemas", "newton-usd-schemas")
    capabilities: ClassVar[Capabilities] = Capabilities(
        title="ovphysx (PhysX)",
        optional=True,
        package="ovphysx",
        licence="LicenseRef-NVIDIA-Omniverse",
        terms="https://www.nvidia.com/en-us/agreements/enterprise-software/product-specific-terms-for-omniverse",
        friction_law=FrictionLaw.COULOMB,
        presets={Formulation.JOINT: {"tuned": JOINT_TUNED, "default": JOINT_DEFAULT}},
        batch_lanes=64,
        precision="single",
        residual=SUBSTEPS_RESIDUAL,
        notes=(
            "Coulomb's law, in single precision: a motion repeats to some 1e-6 of its size, and no closer. Joints have "
            "a static and a dynamic friction in newtons, and report it. What PhysX calls position iterations of "
            "its temporal solver are substeps over which forces do not change: with an articulation's own 32, springs "
            "act late by half a step."
        ),
    )

    def _build(self, lanes: tuple[Lane, ...], formulation: Formulation, preset: Preset) -> Simulation:
        return OvphysxSimulation(lanes, preset)
