"""DART: the Coulomb friction of a joint, or a body pressed on a plate."""

import importlib.util
from importlib.metadata import version
from typing import ClassVar

from engines.dart.contact import CONTACT_DEFAULT, CONTACT_SPHERE, CONTACT_TUNED, DartContactLane
from engines.dart.joint import JOINT_DEFAULT, JOINT_TUNED, RESIDUAL_SLIP_COMPLIANCE, DartJointLane
from engines.interface.engine import Engine
from engines.interface.presets import Capabilities, Formulation, FrictionLaw, Preset
from reference_lcp.chain.simulation import Lane, Simulation
from reference_lcp.stepping.sequential import SequentialSimulation


class Dart(Engine):
    """DART, without graphics."""

    name: ClassVar[str] = "dart"
    capabilities: ClassVar[Capabilities] = Capabilities(
        title="DART",
        optional=True,
        package="dartpy",
        licence="BSD-2-Clause",
        friction_law=FrictionLaw.COULOMB,
        presets={
            Formulation.JOINT: {"tuned": JOINT_TUNED, "default": JOINT_DEFAULT},
            Formulation.CONTACT: {"tuned": CONTACT_TUNED, "default": CONTACT_DEFAULT, "sphere": CONTACT_SPHERE},
        },
        notes=(
            "Coulomb's law as a boxed LCP, solved by pivoting, whose diagonal is enlarged by a part that cannot be set "
            f"to less than {RESIDUAL_SLIP_COMPLIANCE:g} in joints, and not at all in contacts, "
            "where normal forces err by 2.5e-6 at first. By default joints have their own springs and dashpots, "
            "implicit ones, which damp the motion by as much as the time step is long."
        ),
    )

    def version(self) -> str:
        """Version of the package."""
        return version("dartpy")

    def unavailable_reason(self) -> str | None:
        """Say why DART cannot be used here."""
        if importlib.util.find_spec("dartpy") is None:
            return "the package dartpy is not installed; pip install 'multibody-xval[engines]'"
        return None

    def _build(self, lanes: tuple[Lane, ...], formulation: Formulation, preset: Preset) -> Simulation:
        model = DartJointLane if formulation is Formulation.JOINT else DartContactLane
        return SequentialSimulation.build(lanes, lambda lane: model(lane, preset))
