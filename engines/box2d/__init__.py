"""Box2D: the motor of a joint, a friction joint, or a box pressed on a plate."""

import importlib.util
from importlib.metadata import version
from typing import ClassVar

from engines.box2d.contact import CONTACT_DEFAULT, CONTACT_TUNED, Box2DContactLane
from engines.box2d.joint import JOINT_DEFAULT, JOINT_TUNED, Box2DJointLane
from engines.interface.engine import Engine
from engines.interface.presets import Capabilities, Formulation, FrictionLaw, Preset
from reference_lcp.chain.simulation import Lane, Simulation
from reference_lcp.stepping.sequential import SequentialSimulation


class Box2D(Engine):
    """Box2D 2.3, in single precision."""

    name: ClassVar[str] = "box2d"
    capabilities: ClassVar[Capabilities] = Capabilities(
        title="Box2D",
        optional=True,
        package="Box2D",
        licence="Zlib",
        friction_law=FrictionLaw.COULOMB,
        presets={
            Formulation.JOINT: {"tuned": JOINT_TUNED, "default": JOINT_DEFAULT},
            Formulation.CONTACT: {"tuned": CONTACT_TUNED, "default": CONTACT_DEFAULT},
        },
        precision="single",
        # Positions and velocities are rounded by 2^-24 of themselves in every step: of one period of 400 steps,
        # this adds up to 1e-6 of the displacement scale or somewhat more, and no mixing of iterates removes it.
        residual=1e-5,
        notes=(
            "Coulomb's law, exact in stick, in single precision: a motion repeats to some 1e-6 of its size, and no "
            "closer. By default springs are distance joints, implicit and therefore damping, and bodies that move "
            "slower than 0.01 m/s for half a second are stopped."
        ),
    )

    def version(self) -> str:
        """Version of the package."""
        return version("Box2D")

    def unavailable_reason(self) -> str | None:
        """Say why Box2D cannot be used here."""
        if importlib.util.find_spec("Box2D") is None:
            return "the package Box2D is not installed; pip install 'multibody-xval[engines]'"
        return None

    def _build(self, lanes: tuple[Lane, ...], formulation: Formulation, preset: Preset) -> Simulation:
        model = Box2DJointLane if formulation is Formulation.JOINT else Box2DContactLane
        return SequentialSimulation.build(lanes, lambda lane: model(lane, preset))
