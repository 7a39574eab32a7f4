"""Step models of free contacts: whole motions of blocks, engine beside model, from the same state."""

from dataclasses import replace

import numpy as np
import pytest

from multibody_xval.engines.contract.lanes import modulated_lane
from multibody_xval.engines.interface.law import Law
from multibody_xval.engines.interface.registry import law_of
from multibody_xval.scenarios.cases.motions import BlockMotion
from multibody_xval.scenarios.catalogue.blocks.block import TIME_STEP
from multibody_xval.scenarios.catalogue.blocks.breakaway import BREAKAWAY
from multibody_xval.scenarios.catalogue.blocks.direction import DIRECTION
from multibody_xval.scenarios.catalogue.blocks.held import STATIC_HOLD
from multibody_xval.scenarios.catalogue.blocks.thrown import STOPPING_DISTANCE
from multibody_xval.scenarios.compute.motions import is_pressed
from multibody_xval.scenarios.model import Config, Run
from reference_lcp.chain.simulation import Lane
from reference_lcp.chain.trajectory import Trajectory

FREE = Config("mujoco", "contact", "default")

ROUND_OFF = 1e-12
"""Largest difference of positions, over the displacement scale, where MuJoCo's Newton ends by itself."""

STOPPED_SHORT = 1e-6
"""The same where it stops at its tolerance of 1e-8 in some steps: a few of 5e-4 m/s² last 2 ms each."""

BLOCKS = {
    name: case for own in (STATIC_HOLD, BREAKAWAY, STOPPING_DISTANCE, DIRECTION) for name, case in own.cases.items()
}
HELD = BLOCKS["1 kg, load 0.5"]

needs_mujoco = pytest.mark.needs("mujoco")


def steps_of(case: BlockMotion) -> int:
    """Steps of about 2 ms, or of the row where that is shorter."""
    return max(case.rows, round(case.time / TIME_STEP))


def lane_of(config: Config, case: BlockMotion) -> Lane:
    steps = steps_of(case)
    return case.lane(steps, pressed=is_pressed(Run(config, case, steps)))


def moved(config: Config, case: BlockMotion, steps: int) -> Trajectory:
    return config.build([lane_of(config, case)]).run(case.initial_state(), 0, steps)[0]


def distance(config: Config, case: BlockMotion, steps: int, law: Law | None = None) -> float:
    """Largest difference of positions between an engine and its model, over the displacement scale."""
    own, lane = moved(config, case, steps), lane_of(config, case)
    stated = law or law_of(config.preset)
    assert stated is not None
    predicted = stated.build([lane]).run(case.initial_state(), 0, steps)[0]
    return float(np.max(np.abs(own.positions - predicted.positions))) / case.scale


@needs_mujoco
@pytest.mark.parametrize(
    "name",
    [
        "1 g, 4 ms",
        "1 kg, 2 ms",
        "1 kg, 4.9 m/s",
        "1 t under 10 t, 12.3 m/s",
        *(f"1 kg, 4.9 m/s, {angle}°" for angle in (0, 15, 45, 90)),
    ],
)
def test_free_block_breaks_away_and_stops_as_its_four_edges_say_to_round_off(name) -> None:
    assert distance(FREE, BLOCKS[name], steps_of(BLOCKS[name])) <= ROUND_OFF


@needs_mujoco
@pytest.mark.parametrize("name", [name for name in STATIC_HOLD.cases if name.startswith("1 kg")])
def test_free_block_drifts_as_its_four_edges_say(name) -> None:
    assert distance(FREE, BLOCKS[name], 1000) <= STOPPED_SHORT


@needs_mujoco
@pytest.mark.parametrize("symbol", ["τ", "d_0", "d_max", "δ"])
def test_a_constant_that_is_a_hundredth_off_breaks_away_elsewhere(symbol) -> None:
    law = law_of(FREE.preset)
    assert law is not None
    constant = law.constants[symbol]
    wrong = replace(law, constants={**law.constants, symbol: replace(constant, value=1.01 * constant.value)})
    case = BLOCKS["1 kg, 2 ms"]
    assert distance(FREE, case, steps_of(case), wrong) > 100 * ROUND_OFF


@needs_mujoco
def test_a_sphere_held_at_its_depth_in_a_turned_row_slides_by_all_four_edges() -> None:
    """As MuJoCo Warp has it, whose spheres are never free."""
    case = BLOCKS["1 kg, 4.9 m/s, 30°"]
    held = replace(lane_of(FREE, case), preload=None)
    own, predicted = (config.build([held]).run(case.initial_state(), 0, 50)[0] for config in (FREE, law_variant()))
    scale = held.drive.displacement_scale(held.chain)
    assert np.max(np.abs(own.positions - predicted.positions)) <= ROUND_OFF * scale
    straight = replace(held, direction=0.0)
    along = law_variant().build([straight]).run(case.initial_state(), 0, 50)[0]
    assert np.max(np.abs(own.positions - along.positions)) > 1e6 * ROUND_OFF * scale


def law_variant() -> Config:
    law = FREE.law
    assert law is not None
    return law


def test_a_block_at_rest_sinks_to_where_four_edges_carry_a_quarter_of_its_load_each() -> None:
    """k d z = R λ_N / 4 in closed form, whatever presses."""
    run = moved(law_variant(), replace(HELD, slip=0.0), 1000)
    assert run.normal_gap is not None
    depth, block = -float(run.normal_gap[-1, 0]), HELD.block
    part = depth / 0.001
    d = 0.9 + 0.05 * 2 * part**2
    softness = 2 * 0.25 * (1 + 0.25) * (1 - d) / d * (1 / 20 + 3) / 3 / block.mass
    assert d * depth / (0.95 * 0.02) ** 2 == pytest.approx(softness * block.normal_force / 4, rel=1e-6)
    assert run.normal_force[-1, 0] == pytest.approx(block.normal_force, rel=1e-9)


@pytest.mark.parametrize("seed", range(20))
def test_edges_press_or_let_go_whatever_the_load(seed) -> None:
    """0 <= p ⟂ E y + o + R p >= 0 at random loads, masses and coefficients of friction."""
    from multibody_xval.engines.mujoco.step_model import COUPLING, IMPULSE, write_edge_impulses

    rng = np.random.default_rng(seed)
    slope, softness = rng.uniform(0.05, 2.0), 10 ** rng.uniform(-6, 1)
    tangents = np.array([[1.0, 0, 0], [0, 1, 0], [-1, 0, 0], [0, -1, 0]])
    edges = np.array([0.0, 0.0, 1.0]) + slope * tangents
    free, masses, offset = rng.normal(size=3), rng.uniform(0.1, 3.0, 3), rng.normal()
    work = np.empty((COUPLING + 2 * 4, 4))
    write_edge_impulses(free, masses, edges, softness, offset, work)
    impulses = work[IMPULSE]
    rows = edges @ (free + masses * (impulses @ edges)) + offset
    np.testing.assert_allclose(softness * impulses, np.maximum(-rows, 0.0), rtol=1e-9, atol=1e-13)


def test_a_free_block_is_not_compared_with_a_model_of_held_ones_and_the_reason_is_said() -> None:
    law = law_of(FREE.preset)
    assert law is not None
    reason = replace(law, modulated=False, lifting=False).other_contact_reason(lane_of(FREE, HELD))
    assert str(reason).endswith("it holds under a constant normal force alone, and this contact is free across the row")


needs_drake = pytest.mark.needs("drake")


@needs_drake
@pytest.mark.parametrize("preset", ["tuned", "similar"])
def test_friction_under_ten_tons_is_as_soft_as_drakes_solver_has_it_and_not_as_stiction_says(preset) -> None:
    """z = σ √2 / (3 m) h μ λ_N = 46 µm/s, of which a load of a half makes 1/√3: twice what v_s alone would."""
    config, case = Config("drake", "contact", preset), BLOCKS["1 t under 10 t, load 0.5"]
    slip = 1e6 * np.diff(moved(config, case, 200).velocities[-1])[0]
    zone = 1e-3 * np.sqrt(2) / (3 * case.block.mass) * TIME_STEP * case.block.bound
    # the load is that of the first 0.4 s: the spring has hardly relaxed
    assert -slip == pytest.approx(1e6 * zone / np.sqrt(3), rel=1e-3)
    assert distance(config, case, 1000) <= 2e-7  # where the solver stops, at a part of 1e-6 of the momentum


@pytest.mark.needs("ode")
def test_a_box_of_ode_drifts_by_the_softness_of_its_four_points() -> None:
    """cfm / 4 times the load, to a hundredth: a box tilts by as little as its points give."""
    config = Config("ode", "contact", "default")
    slip = np.diff(moved(config, HELD, 1000).velocities[-1])[0]
    assert -slip == pytest.approx(1e-10 / 4 * 0.5 * HELD.block.bound, rel=0.02)
    assert distance(config, HELD, 1000) <= 1e-10


def test_step_models_say_which_normal_forces_they_hold_under() -> None:
    free, opening = lane_of(FREE, HELD), modulated_lane(1.5)
    law = law_of(FREE.preset)
    assert law is not None
    assert [law.unclaimed_reason(lane) for lane in (free, opening)] == [None, None]
    closed = replace(law, lifting=False)
    assert closed.unclaimed_reason(free) is None
    assert "open" in str(closed.unclaimed_reason(opening))
