"""Event-driven motion: closed-form oscillators, linear limits, energy, and the Euler scheme's limit."""

import cmath
import dataclasses

import numpy as np
import pytest

from reference_lcp import (
    Chain,
    CompiledSimulation,
    HarmonicBase,
    HarmonicForce,
    Lane,
    Mode,
    State,
    StillBase,
    exact_steady_state,
    simulate,
)
from reference_lcp.chain.linear_response import frictionless_response, stuck_response
from reference_lcp.chain.simulation import OrbitStatus
from reference_lcp.exact import event_driven
from reference_lcp.exact import exact_orbit as exact_orbit_module
from reference_lcp.exact.event_driven import EventDrivenChain, EventDrivenSimulation, EventsAccumulate
from reference_lcp.exact.exact_orbit import ExactPeriod, monodromy_matrix
from reference_lcp.lcp.time_step import solve_step
from reference_lcp.schemes.euler import chain_step
from tests.reference_lcp.cases import STANDING, canonical_lane, driven, one_cell, random_chain

ROUND_OFF = 1e-11
"""Of a whole run, relative to the drive: some ten thousand roundings, amplified by no unstable motion."""


def canonical(friction_ratio, frequency_ratio, **ratios) -> tuple[Chain, HarmonicBase]:
    return driven(frequency_ratio, friction_ratio=friction_ratio, **ratios)


def random_case(seed) -> tuple[Chain, HarmonicBase, State]:
    rng = np.random.default_rng(seed)
    cells = int(rng.integers(1, 6))
    chain = random_chain(rng, cells)
    state = State(rng.normal(0, 0.01, (1, 2 * cells)), rng.normal(0, 0.1, (1, 2 * cells)))
    return chain, HarmonicBase(0.01, rng.uniform(5, 60)), state


@pytest.mark.parametrize("ratio", [0.3, 0.9, 1.6])
@pytest.mark.parametrize(("friction", "limit"), [(0.0, frictionless_response), (100.0, stuck_response)])
def test_linear_limits_are_those_of_the_direct_solution(ratio, friction, limit) -> None:
    chain, drive = canonical(friction, ratio)
    steady = exact_steady_state(chain, drive)
    harmonic = ExactPeriod.following(steady.orbit, drive.period).harmonic()
    response = limit(chain, drive)
    assert np.max(np.abs(harmonic - response)) <= 1e-10 * np.max(np.abs(response))
    transmittance = cmath.rect(10 ** (steady.transmittance_db / 20), steady.phase)
    assert transmittance == pytest.approx(response[6] / drive.amplitude, rel=1e-10)
    assert np.all(steady.stuck_fraction == (0.0 if friction == 0 else 1.0))
    assert steady.transitions == []


@pytest.mark.parametrize("make", [HarmonicBase, HarmonicForce])
def test_a_chain_without_friction_moves_as_newtons_method_finds(make) -> None:
    chain, base = canonical(0.0, 0.62)
    drive = make(0.01, base.angular_frequency)
    steady, (orbit, _) = exact_steady_state(chain, drive), exact_orbit_module.exact_orbit(chain, drive)
    for name in ("positions", "velocities", "friction", "normal_force"):
        expected = getattr(orbit.trajectory, name)
        assert getattr(steady.orbit.trajectory, name) == pytest.approx(expected, abs=1e-9 * np.max(expected, initial=0))


@pytest.mark.parametrize(("place", "damping"), [((0.1, 0.6), 0.0), ((0.3, 0.62), 0.01), ((1.0, 0.9), 0.01)])
def test_work_of_the_drive_over_a_period_is_the_heat_of_friction_and_dashpots(place, damping) -> None:
    chain, drive = canonical(*place, damping_ratio=damping)
    period = ExactPeriod.following(exact_steady_state(chain, drive).orbit, drive.period)
    times, weights, states = period.quadrature
    velocities = states[:, 14:]
    work = weights @ (drive.load(chain, times) * velocities[:, 0])
    ends = np.array([segment.states(np.array([0.0, segment.duration])) for segment in period.segments])
    slips = np.diff(ends[:, :, 7:14] - ends[:, :, :7], axis=1)[:, 0]
    slipping = np.array([segment.modes for segment in period.segments]) != 0
    friction = chain.friction_bound * np.sum(np.abs(slips), axis=0, where=slipping)
    dashpots = weights @ np.einsum("ti,ij,tj->t", velocities, chain.damping_matrix, velocities)
    assert work == pytest.approx(dashpots + friction.sum(), rel=1e-9)
    assert [travel == 0 for travel in period.travels] == [change.kind is Mode.STICK for change in period.transitions]
    cells = [change.cell - 1 for change in period.transitions]
    travelled = chain.friction_bound * np.bincount(cells, period.travels, chain.cells)
    assert travelled[cells] == pytest.approx(friction[cells], rel=1e-9)


@pytest.mark.parametrize("seed", range(8))
def test_no_event_is_missed_in_random_chains(seed) -> None:
    """Against the Euler scheme at 40,000 and 80,000 steps: its distance is small, and halves.

    An event missed would leave a distance that does not fall with the step.
    """
    chain, drive, state = random_case(seed)
    exact = EventDrivenSimulation([Lane.periodic(chain, drive, 400)]).run(state, 0, 1200)[0]
    errors = []
    for steps in (40_000, 80_000):
        fine = CompiledSimulation([Lane.periodic(chain, drive, steps)]).run(state, 0, 3 * steps)[0]
        rows = slice(steps // 400 - 1, None, steps // 400)
        errors.append(np.max(np.abs(fine.positions[rows] - exact.positions)) / drive.amplitude)
    assert errors[1] < 5e-4
    assert errors[0] / errors[1] == pytest.approx(2.0, rel=0.15)


def test_runs_in_two_parts_and_lanes_beside_others_are_what_they_are_whole_and_alone() -> None:
    lanes = [canonical_lane(friction, 0.62) for friction in (0.1, 0.3)]
    together, start = EventDrivenSimulation(lanes), State.at_rest(2, 7)
    whole, middle = together.run(start, 0, 800), together.advance(start, 0, 531)
    alone = together.subset([1]).run(State.at_rest(1, 7), 0, 800)[0]
    assert np.array_equal(alone.positions, whole[1].positions)
    assert np.array_equal(alone.velocities, whole[1].velocities)
    assert np.array_equal(alone.end.positions[0], together.advance(start, 0, 800).positions[1])
    for lane, one, other in zip(lanes, whole, together.run(middle, 531, 269), strict=True):
        scale = lane.drive.amplitude
        assert np.max(np.abs(other.positions - one.positions[531:])) <= ROUND_OFF * scale
        speed = scale * lane.drive.angular_frequency
        assert np.max(np.abs(other.velocities - one.velocities[531:])) <= ROUND_OFF * speed


def test_rows_obey_coulombs_law() -> None:
    chain, drive = canonical([0.1, 0.3, 0.0, 0.6, 1.0, 0.05, 0.3], 0.62)
    run = simulate(chain, drive, time_step=drive.period / 400, steps=4000, solver="exact")
    bound, slip = chain.friction_bound, run.relative_velocity
    assert np.all(np.abs(run.friction) <= bound * (1 + 1e-12))
    assert np.all(run.friction * slip <= 0)
    inside = np.abs(run.friction) < bound * (1 - 1e-9)
    assert np.all(slip[inside] == 0)
    assert np.count_nonzero(inside) > 1000


@pytest.mark.parametrize("seed", range(10))
def test_modes_at_rest_solve_the_lcp_on_the_level_of_accelerations(seed) -> None:
    """Lemke's method on (g̈_T⁺, λ_TR), for contacts all at rest, finds the same forces cell by cell."""
    chain, drive, state = random_case(seed)
    n = chain.cells
    velocity = np.tile(state.velocities[:, :n], 2)
    position = state.positions[0]
    segment = next(EventDrivenChain(Lane(chain, drive, 1.0)).segments(State(position[None], velocity), 0.0, 1.0))
    load = float(drive.load(chain, np.asarray(0.0)))
    lemke = solve_step(chain_step(chain, position, velocity[0], load, 1.0, chain.normal_force))
    assert segment.friction[0] == pytest.approx(lemke.tangential, abs=1e-12 * np.max(chain.friction_bound) + 1e-12)
    acceleration = lemke.relative_velocity
    still = np.abs(acceleration) < 1e-9 * np.max(np.abs(acceleration))
    assert np.array_equal(segment.modes, np.where(still, 0, np.sign(acceleration)))


def test_monodromy_matrix_is_the_derivative_of_the_period_map() -> None:
    """Central differences over a period with stops, starts and turns, along slipping directions."""
    chain, drive = canonical(0.3, 0.62)
    lane = Lane.periodic(chain, drive, 400)
    state = exact_steady_state(chain, drive).orbit.trajectory.end
    segments = list(EventDrivenChain(lane).segments(state, 0.0, drive.period))
    assert len({segment.modes.tobytes() for segment in segments}) > 5
    matrix = monodromy_matrix(EventDrivenChain(lane), segments, 1.0)
    step = np.random.default_rng(0).normal(0, 1, (1, 28))
    stuck = np.flatnonzero(segments[0].modes == 0)
    step[0, 21 + stuck] = step[0, 14 + stuck]
    ends = []
    for sign in (1, -1):
        moved = State(state.positions + sign * 1e-8 * step[:, :14], state.velocities + sign * 1e-8 * step[:, 14:])
        end = EventDrivenSimulation([lane]).advance(moved, 0, 400)
        ends.append(np.concatenate([end.positions[0], end.velocities[0]]))
    difference = (ends[0] - ends[1]) / 2e-8
    assert matrix @ step[0] == pytest.approx(difference, abs=1e-5 * np.max(np.abs(difference)))


def test_contact_that_creeps_to_where_it_sticks_counts_as_sticking() -> None:
    """At friction ratio 1 and η_r = 0.9 cell 1 just reaches its bound; nothing slips forward and never back."""
    steady = exact_steady_state(*canonical(1.0, 0.9))
    assert steady.stuck_fraction[0] == 1.0
    assert {t.cell for t in steady.transitions} == {3, 5}


def released(bound: float, damping: float, start: float):
    """Rows of an inner mass of 1 kg on a spring of 100 N/m, while the outer mass stands, and its times."""
    chain = one_cell(bound, outer_mass=STANDING, inner_stiffness=100.0, inner_damping=damping)
    run = simulate(chain, StillBase(), time_step=0.05, steps=20, positions=np.array([0.0, start]), solver="exact")
    return run.inner_positions[:, 0], run.time


def test_force_at_its_bound_that_does_not_rise_further_holds_the_contact() -> None:
    """The spring of a resting inner mass pulls with exactly μ λ_N: Coulomb's law lets it rest."""
    assert released(bound=2.0, damping=0.0, start=0.02)[0] == pytest.approx(0.02, abs=1e-12)


def test_critically_damped_and_resonant_chains_have_exact_solutions_too() -> None:
    """Where the first-order matrix has no full set of eigenvectors, or a force meets an undamped resonance."""
    positions, time = released(bound=0.0, damping=20.0, start=1.0)
    assert positions == pytest.approx((1 + 10 * time) * np.exp(-10 * time), abs=1e-12)
    resonant = one_cell(inner_mass=STANDING, chain_stiffness=60.0, inner_stiffness=40.0)
    run = simulate(resonant, HarmonicForce(1.0, 10.0), time_step=0.05, steps=100, solver="exact")
    expected = (np.sin(10 * run.time) / 10 - run.time * np.cos(10 * run.time)) / 20
    assert run.outer_positions[:, 0] == pytest.approx(expected, abs=1e-12)


def test_contacts_that_change_modes_without_end_are_reported(monkeypatch) -> None:
    monkeypatch.setattr(event_driven, "EVENTS_PER_SPAN", 0)
    chain, drive = canonical(0.3, 0.62)
    with pytest.raises(EventsAccumulate, match="changes of mode between"):
        simulate(chain, drive, time_step=drive.period / 400, steps=400, solver="exact")


def test_a_search_that_newton_does_not_finish_goes_on_from_where_it_is(monkeypatch) -> None:
    polished = exact_orbit_module.polished

    def unfinished(*arguments, **options):
        return dataclasses.replace(polished(*arguments, **options), status=OrbitStatus.PERIOD_LIMIT)

    monkeypatch.setattr(exact_orbit_module, "polished", unfinished)
    orbit, period = exact_orbit_module.exact_orbit(*canonical(0.3, 0.9))
    assert orbit.converged
    assert period.transmittance == pytest.approx(10 ** (-9.561196141 / 20), rel=1e-8)
