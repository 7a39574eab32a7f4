"""Pinocchio: dry friction of joints as a constraint, solved by projected Gauss-Seidel or by ADMM."""

from pathlib import Path
from typing import ClassVar

from multibody_xval.engines.interface.preset_file import presets_of
from multibody_xval.engines.interface.presets import Capabilities, Formulation, FrictionLaw
from multibody_xval.engines.pinocchio.joint import PinocchioJointLane
from multibody_xval.engines.shared.pip_engine import PipEngine
from multibody_xval.engines.shared.script_units import script_in_si


class Pinocchio(PipEngine):
    """Pinocchio: its dynamics and its constraint solvers, put together to a time step."""

    name: ClassVar[str] = "pinocchio"
    module: ClassVar[str] = "pinocchio"
    versions: ClassVar[str] = ">=4"
    capabilities: ClassVar[Capabilities] = Capabilities(
        title="Pinocchio",
        optional=True,
        package="pin",
        licence="BSD-2-Clause",
        friction_law=FrictionLaw.COULOMB,
        presets=presets_of(Path(__file__).with_name("presets.toml"), "Pinocchio"),
        notes=(
            "Coulomb's law, exact in stick by projected Gauss-Seidel. Pinocchio takes no steps by itself: a step here "
            "is its forward dynamics without friction, its solver for the impulses, its forward dynamics with them, "
            "and its integration of positions. Springs, dashpots and drive are forces at the start of the step."
        ),
    )

    lane_models: ClassVar = {Formulation.JOINT: PinocchioJointLane}
    reproducers: ClassVar = {Formulation.JOINT: script_in_si("reproducer_joint.py.jinja")}
    no_scenes: ClassVar[str] = "Pinocchio takes no steps by itself: its user writes them"
