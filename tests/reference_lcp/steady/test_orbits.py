"""Steady states: the linear limits, the certificate, and what happens where there is none."""

import dataclasses
import math

import numpy as np
import pytest

from reference_lcp import (
    Chain,
    CompiledSimulation,
    HarmonicBase,
    Lane,
    ParameterError,
    StillBase,
    decibel,
    frictionless_transmittance,
    periodic_orbits,
    simulate,
    steady_state,
    stuck_fraction,
    stuck_transmittance,
    transitions,
    transmittance,
)
from reference_lcp.chain.simulation import OrbitStatus, steps_per_period_for
from reference_lcp.defaults import DEFAULT_PERIODS
from tests.reference_lcp.cases import EXACT_DB, driven, euler_orbit


def orbit_of(chain, frequency_ratio, steps=400, **options):
    return euler_orbit(chain, HarmonicBase.from_ratio(chain, frequency_ratio), steps, **options)


@pytest.mark.parametrize("place", EXACT_DB)
def test_transmittance_at_400_steps_is_within_two_hundredths_of_a_decibel_of_the_exact_value(place) -> None:
    chain = Chain.from_ratios(friction_ratio=place[0])
    steady = steady_state(chain, HarmonicBase.from_ratio(chain, place[1]))
    assert steady.orbit.residual <= 1e-8
    assert steady.transmittance_db == pytest.approx(EXACT_DB[place], abs=0.02)


@pytest.mark.parametrize("ratio", [0.3, 0.9, 1.6])
@pytest.mark.parametrize(("friction", "limit"), [(0.0, frictionless_transmittance), (100.0, stuck_transmittance)])
def test_linear_limits_are_those_of_the_direct_solution_to_first_order(friction, limit, ratio) -> None:
    """A friction ratio of 100 never slips; the cells are single masses m_o + m_i."""
    chain, drive = driven(ratio, friction_ratio=friction)
    exact, errors = decibel(limit(chain, drive)), []
    for steps in (3200, 6400):
        orbit = orbit_of(chain, ratio, steps)
        errors.append(abs(decibel(transmittance(orbit)) - exact))
        assert np.all(stuck_fraction(orbit) == (friction > 0))
        assert transitions(orbit) == []
    assert errors[0] / errors[1] == pytest.approx(2.0, abs=0.15)
    assert errors[1] < 0.02


def test_residual_certifies_the_orbit_over_one_plain_period() -> None:
    orbit = orbit_of(Chain.from_ratios(friction_ratio=0.3), 0.9)
    again = CompiledSimulation([orbit.lane]).run(orbit.trajectory.end, 0, 400)[0]
    scale = orbit.lane.drive.amplitude
    position = np.max(np.abs(again.positions[-1] - orbit.trajectory.positions[-1])) / scale
    assert position <= 10 * orbit.residual
    assert orbit.residual <= 1e-8
    assert orbit.reason == "", "with dashpots every motion ends there, and nothing is said of it"


def test_plain_simulation_approaches_the_same_orbit() -> None:
    """The fixed point is the attractor: a well damped chain gets there by itself."""
    chain = Chain.from_ratios(cells=2, damping_ratio=0.3, inner_damping_ratio=0.2, friction_ratio=0.1)
    orbit = orbit_of(chain, 0.9)
    drive = orbit.lane.drive
    run = simulate(chain, drive, time_step=orbit.lane.time_step, steps=400 * 120)
    assert np.max(np.abs(run.positions[-400:] - orbit.trajectory.positions)) < 1e-7 * drive.amplitude


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


def test_time_step_follows_the_highest_natural_frequency() -> None:
    chain = Chain.from_ratios()
    slow = HarmonicBase.from_ratio(chain, 0.02)
    steps = steps_per_period_for(chain, slow)
    assert slow.period / steps * chain.highest_natural_frequency <= 0.4
    assert steps_per_period_for(chain, HarmonicBase.from_ratio(chain, 1.0)) == 400


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
@pytest.mark.parametrize(
    ("ratios", "status", "reason"),
    [
        ({"cells": 3, "friction_ratio": 50.0}, OrbitStatus.PERIOD_LIMIT, "the steady state is one of many"),
        ({"cells": 1, "friction_ratio": 0.3}, OrbitStatus.CONVERGED, "attracts, largest multiplier 0."),
    ],
)
def test_without_dashpots_a_steady_state_converges_only_where_friction_attracts_every_motion(
    ratios, status, reason, solver
) -> None:
    """Free oscillations last for ever where nothing slips."""
    case = driven(0.9, damping_ratio=0.0, **ratios)
    orbit = steady_state(*case, solver=solver, with_error_bar=False).orbit
    assert orbit.residual < 1e-8
    assert orbit.status is status
    assert orbit.reason.startswith("dashpots do not resist every motion: ")
    assert reason in orbit.reason


def test_undamped_resonance_has_no_steady_state() -> None:
    chain = Chain.from_ratios(cells=2, damping_ratio=0.0)
    (frequency, *_) = np.sqrt(np.linalg.eigvalsh(np.linalg.inv(chain.mass_matrix) @ chain.stiffness_matrix))
    drive = HarmonicBase(0.01, float(frequency) * (1 + 1e-7))
    state = steady_state(chain, drive)
    assert not state.orbit.converged
    assert state.error_bar is not None
    assert not math.isfinite(state.error_bar.transmittance_db)
