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

HAS_WHEELS = sys.version_info < (3, 12)
"""Whether the suite brings PyBullet: its only wheels are for Python 3.11 and older (`pyproject.toml` has the same)."""


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
        optional=not HAS_WHEELS,
    )

    reproducers: ClassVar = {
        Formulation.JOINT: script_in_si("reproducer_joint.py.jinja"),
        Formulation.CONTACT: script_in_si("reproducer_contact.py.jinja", rest=REST_DEPTH, plate=PLATE, spacing=SPACING),
    }

    scene_step: ClassVar[float] = STEP
    scene_worlds: ClassVar = {Formulation.JOINT: joints, Formulation.CONTACT: contacts}

    @property
    def _remedy(self) -> str:
        """The command that installs PyBullet, and what it does where there is no wheel."""
        command = f"pip install '{self.module}{self.versions}'"
        python = f"{sys.version_info.major}.{sys.version_info.minor}"
        return command if HAS_WHEELS else f"{command}, which compiles it: it has no wheel for Python {python}"

    def _build(self, lanes: tuple[Lane, ...], formulation: Formulation, preset: Preset) -> Simulation:
        connection = Connection()
        model = PyBulletJointLane if formulation is Formulation.JOINT else PyBulletContactLane
        return SequentialSimulation([model(lane, preset, connection) for lane in lanes])
