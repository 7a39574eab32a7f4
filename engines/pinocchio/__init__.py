"""Pinocchio: dry friction of joints as a constraint, solved by projected Gauss-Seidel or by ADMM."""

import importlib.util
from importlib.metadata import version
from typing import ClassVar

from engines.interface.engine import Engine
from engines.interface.presets import Capabilities, Formulation, FrictionLaw, Preset
from engines.pinocchio.joint import JOINT_ADMM, JOINT_DEFAULT, JOINT_TUNED, PinocchioJointLane
from reference_lcp.chain.simulation import Lane, Simulation
from reference_lcp.stepping.sequential import SequentialSimulation


class Pinocchio(Engine):
    """Pinocchio: its dynamics and its constraint solvers, put together to a time step."""

    name: ClassVar[str] = "pinocchio"
    capabilities: ClassVar[Capabilities] = Capabilities(
        title="Pinocchio",
        optional=True,
        package="pin",
        licence="BSD-2-Clause",
        friction_law=FrictionLaw.COULOMB,
        presets={Formulation.JOINT: {"tuned": JOINT_TUNED, "default": JOINT_DEFAULT, "admm": JOINT_ADMM}},
        notes=(
            "Coulomb's law, exact in stick by projected Gauss-Seidel. Pinocchio takes no steps by itself: a step here "
            "is its forward dynamics without friction, its solver for the impulses, its forward dynamics with them, "
            "and its integration of positions. Springs, dashpots and drive are forces at the start of the step."
        ),
    )

    def version(self) -> str:
        """Version of the package."""
        return version("pin")

    def unavailable_reason(self) -> str | None:
        """Say why Pinocchio cannot be used here; older versions have no friction of joints."""
        advice = "pip install 'multibody-xval[engines]'"
        if importlib.util.find_spec("pinocchio") is None:
            return f"the package pin is not installed; {advice}"
        if int(self.version().split(".")[0]) < 4:
            return f"pin {self.version()} has no friction of joints, version 4.0 or newer is needed; {advice}"
        return None

    def _build(self, lanes: tuple[Lane, ...], formulation: Formulation, preset: Preset) -> Simulation:
        return SequentialSimulation.build(lanes, lambda lane: PinocchioJointLane(lane, preset))
