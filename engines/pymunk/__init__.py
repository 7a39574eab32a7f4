"""pymunk: a pivot joint of bounded force, or a box pressed on a plate."""

from pathlib import Path
from typing import ClassVar

from multibody_xval.engines.interface.preset_file import presets_of
from multibody_xval.engines.interface.presets import Capabilities, Formulation, FrictionLaw, Preset
from multibody_xval.engines.pymunk.contact import DEPTH, PymunkBoxes
from multibody_xval.engines.pymunk.joint import PymunkJoints
from multibody_xval.engines.pymunk.scene import STEP, contacts, joints
from multibody_xval.engines.pymunk.simulation import SPRING_LENGTH
from multibody_xval.engines.shared.pip_engine import PipEngine
from multibody_xval.engines.shared.script_units import script_in_si
from multibody_xval.engines.shared.worlds_simulation import LaneAlone
from reference_lcp.chain.simulation import Lane, Simulation
from reference_lcp.schemes.sequential import SequentialSimulation


class Pymunk(PipEngine):
    """pymunk, Chipmunk's bodies in the plane."""

    name: ClassVar[str] = "pymunk"
    module: ClassVar[str] = "pymunk"
    versions: ClassVar[str] = ">=6.11.1"
    capabilities: ClassVar[Capabilities] = Capabilities(
        title="pymunk",
        optional=True,
        package="pymunk",
        licence="MIT",
        friction_law=FrictionLaw.COULOMB,
        presets=presets_of(Path(__file__).with_name("presets.toml"), "pymunk"),
        batch_lanes=16,
        notes=(
            "Coulomb's law, exact in stick: a joint that holds two bodies together with bounded force, or boxes "
            "pressed on plates. Positions are advanced before velocities; the tuned presets evaluate forces in "
            "between, which is the scheme of equation (5). A joint gives the size of its force, and the momentum "
            "gained the sign."
        ),
    )
    reproducers: ClassVar = {
        Formulation.JOINT: script_in_si("reproducer_joint.py.jinja", length=SPRING_LENGTH),
        Formulation.CONTACT: script_in_si("reproducer_contact.py.jinja", length=SPRING_LENGTH, depth=DEPTH),
    }

    def _build(self, lanes: tuple[Lane, ...], formulation: Formulation, preset: Preset) -> Simulation:
        kind = PymunkJoints if formulation is Formulation.JOINT else PymunkBoxes
        if preset["units"] == "lane":
            return kind(lanes, preset)
        # In SI units time steps differ, and with them what one space can take.
        return SequentialSimulation([LaneAlone(kind([lane], preset)) for lane in lanes])

    scene_step: ClassVar[float] = STEP
    scene_worlds: ClassVar = {Formulation.JOINT: joints, Formulation.CONTACT: contacts}
