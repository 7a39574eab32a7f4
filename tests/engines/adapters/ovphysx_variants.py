"""ovphysx with other options than its presets have; it runs in the engine's environment, and needs nothing else."""

from dataclasses import replace
from typing import ClassVar

from engines.interface.presets import Capabilities, Formulation, Option, Preset
from engines.ovphysx import Ovphysx
from engines.ovphysx.presets import JOINT_DEFAULT, JOINT_TUNED

SUBSTEPS = ((1, 0), (1, 1), (4, 0), (4, 1), (32, 1))
"""Position and velocity iterations of the temporal solver."""


def varied(preset: Preset, **values: object) -> Preset:
    """Give a preset with some options replaced."""
    options = {name: Option(value, None, "") for name, value in values.items()}
    return replace(preset, options={**preset.options, **options})


def iterated(preset: Preset, position: int, velocity: int) -> Preset:
    """Give a preset with so many iterations."""
    return varied(preset, solverPositionIterationCount=position, solverVelocityIterationCount=velocity)


PRESETS = {
    "tuned": JOINT_TUNED,
    "default": JOINT_DEFAULT,
    "one-iteration": iterated(JOINT_TUNED, 1, 0),
    "hard-links": varied(iterated(JOINT_DEFAULT, 1, 0), cfmScale=0.0),
    **{f"{position}/{velocity}": iterated(JOINT_DEFAULT, position, velocity) for position, velocity in SUBSTEPS},
}


class OvphysxVariants(Ovphysx):
    """ovphysx with the presets of `PRESETS`."""

    capabilities: ClassVar[Capabilities] = replace(Ovphysx.capabilities, presets={Formulation.JOINT: PRESETS})
