"""Event-driven motion: closed-form oscillators, linear limits, energy, and the Euler scheme's limit."""

import json
from itertools import pairwise

import numpy as np
import pytest

from reference_lcp import (
    Chain,
    CompiledSimulation,
    EventDrivenChain,
    EventDrivenSimulation,
    EventsAccumulate,
    ExactPeriod,
    HarmonicBase,
    HarmonicForce,
    Lane,
    Mode,
    OrbitStatus,
    ParameterError,
    State,
    StillBase,
    chain_step,
    event_driven,
    exact_steady_state,
    frictionless_response,
    periodic_orbits,
    simulate,
    steady_state,
    stuck_response,
    transmittance,
)
from reference_lcp.__main__ import app
from reference_lcp.console import run_command
from reference_lcp.frictional_lcp import solve_step_given_normal_force
from reference_lcp.monodromy import monodromy_matrix

CANONICAL_DB = {
    (0.1, 0.6): 7.865,
    (0.3, 0.6): -0.147,
    (0.3, 0.9): -9.561,
    (0.6, 0.9): -3.553,
    (0.6, 1.3): -15.244,
    (1.0, 0.9): 0.600,
}
"""Transmittance at (friction ratio, frequency ratio) of another event-driven solver, of matrix exponentials."""

STANDING = np.asarray(1e14)
"""A mass [kg] so heavy that it stands still: it moves by 1e-14 of what the other one does."""

ROUND_OFF = 1e-11
"""Of a whole run, relative to the drive: some ten thousand roundings, amplified by no unstable motion."""


def canonical(friction_ratio, frequency_ratio, **ratios) -> tuple[Chain, HarmonicBase]:
    chain = Chain.from_ratios(friction_ratio=friction_ratio, **ratios)
    return chain, HarmonicBase.from_ratio(chain, frequency_ratio)


def random_case(seed) -> tuple[Chain, HarmonicBase, State]:
    rng = np.random.default_rng(seed)
    cells = int(rng.integers(1, 6))
    chain = Chain(
        cells=cells,
        outer_mass=rng.uniform(0.5, 2, cells),
        inner_mass=rng.uniform(0.1, 2, cells),
        chain_stiffness=rng.uniform(200, 2000, cells),
        inner_stiffness=rng.uniform(200, 2000, cells),
        chain_damping=rng.uniform(0, 2, cells),
        inner_damping=rng.uniform(0, 1, cells),
        normal_force=rng.uniform(0, 10, cells),
        friction_coefficient=rng.uniform(0, 1, cells),
    )
    state = State(rng.normal(0, 0.01, (1, 2 * cells)), rng.normal(0, 0.1, (1, 2 * cells)))
    return chain, HarmonicBase(0.01, rng.uniform(5, 60)), state


def test_free_decay_loses_four_bounds_over_stiffness_a_cycle_and_rests_in_the_dead_band() -> None:
    """Coulomb friction lowers the amplitude by 4 F / k a cycle, until |x| <= F / k at a turn."""
    friction, stiffness, start = 2.0, 100.0, 0.27
    chain = Chain(
        cells=1, outer_mass=STANDING, inner_mass=np.asarray(1.0), chain_stiffness=np.asarray(1.0),
        inner_stiffness=np.asarray(stiffness), normal_force=np.asarray(friction), friction_coefficient=np.asarray(1.0),
    )  # fmt: skip
    period = 2 * np.pi / np.sqrt(stiffness)
    run = simulate(chain, StillBase(), time_step=period / 8, steps=40, positions=np.array([0.0, start]), solver="exact")
    turns = run.inner_positions[3::4, 0]
    expected = start - 2 * friction / stiffness * np.arange(1, 7)
    assert turns[:6] * (-1.0) ** np.arange(1, 7) == pytest.approx(expected, abs=1e-10)
    assert np.ptp(run.inner_positions[-8:, 0]) < 1e-12
    assert abs(turns[-1]) <= friction / stiffness


def den_hartog(frequency_ratio, force_ratio) -> tuple[float, float]:
    """Amplitude over P0 / k, and phase of the turn, of the sliding friction oscillator.

    J. P. Den Hartog, "Forced vibrations with combined Coulomb and viscous friction", Trans. ASME 53
    (1931): m ẍ + k x + F sgn ẋ = P0 cos(ωt + φ) with x = x0 at its turn t = 0 has, while it never stops,
    x0 = (P0/k) √(V² − (F/P0)² U²) and tan φ = −(F / k) U / x0, where V = 1 / (1 − r²),
    U = sin(π/r) / (r (1 + cos(π/r))).
    """
    r = frequency_ratio
    v, u = 1 / (1 - r**2), np.sin(np.pi / r) / (r * (1 + np.cos(np.pi / r)))
    amplitude = np.sqrt(v**2 - (force_ratio * u) ** 2)
    return amplitude, float(np.arctan2(-force_ratio * u / v, amplitude / v))


@pytest.mark.parametrize(("frequency_ratio", "force_ratio"), [(0.8, 0.3), (0.8, 0.6), (1.3, 0.4), (0.6, 0.2)])
def test_sliding_friction_oscillator_moves_as_den_hartog_found(frequency_ratio, force_ratio) -> None:
    """The outer mass slides on an inner one that stands still; it turns at x0 in Den Hartog's phase."""
    stiffness, load = 100.0, 10.0
    chain = Chain(
        cells=1, outer_mass=np.asarray(1.0), inner_mass=STANDING, chain_stiffness=np.asarray(60.0),
        inner_stiffness=np.asarray(40.0), normal_force=np.asarray(force_ratio * load),
        friction_coefficient=np.asarray(1.0),
    )  # fmt: skip
    drive = HarmonicForce(load, frequency_ratio * np.sqrt(stiffness))
    amplitude, phase = den_hartog(frequency_ratio, force_ratio)
    # P0 cos(ωt + φ) at the turn is P0 sin of the phase φ + π/2.
    turn = (phase + np.pi / 2) % (2 * np.pi) / drive.angular_frequency
    state = State(np.array([[amplitude * load / stiffness, 0.0]]), np.zeros((1, 2)))
    segments = list(EventDrivenChain(Lane(chain, drive, 1.0)).segments(state, turn, turn + 3 * drive.period))
    assert all(segment.modes[0] != 0 for segment in segments)
    changes = [s for before, s in pairwise(segments) if s.modes[0] != before.modes[0]]
    assert len(changes) >= 5
    for k, segment in enumerate(changes[:5], start=1):
        assert segment.start == pytest.approx(turn + k * drive.period / 2, abs=1e-10 * drive.period)
        expected = (-1) ** k * amplitude * load / stiffness
        assert segment.coefficients[0, 0] == pytest.approx(expected, abs=1e-10)


def largest_force_ratio_without_stops(frequency_ratio) -> float:
    """Den Hartog's limit of sliding: F/P0 = √(V² / (U² + (S/r²)²)).

    S is the maximum of [r sin τ + U r² (cos rτ − cos τ)] / sin rτ over 0 < τ < π/r, from turn to turn.
    """
    r = frequency_ratio
    v, u = 1 / (1 - r**2), np.sin(np.pi / r) / (r * (1 + np.cos(np.pi / r)))
    tau = np.linspace(1e-6, np.pi / r - 1e-6, 200_001)
    s = np.max((r * np.sin(tau) + u * r**2 * (np.cos(r * tau) - np.cos(tau))) / np.sin(r * tau))
    return float(np.sqrt(v**2 / (u**2 + (s / r**2) ** 2)))


def modes_over_a_period(frequency_ratio, force_ratio, **how) -> list[Mode]:
    """Modes that a friction oscillator driven by P0 sin ωt runs through in its steady state."""
    chain = Chain(
        cells=1, outer_mass=np.asarray(1.0), inner_mass=STANDING, chain_stiffness=np.asarray(60.0),
        inner_stiffness=np.asarray(40.0), normal_force=np.asarray(force_ratio * 10.0),
        friction_coefficient=np.asarray(1.0),
    )  # fmt: skip
    found = steady_state(chain, HarmonicForce(10.0, frequency_ratio * 10.0), with_error_bar=False, **how)
    return [change.kind for change in found.transitions]


@pytest.mark.parametrize("frequency_ratio", [0.45, 0.6, 0.8, 1.3])
def test_oscillator_begins_to_stop_twice_a_cycle_at_den_hartogs_limit(frequency_ratio) -> None:
    limit = largest_force_ratio_without_stops(frequency_ratio)
    assert modes_over_a_period(frequency_ratio, 0.99 * limit, solver="exact").count(Mode.STICK) == 0
    assert modes_over_a_period(frequency_ratio, 1.01 * limit, solver="exact").count(Mode.STICK) == 2


@pytest.mark.parametrize(
    ("frequency_ratio", "force_ratio", "stops", "turns"),
    [(0.8, 0.5, 0, 2), (0.8, 0.95, 2, 0), (0.35, 0.03, 0, 2), (0.35, 0.1, 2, 2), (0.3, 0.1, 4, 0), (0.2, 0.4, 4, 0)],
)
def test_stops_of_the_oscillator_come_in_pairs_and_more_of_them_at_low_frequency(
    frequency_ratio, force_ratio, stops, turns
) -> None:
    """Hong and Liu 2001: 0, 2, 4, … stops a cycle; the scheme at a fine step counts the same.

    At (0.35, 0.1) the mass stops and goes on in the same direction, and turns without stopping.
    """
    for how in ({"solver": "exact"}, {"steps_per_period": 25_600}):
        modes = modes_over_a_period(frequency_ratio, force_ratio, **how)
        cyclic = [*modes, modes[0]]
        assert modes.count(Mode.STICK) == stops
        assert sum(Mode.STICK not in pair for pair in pairwise(cyclic)) == turns


@pytest.mark.parametrize("ratio", [0.3, 0.62, 0.9, 1.1, 1.6])
@pytest.mark.parametrize(("friction", "limit"), [(0.0, frictionless_response), (100.0, stuck_response)])
def test_linear_limits_are_those_of_the_direct_solution(ratio, friction, limit) -> None:
    chain, drive = canonical(friction, ratio)
    found = exact_steady_state(chain, drive)
    harmonic = ExactPeriod.following(found.orbit, drive.period).harmonic()
    response = limit(chain, drive)
    assert np.max(np.abs(harmonic - response)) <= 1e-10 * np.max(np.abs(response))
    assert found.transmittance_db == pytest.approx(20 * np.log10(abs(response[6]) / drive.amplitude), abs=1e-9)
    assert np.all(found.stuck_fraction == (0.0 if friction == 0 else 1.0))
    assert found.transitions == []


@pytest.mark.parametrize("place", CANONICAL_DB)
def test_canonical_transmittance(place) -> None:
    found = exact_steady_state(*canonical(*place))
    assert found.orbit.residual <= 1e-11
    assert found.transmittance_db == pytest.approx(CANONICAL_DB[place], abs=1e-3)


@pytest.mark.parametrize("place", [(0.1, 0.6), (0.3, 0.62), (0.6, 1.3), (1.0, 0.9)])
@pytest.mark.parametrize("damping", [0.0, 0.01])
def test_work_of_the_drive_over_a_period_is_the_heat_of_friction_and_dashpots(place, damping) -> None:
    chain, drive = canonical(*place, damping_ratio=damping)
    period = ExactPeriod.following(exact_steady_state(chain, drive).orbit, drive.period)
    heat = period.dashpot_heat + period.friction_heat.sum()
    assert period.work_of_load == pytest.approx(heat, rel=1e-9)
    assert np.all(period.friction_heat >= 0)


@pytest.mark.parametrize("place", [(0.1, 0.6), (0.3, 0.9), (0.6, 1.3), (1.0, 0.9)])
def test_euler_scheme_converges_to_the_exact_transmittance_at_first_order(place) -> None:
    """Six halvings of the step; at small friction single halvings scatter, as contacts stop a step sooner or later."""
    chain, drive = canonical(*place)
    exact = exact_steady_state(chain, drive).transmittance_db
    steps = 400 * 2 ** np.arange(7)
    errors = [
        abs(steady_state(chain, drive, steps_per_period=int(n), tolerance=1e-10).transmittance_db - exact)
        for n in steps
    ]
    order = -np.polyfit(np.log(steps), np.log(errors), 1)[0]
    assert order == pytest.approx(1.0, abs=0.15)
    assert errors[-1] < 2e-4


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


@pytest.mark.parametrize("seed", range(4))
def test_two_parts_of_a_run_equal_the_whole(seed) -> None:
    chain, drive, state = random_case(seed)
    simulation = EventDrivenSimulation([Lane.periodic(chain, drive, 400)])
    whole = simulation.run(state, 0, 1200)[0]
    first = simulation.run(state, 0, 531)[0]
    parts = first.joined(simulation.run(first.end, 531, 669)[0])
    speed = drive.amplitude * drive.angular_frequency
    assert np.max(np.abs(parts.positions - whole.positions)) <= ROUND_OFF * drive.amplitude
    assert np.max(np.abs(parts.velocities - whole.velocities)) <= ROUND_OFF * speed


def test_repeated_runs_are_bitwise_equal_and_lanes_are_what_they_are_alone() -> None:
    lanes = [Lane.periodic(*canonical(friction, 0.62), 400) for friction in (0.1, 0.3)]
    one, other = (EventDrivenSimulation(lanes).run(State.at_rest(2, 7), 0, 800) for _ in range(2))
    alone = EventDrivenSimulation(lanes).subset([1]).run(State.at_rest(1, 7), 0, 800)[0]
    assert np.array_equal(one[1].positions, other[1].positions)
    assert np.array_equal(one[1].friction, other[1].friction)
    assert np.array_equal(alone.velocities, one[1].velocities)


def test_rows_obey_coulombs_law() -> None:
    chain, drive = canonical([0.1, 0.3, 0.0, 0.6, 1.0, 0.05, 0.3], 0.62)
    run = simulate(chain, drive, time_step=drive.period / 400, steps=4000, solver="exact")
    bound, slip = chain.friction_bound, run.relative_velocity
    assert np.all(np.abs(run.friction) <= bound * (1 + 1e-12))
    assert np.all(run.friction * slip <= 0)
    inside = np.abs(run.friction) < bound * (1 - 1e-9)
    assert np.all(slip[inside] == 0)
    assert np.count_nonzero(inside) > 1000


@pytest.mark.parametrize("ratio", [0.1, 0.6, 1.3])
def test_distance_of_two_motions_under_one_drive_never_grows(ratio) -> None:
    """Coulomb friction is monotone; without a time-step error the energy norm falls to round-off exactly."""
    chain, drive = canonical(0.3, ratio)
    rng = np.random.default_rng(1)
    state = State(rng.normal(0, 0.01, (2, 14)), rng.normal(0, 0.2, (2, 14)))
    lane = Lane.periodic(chain, drive, 400)
    one, other = EventDrivenSimulation([lane, lane]).run(state, 0, 2000)
    x, v = one.positions - other.positions, one.velocities - other.velocities
    energy = np.einsum("ti,ij,tj->t", v, chain.mass_matrix, v) + np.einsum("ti,ij,tj->t", x, chain.stiffness_matrix, x)
    assert np.all(np.diff(energy) <= 1e-12 * energy[0])
    assert energy[-1] < 0.9 * energy[0]


@pytest.mark.parametrize("seed", range(20))
def test_modes_at_rest_solve_the_lcp_on_the_level_of_accelerations(seed) -> None:
    """Lemke's method on (g̈_T⁺, λ_TR), for contacts all at rest, finds the same forces cell by cell."""
    chain, drive, state = random_case(seed)
    n = chain.cells
    velocity = np.tile(state.velocities[:, :n], 2)
    position = state.positions[0]
    segment = next(EventDrivenChain(Lane(chain, drive, 1.0)).segments(State(position[None], velocity), 0.0, 1.0))
    load = float(drive.load(chain, np.asarray(0.0)))
    lemke = solve_step_given_normal_force(chain_step(chain, position, velocity[0], load, 1.0), chain.normal_force)
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
    matrix = monodromy_matrix(EventDrivenChain(lane), segments)
    rng = np.random.default_rng(0)
    step = rng.normal(0, 1, (1, 28))
    stuck = np.flatnonzero(segments[0].modes == 0)
    step[0, 21 + stuck] = step[0, 14 + stuck]
    ends = []
    for sign in (1, -1):
        moved = State(state.positions + sign * 1e-8 * step[:, :14], state.velocities + sign * 1e-8 * step[:, 14:])
        end = EventDrivenSimulation([lane]).advance(moved, 0, 400)
        ends.append(np.concatenate([end.positions[0], end.velocities[0]]))
    difference = (ends[0] - ends[1]) / 2e-8
    assert matrix @ step[0] == pytest.approx(difference, abs=1e-5 * np.max(np.abs(difference)))


def test_exact_observables_are_those_of_a_finely_sampled_orbit() -> None:
    chain, drive = canonical(0.3, 0.9)
    exact = exact_steady_state(chain, drive)
    sampled = steady_state(chain, drive, steps_per_period=25_600)
    assert exact.stuck_fraction == pytest.approx(sampled.stuck_fraction, abs=1e-3)
    assert [(t.cell, t.kind) for t in exact.transitions] == [(t.cell, t.kind) for t in sampled.transitions]
    times = np.array([t.time for t in exact.transitions])
    assert times == pytest.approx([t.time for t in sampled.transitions], abs=1e-3 * drive.period)
    assert transmittance(exact.orbit) == pytest.approx(10 ** (exact.transmittance_db / 20), rel=1e-7)


def test_transitions_come_in_pairs_half_a_period_apart() -> None:
    """The drive changes its sign after half a period; so does the steady state, to round-off."""
    chain, drive = canonical(0.3, 0.9)
    opposite = {Mode.STICK: Mode.STICK, Mode.FORWARD: Mode.BACKWARD, Mode.BACKWARD: Mode.FORWARD}
    found = [(t.cell, t.time / drive.period, t.kind) for t in exact_steady_state(chain, drive).transitions]
    assert found
    for cell, time, kind in found:
        partners = [t for c, t, k in found if c == cell and k is opposite[kind]]
        assert min(abs((t - time) % 1 - 0.5) for t in partners) < 1e-10


def test_contact_that_creeps_to_where_it_sticks_counts_as_sticking() -> None:
    """At friction ratio 1 and η_r = 0.9 cell 1 just reaches its bound; nothing slips forward and never back."""
    found = exact_steady_state(*canonical(1.0, 0.9))
    assert found.stuck_fraction[0] == 1.0
    assert {t.cell for t in found.transitions} == {3, 5}


def test_force_at_its_bound_that_does_not_rise_further_holds_the_contact() -> None:
    """The spring of a resting inner mass pulls with exactly μ λ_N: Coulomb's law lets it rest."""
    chain = Chain(
        cells=1, outer_mass=STANDING, inner_mass=np.asarray(1.0), chain_stiffness=np.asarray(1.0),
        inner_stiffness=np.asarray(100.0), normal_force=np.asarray(2.0), friction_coefficient=np.asarray(1.0),
    )  # fmt: skip
    run = simulate(chain, StillBase(), time_step=0.01, steps=50, positions=np.array([0.0, 0.02]), solver="exact")
    assert np.max(np.abs(run.inner_positions - 0.02)) < 1e-12


def test_critically_damped_and_resonant_chains_have_exact_solutions_too() -> None:
    """Where the first-order matrix has no full set of eigenvectors, or a force meets an undamped resonance."""
    chain = Chain(
        cells=1, outer_mass=STANDING, inner_mass=np.asarray(1.0), chain_stiffness=np.asarray(1.0),
        inner_stiffness=np.asarray(100.0), inner_damping=np.asarray(20.0),
    )  # fmt: skip
    run = simulate(chain, StillBase(), time_step=0.05, steps=20, positions=np.array([0.0, 1.0]), solver="exact")
    assert run.inner_positions[:, 0] == pytest.approx((1 + 10 * run.time) * np.exp(-10 * run.time), abs=1e-12)
    resonant = Chain(
        cells=1, outer_mass=np.asarray(1.0), inner_mass=STANDING, chain_stiffness=np.asarray(60.0),
        inner_stiffness=np.asarray(40.0),
    )  # fmt: skip
    run = simulate(resonant, HarmonicForce(1.0, 10.0), time_step=0.05, steps=100, solver="exact")
    expected = (np.sin(10 * run.time) / 10 - run.time * np.cos(10 * run.time)) / 20
    assert run.outer_positions[:, 0] == pytest.approx(expected, abs=1e-12)


def test_event_driven_map_has_its_orbits_found_as_any_simulation() -> None:
    lanes = [Lane.periodic(*canonical(0.3, 0.62), 400), Lane.periodic(*canonical(0.6, 0.62), 400)]
    orbits = periodic_orbits(EventDrivenSimulation(lanes), 400, tolerance=1e-12)
    assert [orbit.status for orbit in orbits] == [OrbitStatus.CONVERGED] * 2


def test_contacts_that_change_modes_without_end_are_reported(monkeypatch) -> None:
    monkeypatch.setattr(event_driven, "EVENTS_PER_SPAN", 0)
    chain, drive = canonical(0.3, 0.62)
    with pytest.raises(EventsAccumulate, match="changes of mode between"):
        simulate(chain, drive, time_step=drive.period / 400, steps=400, solver="exact")


def test_drive_without_harmonic_form_is_refused() -> None:
    class Ramp(StillBase):
        pass

    class Record:
        displacement_scale = StillBase.displacement_scale

    with pytest.raises(ParameterError, match="Record has no event-driven solution; allowed: HarmonicBase"):
        EventDrivenSimulation([Lane(Chain.from_ratios(), Record(), 1e-3)])
    EventDrivenSimulation([Lane(Chain.from_ratios(), Ramp(), 1e-3)])


def test_command_line_answers_the_exact_solver_with_the_same_keys(capsys) -> None:
    answers = []
    for solver in ("compiled", "exact"):
        assert run_command(app, ["--solver", solver, "--json"]) == 0
        answers.append(json.loads(capsys.readouterr().out))
    assert answers[0].keys() == answers[1].keys()
    assert answers[1]["residual"] <= 1e-11
    assert answers[1]["transmittance_db"] == pytest.approx(answers[0]["transmittance_db"], abs=0.01)
