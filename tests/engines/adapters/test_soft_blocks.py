"""Blocks that friction holds softly: how fast they drift, in closed form."""

import numpy as np
import pytest

from multibody_xval.scenarios.cases.motions import BlockMotion
from multibody_xval.scenarios.catalogue.blocks.block import TIME_STEP
from multibody_xval.scenarios.catalogue.blocks.held import STATIC_HOLD
from multibody_xval.scenarios.compute.motions import is_pressed
from multibody_xval.scenarios.model import Config, Run


def held_block(name: str) -> BlockMotion:
    case = STATIC_HOLD.cases[name]
    assert isinstance(case, BlockMotion)
    return case


def slip_after(config: Config, case: BlockMotion, steps: int) -> float:
    """Slip velocity [m/s] after so many steps."""
    whole = max(case.rows, round(case.time / TIME_STEP))
    lane = case.lane(whole, pressed=is_pressed(Run(config, case, whole)))
    velocities = config.build([lane]).run(case.initial_state(), 0, steps)[0].velocities
    return float(np.diff(velocities[-1])[0])


@pytest.mark.needs("drake")
@pytest.mark.parametrize("preset", ["tuned", "similar"])
def test_friction_under_ten_tons_is_as_soft_as_drakes_solver_has_it_and_not_as_stiction_says(preset) -> None:
    """z = σ √2 / (3 m) h μ λ_N = 46 µm/s, of which a load of a half makes 1/√3: twice what v_s alone would."""
    case = held_block("1 t under 10 t, load 0.5")
    zone = 1e-3 * np.sqrt(2) / (3 * case.block.mass) * TIME_STEP * case.block.bound
    # the load is that of the first 0.4 s: the spring has hardly relaxed
    assert -slip_after(Config("drake", "contact", preset), case, 200) == pytest.approx(zone / np.sqrt(3), rel=1e-3)


@pytest.mark.needs("ode")
def test_a_box_of_ode_drifts_by_the_softness_of_its_four_points() -> None:
    """cfm / 4 times the load, to a hundredth: a box tilts by as little as its points give."""
    case = held_block("1 kg, load 0.5")
    slip = slip_after(Config("ode", "contact", "default"), case, 1000)
    assert -slip == pytest.approx(1e-10 / 4 * 0.5 * case.block.bound, rel=0.02)
