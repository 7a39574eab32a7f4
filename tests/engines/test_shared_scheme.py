"""Engines whose tuned presets take the scheme's own step: equal to it to round-off, in joint and in contact."""

import os
import subprocess
import sys
from pathlib import Path

import pytest

from engines.interface.engine import Engine
from engines.interface.registry import engine
from engines.interface.tolerances import CREEP
from reference_lcp.chain.simulation import Lane
from reference_lcp.chain.trajectory import State, Trajectory
from tests.engines.scheme_oracle import (
    AMPLITUDE,
    ROUND_OFF,
    STEPS,
    assert_equals_scheme,
    lane_of,
    random_state,
    uneven_lane,
)

SHARING = ("mujoco", "pybullet", "dart", "pinocchio", "pymunk")


def pytest_generate_tests(metafunc: pytest.Metafunc) -> None:
    """Every engine, and where a test asks for a formulation, each that the engine has."""
    engines = {one.name: one for one in map(engine, SHARING)}
    marks = {name: pytest.mark.needs(name) for name in SHARING}
    if "formulation" in metafunc.fixturenames:
        pairs = [(name, str(formulation)) for name in SHARING for formulation in engines[name].capabilities.presets]
        parameters = [pytest.param(engines[one], of, id=f"{one}-{of}", marks=marks[one]) for one, of in pairs]
        metafunc.parametrize(("tested", "formulation"), parameters)
    else:
        metafunc.parametrize("tested", [pytest.param(engines[one], id=one, marks=marks[one]) for one in SHARING])


def round_off(tested: Engine, formulation: str = "joint") -> float:
    """Where a stuck contact keeps part of what it would gain in a step, motions differ by some of that part."""
    return ROUND_OFF + CREEP * tested.preset(formulation, "tuned").residual_slip_compliance


def assert_shares_scheme(
    tested: Engine, lane: Lane, state: State, trajectory: Trajectory, formulation: str = "joint",
    scale: float = AMPLITUDE,
) -> None:  # fmt: skip
    assert_equals_scheme(lane, state, trajectory, scale, round_off(tested, formulation))


def run(tested: Engine, lane: Lane, state: State, steps: int, formulation: str = "joint") -> Trajectory:
    simulation = tested.build([lane], formulation)
    trajectory = simulation.run(state, 0, steps)[0]
    simulation.close()
    return trajectory


@pytest.mark.parametrize("friction_ratio", [0.0, 0.1, 0.3, 0.6, 1.0, 5.0])
def test_motion_equals_the_scheme_from_frictionless_to_locked(
    tested: Engine, friction_ratio: float, formulation: str
) -> None:
    """Motors left on, a bound times the wrong step, a damping of the engine's own: each would show here."""
    lane = lane_of(friction_ratio)
    state = random_state(size=0.3)
    assert_shares_scheme(tested, lane, state, run(tested, lane, state, STEPS, formulation), formulation)


def test_uneven_cells_and_inner_dashpots_equal_the_scheme(tested: Engine, formulation: str) -> None:
    lane = uneven_lane()
    motion = run(tested, lane, random_state(), 2 * STEPS, formulation)
    assert_shares_scheme(tested, lane, random_state(), motion, formulation)


def test_lanes_of_one_batch_keep_their_own_chain_drive_and_time_step(tested: Engine) -> None:
    lanes = [lane_of(0.0, 0.3), uneven_lane(), lane_of(1.0, 1.3)]
    states = random_state(3)
    simulation = tested.build(lanes)
    for index, trajectory in enumerate(simulation.run(states, 0, STEPS)):
        assert_shares_scheme(tested, lanes[index], states.subset([index]), trajectory)


def test_it_is_silent_writes_nothing_and_survives_divergence(tested: Engine, tmp_path: Path) -> None:
    """Standard output and error are read as file descriptors: compiled code does not write to sys.stderr."""
    program = (
        f"import sys, numpy as np; from engines import engine; tested = engine({tested.name!r})\n"
        f"assert {tested.capabilities.package!r} not in sys.modules\n"
        "from reference_lcp.chain.mass_in_mass import Chain; from reference_lcp.chain.drives import HarmonicBase\n"
        "from reference_lcp.chain.simulation import Lane; from reference_lcp.chain.trajectory import State\n"
        "chain = Chain.from_ratios(friction_ratio=0.1)\n"
        "unstable = Lane.periodic(chain, HarmonicBase.from_ratio(chain, 0.1), 20)\n"
        "end = tested.build([unstable]).advance(State.at_rest(1, 7), 0, 400)\n"
        "assert np.max(np.abs(end.positions)) > 1e6 * 0.01\n"
    )
    path = os.pathsep.join(filter(None, [str(Path(__file__).parents[2]), os.environ.get("PYTHONPATH")]))
    done = subprocess.run(
        [sys.executable, "-B", "-c", program],
        cwd=tmp_path,
        env={**os.environ, "PYTHONPATH": path},
        capture_output=True,
        text=True,
        check=False,
    )
    assert (done.returncode, done.stdout, done.stderr) == (0, "", "")
    assert list(tmp_path.iterdir()) == []
