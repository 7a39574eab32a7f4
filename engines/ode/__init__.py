"""ODE: friction emulated by a slider's motor, or of spheres or boxes pressed on plates, in another Python."""

from pathlib import Path
from typing import ClassVar

from multibody_xval.engines.interface.preset_file import presets_of
from multibody_xval.engines.interface.presets import Capabilities, Formulation, FrictionLaw
from multibody_xval.engines.isolated.out_of_process import OutOfProcessEngine, OutOfProcessLane
from multibody_xval.engines.ode.scene import STEP, contacts, joints
from multibody_xval.engines.shared.script_units import script_in_si

BOX = 4.0
"""Half of a box's edge, or a sphere's radius, over the displacement scale of the drive."""

PLATE = 2.0**20
"""Half of a plate's length over the displacement scale; beyond, inner masses fall off."""

SPACING = 8 * BOX
"""Distance of neighbouring cells over the displacement scale, across the motion."""


class ODELane(OutOfProcessLane):
    """One chain in ODE."""

    sizes: ClassVar = {"box": BOX, "plate": PLATE, "spacing": SPACING}


class ODE(OutOfProcessEngine):
    """The Open Dynamics Engine in a Python that has pyode: the system's, or the one of an environment variable."""

    name: ClassVar[str] = "ode"
    capabilities: ClassVar[Capabilities] = Capabilities(
        title="ODE",
        optional=True,
        package="python3-pyode",
        licence="BSD-3-Clause or LGPL-2.1-or-later",
        friction_law=FrictionLaw.COULOMB,
        presets=presets_of(Path(__file__).with_name("presets.toml"), "ODE"),
        notes=(
            "Coulomb's law, exact in stick: in the joint emulated by a slider's motor of target zero and bounded "
            "force, in the contact spheres or boxes on plates. Springs, dashpots and the drive are forces that are "
            "computed at the start of each step. In contacts, mu is a force unless a mode says otherwise."
        ),
    )
    server: ClassVar[Path] = Path(__file__).with_name("server.py")
    lane_model: ClassVar[type[OutOfProcessLane]] = ODELane
    reproducers: ClassVar = {
        Formulation.JOINT: script_in_si("reproducer_joint.py.jinja"),
        Formulation.CONTACT: script_in_si("reproducer_contact.py.jinja", box=BOX, plate=PLATE, spacing=SPACING),
    }
    scene_step: ClassVar[float] = STEP
    scene_worlds: ClassVar = {Formulation.JOINT: joints, Formulation.CONTACT: contacts}
