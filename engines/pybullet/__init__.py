"""PyBullet: friction emulated by a motor in a joint, or of boxes pressed together."""

import sys
from pathlib import Path
from typing import ClassVar

from multibody_xval.engines.interface.preset_file import presets_of
from multibody_xval.engines.interface.presets import Capabilities, Formulation, FrictionLaw, Preset
from multibody_xval.engines.pybullet.contact import PLATE, REST_DEPTH, SPACING, PyBulletContactLane
from multibody_xval.engines.pybullet.joint import Connection, PyBulletJointLane
from multibody_xval.engines.pybullet.scene import STEP, contacts, joints
from multibody_xval.engines.shared.pip_engine import PipEngine
from multibody_xval.engines.shared.script_units import script_in_si
from reference_lcp.chain.simulation import Lane, Simulation
from reference_lcp.schemes.sequential import SequentialSimulation


class PyBullet(PipEngine):
    """PyBullet, without graphics."""

    name: ClassVar[str] = "pybullet"
    module: ClassVar[str] = "pybullet"
    versions: ClassVar[str] = ">=3.2.7"
    capabilities: ClassVar[Capabilities] = Capabilities(
        title="PyBullet",
        package="pybullet",
        licence="Zlib",
        friction_law=FrictionLaw.COULOMB,
        presets=presets_of(Path(__file__).with_name("presets.toml"), "PyBullet"),
        notes=(
            "Coulomb's law, exact in stick: in the joint emulated by a velocity motor of target zero and bounded "
            "impulse, as is usual with Bullet, in the contact boxes pressed on each other. Springs, dashpots and the "
            "drive are forces that the adapter computes at the start of each step; by default Bullet damps every body "
            "against the ground."
        ),
    )

    reproducers: ClassVar = {
        Formulation.JOINT: script_in_si("reproducer_joint.py.jinja"),
        Formulation.CONTACT: script_in_si("reproducer_contact.py.jinja", rest=REST_DEPTH, plate=PLATE, spacing=SPACING),
    }

    scene_step: ClassVar[float] = STEP
    scene_worlds: ClassVar = {Formulation.JOINT: joints, Formulation.CONTACT: contacts}

    def unavailable_reason(self) -> str | None:
        """Reason why PyBullet cannot be used here, with the Pythons that it has wheels for."""
        missing = super().unavailable_reason()
        if missing is None:
            return None
        python = f"this is Python {sys.version_info.major}.{sys.version_info.minor}"
        return f"{missing} (wheels exist for CPython 3.11 and older only, {python}: later ones compile from source)"

    def _build(self, lanes: tuple[Lane, ...], formulation: Formulation, preset: Preset) -> Simulation:
        connection = Connection()
        model = PyBulletJointLane if formulation is Formulation.JOINT else PyBulletContactLane
        return SequentialSimulation([model(lane, preset, connection) for lane in lanes])
