"""Options of Pinocchio's presets as the settings of its solvers, in SI units."""

from collections.abc import Mapping
from typing import Any

from engines.interface.presets import Preset
from engines.interface.reproducer import Reproducer
from reference_lcp.chain.simulation import Lane
from reference_lcp.chain.trajectory import State


def joint_numbers(_lane: Lane, preset: Preset, _start: State) -> Mapping[str, Any]:
    """Give the solver, and its settings where the tolerance is not Pinocchio's own."""
    tolerance = preset.options["tolerance"]
    return {
        "solver": preset["solver"],
        "tolerance": tolerance.value if tolerance.value != tolerance.default else None,
        "iterations": preset["max_iterations"],
    }


JOINT = Reproducer("reproducer_joint.py.jinja", joint_numbers)
