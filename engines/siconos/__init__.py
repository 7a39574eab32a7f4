"""Siconos: friction as a nonsmooth law, a relay in a joint or a contact of two pressed masses, in another Python."""

from pathlib import Path
from typing import ClassVar

from engines.interface.presets import Capabilities, Formulation, FrictionLaw, Option, Preset
from engines.out_of_process.engine import OutOfProcessEngine
from engines.out_of_process.interpreter import Installation
from engines.out_of_process.lane import OutOfProcessLane
from reference_lcp.validation import FloatArray

INSTALLATION = Installation(
    "siconos",
    Path(__file__).with_name("server.py"),
    "MULTIBODY_XVAL_SICONOS_PYTHON",
    "apt install python3-siconos",
)

_TUNED = {
    "units": Option("lane", "SI", "Lemke's pivots and the clock of events then meet no built-in small number."),
    "theta": Option(0.5, "none", "Trapezoidal, of second order while nothing starts or stops; 1 is implicit Euler."),
    "springs": Option("own", "own", "Stiffness and damping matrix of LagrangianLinearTIDS, at the time that θ says."),
    "newton": Option("linear", "nonlinear", "One iteration a step, for all is linear but the friction."),
}

JOINT_TUNED = Preset(
    "Moreau–Jean with θ = ½ and relays solved by Lemke: the trapezoidal rule with exact Coulomb friction.",
    {
        **_TUNED,
        "activation": Option(
            "always", "gap <= 0", "A large negative offset in the relation: Siconos skips relays of a positive gap."
        ),
        "interactions": Option("one a bound", "one a contact", "One relation of several rows: a quarter of the time."),
        "solver": Option("LEMKE", "AVI_CAOFERRIS", "Exact, and named like the reference's; both give the same."),
    },
    split_tolerance=1e-12,
)

JOINT_EULER = Preset(
    "θ = 1 with springs and dashpots as forces at the start of a step: equation (5), solved by another code.",
    {
        **JOINT_TUNED.options,
        "theta": Option(1.0, "none", "Positions advance with the velocity at the end of a step."),
        "springs": Option("forces", "own", "External forces that the adapter computes from the start of the step."),
    },
    shares_scheme=True,
    split_tolerance=1e-12,
)

JOINT_DEFAULT = Preset(
    "A relay a contact in SI units, as one would write it; it differs from the tuned one in cost only.",
    {
        "units": Option("SI", "SI", "The numbers of the chain as they are."),
        "theta": Option(0.5, "none", "Needed; the value of Siconos's examples."),
        "springs": Option("own", "own", "Stiffness and damping matrix of LagrangianLinearTIDS."),
        "newton": Option("nonlinear", "nonlinear", "Siconos's own."),
        "activation": Option(
            "always", "gap <= 0", "Needed: an inner mass ahead of its outer one would feel no friction, without a word."
        ),
        "interactions": Option("one a contact", "one a contact", "As examples do."),
        "solver": Option("AVI_CAOFERRIS", "AVI_CAOFERRIS", "Siconos's own."),
    },
    split_tolerance=1e-12,
)

CONTACT_TUNED = Preset(
    "Moreau–Jean with θ = ½, and a contact solver that goes on to round-off.",
    {
        **_TUNED,
        "solver": Option("NSGS", "NSGS", "Gauss–Seidel over the contacts; Lemke parts a contact now and then."),
        "tolerance": Option(1e-14, 1e-4, "Of NSGS: it stops early otherwise, and motions err by 1e-6 of U0."),
        "threshold": Option(
            1e-6, 0.0, "Gap over the displacement scale up to which a contact acts: round-off is none."
        ),
    },
    split_tolerance=1e-12,
)

CONTACT_DEFAULT = Preset(
    "The same contacts in SI units, with Siconos's own solver and tolerance.",
    {
        "units": Option("SI", "SI", "The numbers of the chain as they are."),
        "theta": Option(0.5, "none", "Needed; the value of Siconos's examples."),
        "springs": Option("own", "own", "Stiffness and damping matrix of LagrangianLinearTIDS."),
        "newton": Option("nonlinear", "nonlinear", "Siconos's own."),
        "solver": Option("NSGS", "NSGS", "Siconos's own."),
        "tolerance": Option(1e-4, 1e-4, "Siconos's own."),
        "threshold": Option(0.0, 0.0, "Siconos's own: a contact acts where its gap is not positive."),
    },
    split_tolerance=1e-12,
    known_deviation=(
        "a contact acts where its gap is not positive only: round-off opens a closed one now and then for a step or "
        "two, which have no friction; and the contact solver stops at 1e-4"
    ),
)


class SiconosLane(OutOfProcessLane):
    """One chain in Siconos."""

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
        presets={
            Formulation.JOINT: {"tuned": JOINT_TUNED, "euler": JOINT_EULER, "default": JOINT_DEFAULT},
            Formulation.CONTACT: {"tuned": CONTACT_TUNED, "default": CONTACT_DEFAULT},
        },
        notes=(
            "Exact Coulomb friction by a complementarity problem in each step of the Moreau–Jean θ-scheme, which takes "
            "springs and dashpots in implicitly. A relay acts only while its gap is not positive, and no word is said "
            "of it: both presets of the joint start it deep below."
        ),
    )
    installation: ClassVar[Installation] = INSTALLATION
    lane_model: ClassVar[type[OutOfProcessLane]] = SiconosLane
