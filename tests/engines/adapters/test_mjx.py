"""MJX in its environment: what only its batches, its solver and its compiler do."""

import dataclasses
import os
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

from engines.interface.engine import EngineNotInstalled
from engines.interface.presets import Formulation
from engines.interface.registry import engine
from engines.interface.scene import ArmScene, SceneSetting
from engines.interface.tolerances import CREEP
from engines.isolated.versioned_engine import EnvironmentEngine, Requirement
from engines.mjx import MJX
from engines.mjx.worlds import SIZES
from engines.shared.worlds import CHUNK
from reference_lcp.chain.preload import Preload
from reference_lcp.chain.simulation import Lane
from reference_lcp.chain.trajectory import State
from reference_lcp.errors import ParameterError
from tests.engines.adapters.mjx_probes import ProbedMJX
from tests.engines.scheme_oracle import (
    AMPLITUDE,
    STEPS,
    built_with,
    lane_of,
    random_state,
    scheme,
    uneven_lane,
    unstable_lane,
)

OWN, PROBED = (EnvironmentEngine(Requirement(adapter())) for adapter in (MJX, ProbedMJX))

in_its_environment = pytest.mark.needs("mjx")

SOFTNESS = MJX().preset("joint", "tuned").residual_slip_compliance

BATCH_ROUND_OFF = 1e-12
"""Over the largest value: what the order of sums, another one in a batch of another size, makes of a period."""


CONTACT_ROUND_OFF = 1e-5
"""Over the bound of friction: what friction adds to the normal force at μ = 0.01."""

ENDING_SECONDS = 120.0
"""Within which a process has run some hundred steps, compiled, and its threads have gone."""


def lanes_of_all_kinds() -> list[Lane]:
    """Lanes that differ in time step, frequency, friction, units and bounds; one has no friction."""
    heavy = lane_of(0.3, 0.9, 3 * STEPS, outer_mass=20.0, chain_stiffness=3e3)
    return [lane_of(0.3, 0.6, damping_ratio=0.0), lane_of(0.1, 0.9, 2 * STEPS), lane_of(0.0, 1.3), heavy, uneven_lane()]


@in_its_environment
def test_worlds_of_other_time_steps_and_chains_move_by_the_scheme_and_as_each_alone() -> None:
    """Five lanes fill a batch of eight; more steps than are recorded at once."""
    lanes, states = lanes_of_all_kinds(), random_state(5)
    together = OWN.build(lanes).run(states, 0, 200)
    for index, lane in enumerate(lanes):
        state = states.subset([index])
        expected = scheme(lane, state, 200)[0]
        assert np.max(np.abs(together[index].positions - expected)) <= CREEP * SOFTNESS * AMPLITUDE
        alone = OWN.build([lane]).run(state, 0, 200)[0]
        for name in ("positions", "velocities", "friction"):
            values = getattr(alone, name)
            np.testing.assert_allclose(
                getattr(together[index], name), values, rtol=0, atol=BATCH_ROUND_OFF * np.max(np.abs(values))
            )


@in_its_environment
def test_friction_of_a_small_bound_is_not_taken_for_none() -> None:
    """MJX's norm of a vector is zero where no entry exceeds 1e-8: in the lane's own units this bound is 1e-11."""
    lane = lane_of(1e-7, 0.9)
    motion = OWN.build([lane]).run(random_state(1), 0, STEPS)[0]
    np.testing.assert_allclose(np.max(np.abs(motion.friction), axis=0), lane.chain.friction_bound, rtol=1e-3)


@in_its_environment
def test_a_stuck_joint_keeps_a_ten_thousandth_of_the_velocity_that_it_would_gain() -> None:
    """MuJoCo's hardest friction is as soft as that, and no softer."""
    lane = lane_of(5.0, 0.3)
    motion = OWN.build([lane]).run(State.at_rest(1, 7), 0, STEPS)[0]
    gained = np.abs(motion.friction) * lane.time_step * (1 / lane.chain.outer_mass + 1 / lane.chain.inner_mass)
    creep = np.max(np.abs(motion.relative_velocity)) / np.max(gained)
    assert creep == pytest.approx(SOFTNESS, rel=0.01)


def test_a_sweep_without_softness_is_refused_since_mjx_would_ignore_it() -> None:
    with pytest.raises(ParameterError, match="noslip_iterations = 1; allowed: 0"):
        built_with(MJX(), lane_of(), noslip_iterations=1)


@in_its_environment
def test_mjx_takes_a_sweep_without_softness_and_does_none() -> None:
    """As long as this holds, such an option is refused."""
    plain, swept = PROBED.build([lane_of()])._call(10, "without_and_with_sweeps", 5)
    for without, after in zip(plain, swept, strict=True):
        assert np.array_equal(without, after)
    assert np.max(np.abs(plain.velocities)) > 0


def test_it_is_not_used_beside_the_suite_whatever_is_there() -> None:
    """JAX has threads: no process of the suite could be forked after them."""
    with pytest.raises(EngineNotInstalled, match=r"an environment of its own; multibody-xval engines install mjx$"):
        MJX().build([lane_of()])


@in_its_environment
def test_a_joint_without_friction_slides_although_others_have_some() -> None:
    """MJX welds a joint whose bound is zero among those that have one."""
    lane, state = uneven_lane(), random_state()
    motion = OWN.build([lane]).run(state, 0, 50)[0]
    free = lane.chain.friction_bound == 0
    assert np.all(motion.friction[:, free] == 0)
    assert np.max(np.abs(motion.relative_velocity[:, free])) > AMPLITUDE


@in_its_environment
def test_a_world_whose_bounds_change_in_time_leaves_those_of_the_others_alone() -> None:
    constant, state = uneven_lane(), random_state(2)
    preload = Preload(modulation=0.5, angular_frequency=2 * lane_of().drive.angular_frequency)
    modulated = dataclasses.replace(lane_of(), preload=preload)
    together = OWN.build([modulated, constant]).run(state, 3, 200)
    alone = OWN.build([constant]).run(state.subset([1]), 3, 200)[0]
    np.testing.assert_allclose(together[1].positions, alone.positions, rtol=0, atol=BATCH_ROUND_OFF * AMPLITUDE)
    bound = lane_of().chain.friction_coefficient * modulated.preloads(3, 200)
    assert np.max(np.abs(together[0].friction) / bound) == pytest.approx(1, abs=1e-9)


@in_its_environment
def test_ten_iterations_of_its_solver_do_not_always_find_which_joints_stick() -> None:
    """And MJX does not say so; the preset's hundred do."""
    lane, state = lane_of(0.3, 0.9), State.at_rest(1, 7)
    expected = scheme(lane, state, 10 * STEPS)[2]
    off = [
        np.max(np.abs(PROBED.build([lane], "joint", preset).run(state, 0, 10 * STEPS)[0].friction - expected))
        for preset in ("ten iterations", "tuned")
    ]
    assert off[0] > 0.1 * lane.chain.friction_bound[0]
    assert off[1] < CREEP * SOFTNESS * lane.chain.friction_bound[0]


@pytest.mark.slow
@in_its_environment
def test_the_line_search_of_its_contacts_gives_up() -> None:
    """Where MuJoCo's does not, of the same steps; as long as this holds, there are no contacts."""
    by_mujoco, by_mjx = PROBED.build([lane_of(0.3, 0.9)])._call(STEPS, "friction_of_contacts", 1e8, STEPS)
    assert np.max(np.abs(by_mujoco)) <= 1 + CONTACT_ROUND_OFF
    off = np.abs(by_mjx - by_mujoco)
    print(f"{np.count_nonzero(off > 1)} of {off.size} off by more than their bound, by up to {np.max(off):.1f} of it")
    assert np.count_nonzero(off > 1) > 100
    assert np.max(off) > 100


@in_its_environment
def test_lanes_of_other_numbers_are_not_compiled_anew() -> None:
    """Nor are more steps than are recorded at once, or other lanes that fill the same batch: to build them compiles."""
    simulation = PROBED.build([lane_of()] * 3)
    before = simulation._call(1, "compiled")
    simulation.advance(random_state(3), 0, CHUNK + 10)
    other = PROBED.build(lanes_of_all_kinds())
    other.advance(random_state(5), 5, 33)
    assert other._call(1, "compiled") == before > 0


@pytest.mark.slow
@in_its_environment
def test_batches_of_every_size_are_compiled_by_what_prepares_it() -> None:
    lane = lane_of(cells=1)
    PROBED.prepare(1, "joint", "tuned")
    before = PROBED.build([lane])._call(1, "compiled")
    for lanes in (size - 1 for size in SIZES[1:]):
        assert PROBED.build([lane] * lanes)._call(1, "compiled") == before


@in_its_environment
def test_a_diverged_world_stays_finite_and_leaves_the_others_and_later_runs_alone() -> None:
    simulation = OWN.build([unstable_lane(), lane_of()])
    before = simulation.run(random_state(2), 0, 30)
    diverged, calm = simulation.run(random_state(2), 0, 400)
    assert np.max(np.abs(diverged.positions)) > 1e6 * AMPLITUDE
    assert np.all(np.isfinite(diverged.positions))
    expected = scheme(lane_of(), random_state(2).subset([1]), 400)[0]
    assert np.max(np.abs(calm.positions - expected)) <= CREEP * SOFTNESS * AMPLITUDE
    for first, second in zip(before, simulation.run(random_state(2), 0, 30), strict=True):
        assert np.array_equal(first.positions, second.positions)


@in_its_environment
def test_it_is_silent_and_writes_nothing_where_it_runs_and_leaves_no_thread(tmp_path: Path) -> None:
    program = (
        "import os; from engines.interface.registry import engine\n"
        "from tests.engines.scheme_oracle import unstable_lane; from reference_lcp.chain.trajectory import State\n"
        "before = os.listdir('/proc/self/task')\n"
        "for preset in ('tuned', 'default'):\n"
        "    engine('mjx').build([unstable_lane()], 'joint', preset).advance(State.at_rest(1, 7), 0, 400)\n"
        "while os.listdir('/proc/self/task') != before: pass\n"
    )
    path = os.pathsep.join(filter(None, [str(Path(__file__).parents[3]), os.environ.get("PYTHONPATH")]))
    done = subprocess.run(
        [sys.executable, "-B", "-W", "error", "-c", program], cwd=tmp_path, env={**os.environ, "PYTHONPATH": path},
        capture_output=True, text=True, check=False, timeout=ENDING_SECONDS,
    )  # fmt: skip
    assert (done.returncode, done.stdout, done.stderr) == (0, "", "")
    assert list(tmp_path.iterdir()) == []


@in_its_environment
def test_what_it_prints_where_warp_is_missing_would_not_be_quoted_if_it_crashed() -> None:
    """MJX says so on standard output where it is imported: in a process that has just begun."""
    simulation = OWN.build([lane_of()])
    simulation._process.close()
    simulation._built._ensure_built()
    errors = simulation._process._worker._errors
    errors.seek(0)
    assert errors.read() == b""


@in_its_environment
@pytest.mark.parametrize(("preset", "least", "most"), [("default", 0.1, 2.0), ("recommended", 1e-6, 1e-2)])
def test_an_arm_in_mjx_sags_as_in_mujoco(preset: str, least: float, most: float) -> None:
    """The same model by another solver, which ends within 1e-8 of its own units."""
    scene, rows = ArmScene(friction=(4.3, 1.1)), []
    for name in ("mujoco", "mjx"):
        own = engine(name)
        world = own.scene_world(scene, SceneSetting(own.preset("joint", preset), own.scene_step))
        rows.append(world.run(250))
        world.close()
    assert rows[1] == pytest.approx(rows[0], rel=1e-3, abs=1e-8)
    assert least < abs(rows[1][-1]).max() < most


def test_contacts_in_mjx_have_no_scenes_and_the_reason_is_said() -> None:
    assert "its line search fails" in str(OWN.scene_gap(Formulation.CONTACT))
    assert OWN.scene_gap(Formulation.JOINT) is None
