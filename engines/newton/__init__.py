"""Newton: SolverSteel for chains, all lanes of a batch as worlds of one model; in scenes its other solvers too."""

from pathlib import Path
from typing import ClassVar

from multibody_xval.engines.interface.preset_file import presets_of
from multibody_xval.engines.interface.presets import Capabilities, Formulation, FrictionLaw, Preparation, Preset
from multibody_xval.engines.interface.tolerances import SINGLE_RESIDUAL
from multibody_xval.engines.newton.contact import ContactWorlds
from multibody_xval.engines.newton.joint import JointWorlds
from multibody_xval.engines.newton.scene import STEP, contacts, joints
from multibody_xval.engines.newton.worlds import NewtonSimulation
from multibody_xval.engines.shared.pip_engine import PipEngine
from multibody_xval.engines.shared.script_units import script_in_units
from multibody_xval.engines.shared.units import Units, check_mass_ratio
from multibody_xval.engines.shared.worlds_simulation import LaneAlone
from reference_lcp.chain.simulation import Lane, Simulation
from reference_lcp.schemes.sequential import SequentialSimulation

LARGEST_MASS_RATIO = 1000.0
"""Largest inner mass over the outer one of a cell.

The inner body hangs in the outer one, so that in single precision the outer mass is lost beside the inner: a period is
off by 4e-6 of the motion at 100, 3e-5 at 1,000, a tenth at 10,000.
"""


class Newton(PipEngine):
    """Newton on the processor, one thread, its step recorded as a graph."""

    name: ClassVar[str] = "newton"
    module: ClassVar[str] = "newton"
    # SolverSteel and its options may change from one version to the next, without notice.
    versions: ClassVar[str] = ">=1.8,<1.9"
    # Half a minute of a processor.
    preparation: ClassVar[Preparation | None] = Preparation("compiles its kernels", 300.0)
    capabilities: ClassVar[Capabilities] = Capabilities(
        title="Newton",
        optional=True,
        package="newton",
        licence="Apache-2.0",
        friction_law=FrictionLaw.COULOMB,
        presets=presets_of(Path(__file__).with_name("presets.toml"), "SolverSteel"),
        batch_lanes=64,
        precision="single",
        residual=SINGLE_RESIDUAL,
        notes=(
            "Coulomb's law, in single precision, by SolverSteel, the experimental one of Newton's solvers. On a "
            "processor it has no dry friction of joints; a velocity drive of bounded effort emulates it. SolverXPBD, "
            "SolverVBD and SolverKamino run scenes only."
        ),
    )
    reproducers: ClassVar = {
        Formulation.JOINT: script_in_units("reproducer_joint.py.jinja", Units.in_steps),
        Formulation.CONTACT: script_in_units(
            "reproducer_contact.py.jinja", Units.in_steps, rows_of_a_cell=ContactWorlds.rows_of_a_cell
        ),
    }

    scene_step: ClassVar[float] = STEP
    scene_worlds: ClassVar = {Formulation.JOINT: joints, Formulation.CONTACT: contacts}

    def _build(self, lanes: tuple[Lane, ...], formulation: Formulation, preset: Preset) -> Simulation:
        check_mass_ratio(lanes, LARGEST_MASS_RATIO, self.capabilities.title)
        kind = JointWorlds if formulation is Formulation.JOINT else ContactWorlds
        if preset["units"] == "SI":
            return SequentialSimulation([LaneAlone(NewtonSimulation([lane], kind, preset)) for lane in lanes])
        return NewtonSimulation(lanes, kind, preset)
