"""Options of Drake's presets as the arguments of its calls, in SI units."""

from collections.abc import Mapping
from typing import Any

import numpy as np

from engines.interface.presets import Preset
from engines.interface.reproducer import Reproducer
from reference_lcp.chain.simulation import Lane
from reference_lcp.chain.trajectory import State


def joint_numbers(lane: Lane, preset: Preset, _start: State) -> Mapping[str, Any]:
    """Give the gain of every actuator [N s/m]."""
    chain = lane.chain
    if "PdControllerGains.d" in preset.options:
        return {"gain": np.full(chain.cells, preset["PdControllerGains.d"])}
    reduced = 1 / (1 / chain.outer_mass + 1 / chain.inner_mass)
    return {"gain": preset["d"] * reduced / lane.time_step}


JOINT = Reproducer("reproducer_joint.py.jinja", joint_numbers)
