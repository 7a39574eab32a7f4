"""Siconos: friction as a nonsmooth law, a relay in a joint or a contact of two pressed masses, in another Python."""

from pathlib import Path
from typing import ClassVar

from multibody_xval.engines.interface.preset_file import presets_of
from multibody_xval.engines.interface.presets import Capabilities, Formulation, FrictionLaw
from multibody_xval.engines.isolated.out_of_process import OutOfProcessEngine, OutOfProcessLane
from multibody_xval.engines.shared.script_units import script_in_si
from multibody_xval.engines.siconos.scene import STEP, contacts
from reference_lcp.validation import FloatArray

DEEP = 1e9
"""Depth at which every relay starts, over the displacement scale: no motion brings it to the surface."""


class SiconosLane(OutOfProcessLane):
    """One chain in Siconos."""

    sizes: ClassVar = {"deep": DEEP}

    def _loads(self, start: int, steps: int) -> FloatArray:
        """Force on cell 1 [N] as the θ-scheme takes it: (1 − θ) F(t) + θ F(t + dt); as forces, at the start."""
        loads = self.lane.loads(start, steps + 1)
        theta = float(self._preset["theta"]) if self._preset["springs"] == "own" else 0.0
        weighted: FloatArray = (1 - theta) * loads[:-1] + theta * loads[1:]
        return weighted


class Siconos(OutOfProcessEngine):
    """Siconos in a Python that has it: the system's, or the one that an environment variable names."""

    name: ClassVar[str] = "siconos"
    capabilities: ClassVar[Capabilities] = Capabilities(
        title="Siconos",
        optional=True,
        package="python3-siconos",
        licence="Apache-2.0",
        friction_law=FrictionLaw.COULOMB,
        presets=presets_of(Path(__file__).with_name("presets.toml"), "Siconos"),
        notes=(
            "Exact Coulomb friction by a complementarity problem in each step of the Moreau–Jean θ-scheme, which takes "
            "springs and dashpots in implicitly. A relay acts only while its gap is not positive, and Siconos "
            "gives no warning: all presets of the joint start it deep below."
        ),
    )
    server: ClassVar[Path] = Path(__file__).with_name("server.py")
    lane_model: ClassVar[type[OutOfProcessLane]] = SiconosLane
    reproducers: ClassVar = {
        Formulation.JOINT: script_in_si("reproducer_joint.py.jinja", deep=DEEP),
        Formulation.CONTACT: script_in_si("reproducer_contact.py.jinja"),
    }
    scene_step: ClassVar[float] = STEP
    scene_worlds: ClassVar = {Formulation.CONTACT: contacts}
    no_scenes: ClassVar[str] = "beside constraints of bodies Siconos solves for no relay, which a joint's friction is"
