"""PyBullet: friction of a motor in a joint, or of boxes pressed together."""

import importlib.util
import sys
from importlib.metadata import version
from typing import ClassVar

from engines.interface.engine import Engine
from engines.interface.presets import Capabilities, Formulation, FrictionLaw, Preset
from engines.pybullet.connection import Connection
from engines.pybullet.contact import CONTACT_DEFAULT, CONTACT_TUNED, PyBulletContactLane
from engines.pybullet.joint import JOINT_DEFAULT, JOINT_TUNED, PyBulletJointLane
from reference_lcp.chain.simulation import Lane, Simulation
from reference_lcp.stepping.sequential import SequentialSimulation


class PyBullet(Engine):
    """PyBullet, without graphics."""

    name: ClassVar[str] = "pybullet"
    capabilities: ClassVar[Capabilities] = Capabilities(
        title="PyBullet",
        package="pybullet",
        licence="Zlib",
        friction_law=FrictionLaw.COULOMB,
        presets={
            Formulation.JOINT: {"tuned": JOINT_TUNED, "default": JOINT_DEFAULT},
            Formulation.CONTACT: {"tuned": CONTACT_TUNED, "default": CONTACT_DEFAULT},
        },
        notes=(
            "Coulomb's law, exact in stick: in the joint a velocity motor of target zero and bounded impulse, in the "
            "contact boxes pressed on each other. Springs, dashpots and the drive are forces that the adapter "
            "computes at the start of each step; by default Bullet damps every body against the ground."
        ),
    )

    def version(self) -> str:
        """Version of the package."""
        return version("pybullet")

    def unavailable_reason(self) -> str | None:
        """Say why PyBullet cannot be used here."""
        if importlib.util.find_spec("pybullet") is not None:
            return None
        python = f"{sys.version_info.major}.{sys.version_info.minor}"
        return (
            "the package pybullet is not installed; pip install pybullet "
            f"(wheels exist for CPython 3.11 and older only, this is Python {python}: later ones compile from source)"
        )

    def _build(self, lanes: tuple[Lane, ...], formulation: Formulation, preset: Preset) -> Simulation:
        connection = Connection()
        model = PyBulletJointLane if formulation is Formulation.JOINT else PyBulletContactLane
        return SequentialSimulation.build(lanes, lambda lane: model(connection, lane, preset))
