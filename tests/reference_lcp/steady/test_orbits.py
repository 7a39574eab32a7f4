"""Steady states: the linear limits, the certificate, and what happens where there is none."""

import dataclasses
import math

import numpy as np
import pytest

from reference_lcp import (
    Chain,
    CompiledSimulation,
    HarmonicBase,
    HarmonicForce,
    Lane,
    ParameterError,
    State,
    StillBase,
    decibel,
    frictionless_transmittance,
    periodic_orbits,
    simulate,
    steady_state,
    stuck_transmittance,
    transmittance,
)
from reference_lcp.chain.linear_response import stuck_response
from reference_lcp.chain.simulation import OrbitStatus, steps_per_period_for
from reference_lcp.defaults import DEFAULT_PERIODS
from reference_lcp.steady.anderson import LARGEST_RISE, FixedPointSearch, StateScales
from tests.reference_lcp.cases import EXACT_DB, driven


def orbit_of(chain, frequency_ratio, steps=400, **options):
    drive = HarmonicBase.from_ratio(chain, frequency_ratio)
    return periodic_orbits(CompiledSimulation([Lane.periodic(chain, drive, steps)]), steps, **options)[0]


@pytest.mark.parametrize("place", EXACT_DB)
def test_transmittance_at_400_steps_is_within_two_hundredths_of_a_decibel_of_the_exact_value(place) -> None:
    chain = Chain.from_ratios(friction_ratio=place[0])
    steady = steady_state(chain, HarmonicBase.from_ratio(chain, place[1]))
    assert steady.orbit.residual <= 1e-8
    assert steady.transmittance_db == pytest.approx(EXACT_DB[place], abs=0.02)


@pytest.mark.parametrize(("stalled", "again"), [(-1, False), (0, True), (1, True)])
def test_a_search_that_has_not_come_nearer_for_as_long_as_it_waits_goes_back_to_its_best_state(stalled, again) -> None:
    chain, drive = driven(0.6, cells=2, friction_ratio=0.3)
    simulation = CompiledSimulation([Lane.periodic(chain, drive, 400)])
    search = FixedPointSearch(simulation, StateScales(simulation.lanes, 400), 400, 1e-8)
    search._stalled[:] = search._patience + stalled
    search._last_residual[:] = search.best_residual[:] = 1.0
    search.best[:] = 7.0
    search._following(0)
    assert np.all(search._x[:, 0] == (7.0 if again else 0.0))
    assert search._stalled.tolist() == [0 if again else search._patience + stalled]


@pytest.mark.parametrize(("periods", "again"), [(-1, False), (0, True)])
def test_a_residual_that_rises_far_is_left_once_the_plain_periods_are_over(periods, again) -> None:
    chain, drive = driven(0.6, cells=2, friction_ratio=0.3)
    simulation = CompiledSimulation([Lane.periodic(chain, drive, 400)])
    search = FixedPointSearch(simulation, StateScales(simulation.lanes, 400), 400, 1e-8)
    search.best_residual[:], search._last_residual[:] = 1.0, 1.01 * LARGEST_RISE
    search._age[:] = search._plain + periods
    search.best[:] = 7.0
    search._following(0)
    assert np.all(search._x[:, 0] == (7.0 if again else 0.0))


def test_lemke_finds_the_same_steady_state_as_the_closed_form() -> None:
    chain, drive = driven(0.6, cells=2, friction_ratio=0.3)
    answers = [steady_state(chain, drive, solver=solver) for solver in ("lemke", "compiled")]
    assert answers[0].transmittance_db == pytest.approx(answers[1].transmittance_db, abs=1e-9)
    assert answers[0].orbit.converged


@pytest.mark.parametrize("ratio", [0.3, 0.62, 0.9, 1.5])
def test_frictionless_limit_converges_to_the_linear_response_at_first_order(ratio) -> None:
    chain = Chain.from_ratios()
    exact = decibel(frictionless_transmittance(chain, HarmonicBase.from_ratio(chain, ratio)))
    errors = [abs(decibel(transmittance(orbit_of(chain, ratio, steps))) - exact) for steps in (3200, 6400, 12800)]
    assert errors[-1] < 0.01
    assert errors[0] / errors[1] == pytest.approx(2.0, abs=0.15)
    assert errors[1] / errors[2] == pytest.approx(2.0, abs=0.15)


@pytest.mark.parametrize("ratio", [0.3, 0.9, 1.1, 1.6])
def test_stuck_limit_is_the_chain_of_locked_masses(ratio) -> None:
    """A friction ratio of 100 never slips; the cells are single masses m_o + m_i."""
    chain, drive = driven(ratio, friction_ratio=100.0)
    steady = steady_state(chain, drive, steps_per_period=6400)
    assert np.all(steady.stuck_fraction == 1.0)
    assert steady.transitions == []
    assert steady.transmittance_db == pytest.approx(decibel(stuck_transmittance(chain, drive)), abs=0.01)
    outer, inner = np.split(stuck_response(chain, drive), 2)
    assert np.array_equal(outer, inner)


def test_residual_certifies_the_orbit_over_one_plain_period() -> None:
    orbit = orbit_of(Chain.from_ratios(friction_ratio=0.3), 0.9)
    again = CompiledSimulation([orbit.lane]).run(orbit.trajectory.end, 0, 400)[0]
    scale = orbit.lane.drive.amplitude
    position = np.max(np.abs(again.positions[-1] - orbit.trajectory.positions[-1])) / scale
    assert position <= 10 * orbit.residual
    assert orbit.residual <= 1e-8


def test_plain_simulation_approaches_the_same_orbit() -> None:
    """The fixed point is the attractor: a well damped chain gets there by itself."""
    chain = Chain.from_ratios(cells=2, damping_ratio=0.3, inner_damping_ratio=0.2, friction_ratio=0.1)
    orbit = orbit_of(chain, 0.9)
    drive = orbit.lane.drive
    run = simulate(chain, drive, time_step=orbit.lane.time_step, steps=400 * 120)
    assert np.max(np.abs(run.positions[-400:] - orbit.trajectory.positions)) < 1e-7 * drive.amplitude


def test_undamped_chain_has_its_steady_state_found_too() -> None:
    orbit = orbit_of(Chain.from_ratios(damping_ratio=0.0, friction_ratio=0.3), 0.9)
    assert orbit.converged
    assert orbit.periods < 100


def test_search_that_runs_out_of_periods_says_so_and_gives_its_best() -> None:
    orbit = orbit_of(Chain.from_ratios(friction_ratio=0.3), 0.9, max_periods=5)
    assert orbit.status is OrbitStatus.PERIOD_LIMIT
    assert 1e-8 < orbit.residual < 10


class Restless(CompiledSimulation):
    """The chain, with a kick at the end of each run that changes its sign from one to the next: nothing repeats."""

    kick = 1e-3

    def advance(self, state, start, steps):
        end = super().advance(state, start, steps)
        self.kick = -self.kick
        return dataclasses.replace(end, positions=end.positions + self.kick * self.lanes[0].drive.amplitude)


def test_search_whose_residual_is_not_halved_for_long_is_given_up() -> None:
    chain = Chain.from_ratios(friction_ratio=0.3)
    simulation = Restless([Lane.periodic(chain, HarmonicBase.from_ratio(chain, 0.9), 400)])
    (orbit,) = periodic_orbits(simulation, 400, longest_multiple=1)
    assert orbit.status is OrbitStatus.PERIOD_LIMIT
    assert orbit.periods < 250 < DEFAULT_PERIODS


def test_unstable_time_step_is_reported_as_divergence_and_leaves_other_lanes_alone() -> None:
    chain = Chain.from_ratios()
    fast = HarmonicBase(0.01, 2 * np.pi * chain.highest_natural_frequency / (2.2 * 400) * 10)
    bad = Lane.periodic(Chain.from_ratios(chain_stiffness=1e8), fast, 400)
    good = Lane.periodic(Chain.from_ratios(friction_ratio=5.0), fast, 400)
    orbits = periodic_orbits(CompiledSimulation([bad, good]), 400)
    assert orbits[0].status is OrbitStatus.DIVERGED
    assert orbits[1].converged


def test_search_from_another_state_finds_the_same_transmittance() -> None:
    chain = Chain.from_ratios(friction_ratio=0.6)
    rng = np.random.default_rng(2)
    start = State(rng.normal(0, 0.02, (1, 14)), rng.normal(0, 0.5, (1, 14)))
    there, here = orbit_of(chain, 0.9, start=start), orbit_of(chain, 0.9)
    assert transmittance(there) == pytest.approx(transmittance(here), rel=1e-6)


def test_time_step_follows_the_highest_natural_frequency() -> None:
    chain = Chain.from_ratios()
    slow = HarmonicBase.from_ratio(chain, 0.02)
    steps = steps_per_period_for(chain, slow)
    assert slow.period / steps * chain.highest_natural_frequency <= 0.4
    assert steps_per_period_for(chain, HarmonicBase.from_ratio(chain, 1.0)) == 400


def test_rms_equals_the_fundamental_where_the_motion_is_harmonic() -> None:
    orbit = orbit_of(Chain.from_ratios(), 0.9)
    rms = np.sqrt(np.mean(orbit.trajectory.outer_positions[:, -1] ** 2))
    assert np.sqrt(2) * rms / orbit.lane.drive.amplitude == pytest.approx(transmittance(orbit), rel=1e-6)


def test_force_drive_is_measured_over_its_static_elongation() -> None:
    chain = Chain.from_ratios(friction_ratio=0.3)
    omega = 0.5 * chain.resonator_frequency
    weak, strong = (steady_state(Chain.from_ratios(), HarmonicForce(p, omega)).transmittance_db for p in (1.0, 10.0))
    assert weak == pytest.approx(strong, abs=1e-6)


def test_drive_without_a_period_and_step_that_does_not_divide_it_are_refused() -> None:
    chain = Chain.from_ratios()
    with pytest.raises(ParameterError, match="StillBase has no period"):
        periodic_orbits(CompiledSimulation([Lane(chain, StillBase(), 1e-3)]), 400)
    lane = Lane.periodic(chain, HarmonicBase.from_ratio(chain, 0.9), 400)
    with pytest.raises(ParameterError, match="400 steps a period; allowed: 300"):
        periodic_orbits(CompiledSimulation([lane]), 300)


def undamped(**ratios) -> Chain:
    return Chain.from_ratios(damping_ratio=0.0, **ratios)


@pytest.mark.parametrize("solver", ["compiled", "exact"])
def test_without_dashpots_a_steady_state_that_does_not_attract_is_not_converged(solver) -> None:
    """Free oscillations last for ever where nothing slips: the steady state is one of many motions."""
    chain = undamped(cells=3, friction_ratio=50.0)
    state = steady_state(chain, HarmonicBase.from_ratio(chain, 0.9), solver=solver, with_error_bar=False)
    assert state.orbit.residual < 1e-8
    assert state.orbit.status is OrbitStatus.PERIOD_LIMIT
    assert state.orbit.reason.startswith("not every cell has a dashpot: the steady state is one of many")


@pytest.mark.parametrize("solver", ["compiled", "exact"])
def test_without_dashpots_friction_alone_may_attract_every_motion(solver) -> None:
    chain = undamped(cells=1, friction_ratio=0.3)
    state = steady_state(chain, HarmonicBase.from_ratio(chain, 0.9), solver=solver, with_error_bar=False)
    assert state.orbit.converged
    assert "attracts, largest multiplier 0." in state.orbit.reason


def test_undamped_resonance_has_no_steady_state() -> None:
    chain = undamped(cells=2, friction_ratio=0.0)
    (frequency, *_) = np.sqrt(np.linalg.eigvalsh(np.linalg.inv(chain.mass_matrix) @ chain.stiffness_matrix))
    drive = HarmonicBase(0.01, float(frequency) * (1 + 1e-7))
    state = steady_state(chain, drive)
    assert not state.orbit.converged
    assert state.error_bar is not None
    assert not math.isfinite(state.error_bar.transmittance_db)


def test_with_dashpots_nothing_is_said_of_attraction() -> None:
    assert orbit_of(Chain.from_ratios(cells=2, friction_ratio=0.3), 0.9).reason == ""
