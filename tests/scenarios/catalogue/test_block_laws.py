"""Laws of free contacts: whole motions of blocks, engine beside model, from the same state."""

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from multibody_xval.engines.contract.lanes import modulated_lane
from multibody_xval.engines.interface.law import Law
from multibody_xval.engines.interface.registry import law_of
from multibody_xval.engines.interface.variant import Variant
from multibody_xval.scenarios.catalogue import motion
from multibody_xval.scenarios.catalogue.block.breakaway import Breakaway
from multibody_xval.scenarios.catalogue.block.direction import Direction
from multibody_xval.scenarios.catalogue.block.static_hold import StaticHold
from multibody_xval.scenarios.catalogue.block.stopping_distance import StoppingDistance
from multibody_xval.scenarios.runs.store import opened_store
from multibody_xval.scenarios.runs.task import Recorded, SteadyStateTask, law_identity
from multibody_xval.scenarios.runs.transient_task import BlockTask, TransientTask
from multibody_xval.scenarios.verdicts.finding import Prediction
from reference_lcp.chain.trajectory import Trajectory
from tests.scenarios.in_process import evaluator

FREE = Variant("mujoco", "contact", "default")

ROUND_OFF = 1e-12
"""Largest difference of positions, over the displacement scale, where MuJoCo's Newton ends by itself."""

STOPPED_SHORT = 1e-6
"""The same where it stops at its tolerance of 1e-8 in some steps: a few of 5e-4 m/s² last 2 ms each."""

BLOCKS = {str(case): case for own in (StaticHold, Breakaway, StoppingDistance, Direction) for case in own.cases}
HELD = BLOCKS["1 kg, load 0.5"]

needs_mujoco = pytest.mark.needs("mujoco")


def moved(variant: Variant, task: TransientTask, steps: int) -> Trajectory:
    return variant.build([task.lane()]).run(task.initial_state(), 0, steps)[0]


def distance(task: TransientTask, steps: int, law: Law | None = None) -> float:
    """Largest difference of positions between MuJoCo and the law, over the displacement scale."""
    own, lane = moved(task.variant, task, steps), task.lane()
    stated = law or law_of(task.variant.preset)
    assert stated is not None
    predicted = stated.build([lane]).run(task.initial_state(), 0, steps)[0]
    return float(np.max(np.abs(own.positions - predicted.positions))) / lane.drive.displacement_scale(lane.chain)


@needs_mujoco
@pytest.mark.parametrize(
    "task",
    [
        BLOCKS["1 g, 4 ms"].task(FREE),
        BLOCKS["1 kg, 2 ms"].task(FREE),
        BLOCKS["1 kg, 4.9 m/s"].task(FREE),
        BLOCKS["1 t under 10 t, 12.3 m/s"].task(FREE),
        *(BLOCKS[f"1 kg, 4.9 m/s, {angle}°"].task(FREE) for angle in (0, 15, 45, 90)),
    ],
    ids=lambda task: f"{task.block.mass:g} kg, {task.slip_velocity:.3g} m/s, {np.degrees(task.direction):.0f} deg",
)
def test_free_block_breaks_away_and_stops_as_its_four_edges_say_to_round_off(task: BlockTask) -> None:
    assert distance(task, task.steps) <= ROUND_OFF


@needs_mujoco
@pytest.mark.parametrize("hold", [hold for hold in StaticHold.cases if hold.scale.title == "1 kg"], ids=str)
def test_free_block_creeps_as_its_four_edges_say(hold) -> None:
    task = hold.task(FREE)
    assert distance(task, task.steps // 5) <= STOPPED_SHORT


@needs_mujoco
@pytest.mark.parametrize("symbol", ["τ", "d_0", "d_max", "δ"])
def test_a_constant_that_is_a_hundredth_off_breaks_away_elsewhere(symbol) -> None:
    law = law_of(FREE.preset)
    assert law is not None
    constant = law.constants[symbol]
    wrong = replace(law, constants={**law.constants, symbol: replace(constant, value=1.01 * constant.value)})
    task = BLOCKS["1 kg, 2 ms"].task(FREE)
    assert distance(task, task.steps, wrong) > 100 * ROUND_OFF


@needs_mujoco
def test_a_sphere_held_at_its_depth_in_a_turned_row_slides_by_all_four_edges() -> None:
    """As MuJoCo Warp has it, whose spheres are never free."""
    task = BLOCKS["1 kg, 4.9 m/s, 30°"].task(FREE)
    held = replace(task.lane(), preload=None)
    own, predicted = (variant.build([held]).run(task.initial_state(), 0, 50)[0] for variant in (FREE, law_variant()))
    scale = held.drive.displacement_scale(held.chain)
    assert np.max(np.abs(own.positions - predicted.positions)) <= ROUND_OFF * scale
    straight = replace(held, direction=0.0)
    along = law_variant().build([straight]).run(task.initial_state(), 0, 50)[0]
    assert np.max(np.abs(own.positions - along.positions)) > 1e6 * ROUND_OFF * scale


def law_variant() -> Variant:
    law = FREE.law
    assert law is not None
    return law


def test_a_block_at_rest_sinks_to_where_four_edges_carry_a_quarter_of_its_load_each() -> None:
    """k d z = R λ_N / 4 in closed form, whatever presses."""
    task = replace(HELD.task(law_variant()), slip=0.0)
    run = moved(law_variant(), task, 1000)
    assert run.normal_gap is not None
    depth, block = -float(run.normal_gap[-1, 0]), task.block
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


@needs_mujoco
def test_a_free_block_is_not_compared_with_a_law_of_held_ones_and_the_reason_is_said(monkeypatch) -> None:
    law = law_of(FREE.preset)
    assert law is not None
    monkeypatch.setattr(motion, "law_of", lambda _: replace(law, modulated=False, lifting=False))
    tasks = [replace(HELD.task(variant), steps=100, every=50) for variant in (FREE, law_variant())]
    with opened_store(None) as store, evaluator(store) as running:
        period = motion.motion_distance(tasks[0], tasks[1], "slip", running)
    prediction = Prediction(
        value=1.0, difference=0.0, allowed=1.0, distance=period.distance, period_bound=period.bound,
        reason=period.reason,
    )  # fmt: skip
    assert not prediction.holds
    assert str(prediction).endswith(
        "its motion is not compared with the law's: it holds under a constant normal force alone, and this contact is "
        "free across the row"
    )


needs_drake = pytest.mark.needs("drake")


@needs_drake
@pytest.mark.parametrize("preset", ["tuned", "similar"])
def test_friction_under_ten_tons_is_as_soft_as_drakes_solver_has_it_and_not_as_stiction_says(preset) -> None:
    """z = σ √2 / (3 m) h μ λ_N = 46 µm/s, of which a load of a half makes 1/√3: twice what v_s alone would."""
    variant = Variant("drake", "contact", preset)
    task = BLOCKS["1 t under 10 t, load 0.5"].task(variant)
    slip = 1e6 * np.diff(moved(variant, task, 200).velocities[-1])[0]
    zone = 1e-3 * np.sqrt(2) / (3 * task.block.mass) * task.time_step * task.block.bound
    # the load is that of the first 0.4 s: the spring has hardly relaxed
    assert -slip == pytest.approx(1e6 * zone / np.sqrt(3), rel=1e-3)
    assert distance(task, 1000) <= 2e-7  # where the solver stops, at a part of 1e-6 of the momentum


@pytest.mark.needs("ode")
def test_a_box_of_ode_creeps_by_the_softness_of_its_four_points() -> None:
    """cfm / 4 times the load, to a hundredth: a box tilts by as little as its points give."""
    variant = Variant("ode", "contact", "default")
    task = HELD.task(variant)
    slip = np.diff(moved(variant, task, 1000).velocities[-1])[0]
    assert -slip == pytest.approx(1e-10 / 4 * 0.5 * task.block.bound, rel=0.02)
    assert distance(task, 1000) <= 1e-10


def test_a_motion_that_a_law_does_not_claim_is_compared_and_the_distance_decides(monkeypatch) -> None:
    """It may hold there; where it does not, the verdict says what the law itself says."""
    law = law_of(law_variant().preset)
    assert law is not None
    tasks = [replace(HELD.task(law_variant()), steps=100, every=50, slip=factor * HELD.task(FREE).slip)
             for factor in (1.0, 1.0, 0.9)]  # fmt: skip
    monkeypatch.setattr(motion, "law_of", lambda _: replace(law, unmodelled_reason=lambda _: "chance decides"))
    with opened_store(None) as store, evaluator(store) as running:
        near, far = (motion.motion_distance(tasks[0], task, "slip", running) for task in tasks[1:])
    assert (near.distance, near.reason) == (0.0, "")
    assert far.distance > far.bound
    assert far.reason == "chance decides"


def test_laws_say_which_normal_forces_they_hold_under() -> None:
    free, opening = HELD.task(FREE).lane(), modulated_lane(1.5)
    law = law_of(FREE.preset)
    assert law is not None
    assert [law.unclaimed_reason(lane) for lane in (free, opening)] == [None, None]
    closed = replace(law, lifting=False)
    assert closed.unclaimed_reason(free) is None
    assert "open" in str(closed.unclaimed_reason(opening))


def test_results_of_a_law_are_not_taken_for_those_of_another(monkeypatch) -> None:
    """A store holds results of laws by their formula and constants, those of engines without."""
    law = law_of(FREE.preset)
    assert law is not None
    period = SteadyStateTask(recorded=Recorded.LAW, variant=FREE, friction_ratio=0.3, frequency_ratio=0.9)
    by_law, by_engine = HELD.task(law_variant()), HELD.task(FREE)

    def contents() -> list[dict[str, Any]]:
        law_identity.cache_clear()
        return [task.content() for task in (by_law, period, by_engine)]

    before = contents()
    monkeypatch.setattr(
        "multibody_xval.scenarios.runs.task.law_of", lambda _: replace(law, formula=law.formula + ", otherwise")
    )
    after = contents()
    monkeypatch.undo()
    law_identity.cache_clear()
    assert [first == second for first, second in zip(before, after, strict=True)] == [False, False, True]
