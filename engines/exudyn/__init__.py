"""Exudyn: the chain as one generic second-order object, with a dry-friction connector in every cell.

The connector `CoordinateSpringDamperExt` has two friction laws, and each is an engine of its own here:
a force proportional to velocity within a narrow zone, and a bristle that sticks until it breaks. Discs pressed
on planes have the first law only.
"""

from pathlib import Path
from typing import ClassVar

from multibody_xval.engines.exudyn.contact import ContactLane
from multibody_xval.engines.exudyn.joint import BristleLane, RegularisedLane
from multibody_xval.engines.exudyn.reproducer import bristle_numbers, disc_numbers, zone_numbers
from multibody_xval.engines.exudyn.scene import NO_CONTACTS, STEP, joints
from multibody_xval.engines.interface.preset_file import presets_of
from multibody_xval.engines.interface.presets import Capabilities, Formulation, FrictionLaw
from multibody_xval.engines.shared.pip_engine import PipEngine
from multibody_xval.engines.shared.script_units import script_in_si


class Exudyn(PipEngine):
    """What both engines have."""

    module: ClassVar[str] = "exudyn"
    versions: ClassVar[str] = ">=1.13.6"
    scene_step: ClassVar[float] = STEP
    scene_worlds: ClassVar = {Formulation.JOINT: joints}
    no_scenes: ClassVar[str] = NO_CONTACTS


class ExudynRegularised(Exudyn):
    """Exudyn, friction proportional to the relative velocity within a narrow zone."""

    name: ClassVar[str] = "exudyn-regularised"
    capabilities: ClassVar[Capabilities] = Capabilities(
        title="Exudyn, regularised",
        package="exudyn",
        licence="BSD-3-Clause",
        friction_law=FrictionLaw.REGULARISED,
        presets=presets_of(Path(__file__).with_name("presets_regularised.toml"), "Exudyn"),
        notes=(
            "Friction is proportional to the relative velocity below the width of a zone, so that a stuck contact "
            "creeps; the transmittance errs in proportion to the width, most where cells hardly move."
        ),
    )
    lane_models: ClassVar = {Formulation.JOINT: RegularisedLane, Formulation.CONTACT: ContactLane}
    reproducers: ClassVar = {
        Formulation.JOINT: script_in_si("reproducer_joint.py.jinja", zone_numbers),
        Formulation.CONTACT: script_in_si("reproducer_contact.py.jinja", disc_numbers),
    }


class ExudynBristle(Exudyn):
    """Exudyn, friction as a bristle: a stiff spring and dashpot until the bound is reached."""

    name: ClassVar[str] = "exudyn-bristle"
    capabilities: ClassVar[Capabilities] = Capabilities(
        title="Exudyn, bristle",
        package="exudyn",
        licence="BSD-3-Clause",
        friction_law=FrictionLaw.BRISTLE,
        presets=presets_of(Path(__file__).with_name("presets_bristle.toml"), "Exudyn"),
        notes=(
            "A stuck contact is a stiff spring and dashpot and gives way by F / k_s; a slipping one sticks only from "
            "the end of a substep on, so that the period map jumps, and some orbits repeat to 1e-3 and not to 1e-8."
        ),
    )
    lane_models: ClassVar = {Formulation.JOINT: BristleLane}
    reproducers: ClassVar = {Formulation.JOINT: script_in_si("reproducer_joint.py.jinja", bristle_numbers)}
