"""MuJoCo's springs that yield: what they hold, what they remember, and what no dashpot takes from them."""

import dataclasses

import numpy as np
import pytest

from engines.interface.engine import EngineNotInstalled
from engines.interface.presets import Formulation
from engines.interface.registry import engine, law_of
from engines.interface.variant import Variant
from engines.mujoco import MuJoCo
from engines.mujoco.yielding import YieldingLane, yield_stiffness
from reference_lcp.chain.drives import StillBase
from reference_lcp.chain.mass_in_mass import Chain
from reference_lcp.chain.simulation import Lane, PeriodicOrbit
from reference_lcp.chain.trajectory import State, Trajectory
from reference_lcp.errors import ParameterError
from reference_lcp.observables.transmittance import decibel, transmittance
from reference_lcp.schemes.sequential import SequentialSimulation
from reference_lcp.steady.orbits import periodic_orbits
from tests.engines.scheme_oracle import AMPLITUDE, STEPS, built_with, lane_of, random_state

YIELD = MuJoCo().capabilities.presets[Formulation.JOINT]["yield"]

pytestmark = pytest.mark.skipif(
    MuJoCo().unavailable_reason_of(YIELD) is not None, reason="no mujoco with springs that yield is installed"
)

ROUND_OFF = 1e-11
"""Of what is computed in a period, over the displacement scale."""

FORCE_ROUND_OFF = 1e-8
"""Of a spring's force over its bound: it is a difference of lengths that are a thousand times as large."""


def free_cell() -> Lane:
    """One cell moved by its own spring and its friction alone, whose bound is the force of that spring at 2 U0."""
    chain = Chain(
        cells=1, outer_mass=2.0, inner_mass=1.0, chain_stiffness=1e-9, inner_stiffness=1e3, chain_damping=0.0,
        inner_damping=0.0, normal_force=4e3 * AMPLITUDE, friction_coefficient=0.5,
    )  # fmt: skip
    return Lane(chain, StillBase(AMPLITUDE), 1e-3)


def stretched(deflection: float | None) -> State:
    """Inner mass half of U0 aside and at rest; the yielding spring without a history, or deflected by so much [m]."""
    internal = None if deflection is None else np.array([[deflection]])
    return State(np.array([[0.0, AMPLITUDE / 2]]), np.zeros((1, 2)), internal)


def run_of(lane: Lane, state: State, steps: int, start: int = 0) -> Trajectory:
    return MuJoCo().build([lane], "joint", "yield").run(state, start, steps)[0]


def stiffness_of(lane: Lane) -> float:
    return float(yield_stiffness(lane.chain, lane.time_step, YIELD["spring_phase"])[0])


def reduced_mass(lane: Lane) -> float:
    return 1 / float(1 / lane.chain.outer_mass[0] + 1 / lane.chain.inner_mass[0])


def orbit_of(lane: Lane, phase: float) -> PeriodicOrbit:
    """Give the steady state of the law."""
    return periodic_orbits(SequentialSimulation([YieldingLane(lane, phase)]), STEPS)[0]


def test_a_contact_without_a_history_holds_the_load_that_it_meets() -> None:
    lane = free_cell()
    motion = run_of(lane, stretched(None), STEPS)
    held = float(lane.chain.inner_stiffness[0]) * AMPLITUDE / 2
    assert motion.relative_velocity == pytest.approx(0, abs=ROUND_OFF * AMPLITUDE)
    assert motion.friction == pytest.approx(held, rel=FORCE_ROUND_OFF)


def test_a_stuck_contact_rings_for_ever_about_what_it_holds() -> None:
    """As 1 − cos(ω n h) with 2 − 2 cos ωh = (k_s + k_i) h² / m_red: Euler's step takes nothing from it."""
    lane = free_cell()
    chain, stiffness = lane.chain, stiffness_of(lane)
    softest = float(chain.inner_stiffness[0])
    mass = reduced_mass(lane)
    angle = np.arccos(1 - (stiffness + softest) * lane.time_step**2 / mass / 2)
    amplitude = softest * AMPLITUDE / 2 / (stiffness + softest)
    motion = run_of(lane, stretched(0.0), 20 * STEPS)
    steps = np.arange(1, 20 * STEPS + 1)
    # Euler's velocities are those of half a step before their positions.
    swing = np.cos(angle * (steps + 0.5)) / np.cos(angle / 2)
    outer, inner = motion.positions.T
    moved = AMPLITUDE / 2 - (inner - outer)
    assert moved == pytest.approx(amplitude * (1 - swing), abs=1e-9 * AMPLITUDE)


def test_deflections_of_springs_are_the_memory_of_a_run() -> None:
    """A half that begins without them ends elsewhere; with them, the halves are the whole."""
    lane = lane_of(0.3, 0.6)
    whole, first = run_of(lane, random_state(), 2 * STEPS), run_of(lane, random_state(), STEPS)
    forgotten = State(first.end.positions, first.end.velocities)
    apart = [
        float(np.max(np.abs(run_of(lane, state, STEPS, STEPS).positions - whole.positions[STEPS:]))) / AMPLITUDE
        for state in (first.end, forgotten)
    ]
    assert apart[0] < ROUND_OFF
    assert apart[1] > 1e-6


def test_a_deflection_beyond_the_bound_begins_at_the_bound() -> None:
    """A search of periodic orbits mixes the states of several periods."""
    lane = free_cell()
    limit = float(lane.chain.friction_bound[0]) / stiffness_of(lane)
    beyond, at = (run_of(lane, stretched(deflection), STEPS) for deflection in (3 * limit, limit))
    assert np.array_equal(beyond.positions, at.positions)


def test_an_internal_state_of_another_engine_is_refused() -> None:
    state = State(np.zeros((1, 2)), np.zeros((1, 2)), np.zeros((1, 2)))
    with pytest.raises(ParameterError, match=r"internal state of a lane has the shape \(1, 2\); allowed: \(1, 1\)$"):
        run_of(free_cell(), state, 1)


def test_an_implicit_spring_passes_its_bound_within_a_step() -> None:
    """Why the integrator is Euler's: the discrete one adds k_s h w to a slip, which the bound does not cut off."""
    lane = lane_of(0.3, 0.6)
    law = law_of(YIELD)
    assert law is not None
    expected = law.build([lane]).run(random_state(), 0, STEPS)[0].positions
    apart = {}
    for integrator in ("Euler", "discrete"):
        motion = built_with(MuJoCo(), lane, preset="yield", integrator=integrator).run(random_state(), 0, STEPS)[0]
        apart[integrator] = float(np.max(np.abs(motion.positions - expected))) / AMPLITUDE
    assert apart["Euler"] < ROUND_OFF
    assert apart["discrete"] > 0.1


def test_a_normal_force_that_changes_is_refused() -> None:
    from engines.contract.lanes import modulated_lane

    with pytest.raises(ParameterError, match=r"mujoco:joint:yield cannot represent .* allowed: a constant one"):
        MuJoCo().build([modulated_lane(0.5)], "joint", "yield")


def test_a_version_without_springs_that_yield_is_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(MuJoCo, "version", lambda _: "3.17.0")
    refused = r"^mujoco 3\.17\.0 is installed, and this preset takes >=4$"
    reason = Variant("mujoco", preset_name="yield").unavailable_reason
    assert reason is not None
    with pytest.raises(EngineNotInstalled, match=refused.replace("^", "^mujoco: ")):
        MuJoCo().build([free_cell()], "joint", "yield")
    assert MuJoCo().build([free_cell()], "joint", "tuned") is not None
    assert MuJoCo().unavailable_reason_of(dataclasses.replace(YIELD, versions=">=3.17")) is None


def test_softer_springs_are_further_from_coulomb() -> None:
    lane = lane_of(0.6, 1.3)
    exact = decibel(transmittance(periodic_orbits(engine("reference").build([lane], preset="converged"), STEPS)[0]))
    errors = [float(decibel(transmittance(orbit_of(lane, phase))) - exact) for phase in (0.3, 0.6, 1.0)]
    assert np.abs(errors) == pytest.approx([0.231, 0.048, 0.011], abs=2e-3)


def test_a_dashpot_that_damps_swings_a_little_would_be_as_strong_as_friction() -> None:
    """By a hundredth of critical; it would not yield with the spring, and so act in every slip."""
    lane = lane_of(0.6, 1.3)
    dashpot = 2 * 0.01 * np.sqrt(stiffness_of(lane) * reduced_mass(lane))
    fastest = float(np.max(np.abs(orbit_of(lane, YIELD["spring_phase"]).trajectory.relative_velocity)))
    assert dashpot * fastest / lane.chain.friction_bound[0] == pytest.approx(0.87, abs=0.01)
