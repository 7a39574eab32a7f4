"""The sliding contact of a chain in closed form: against the exact motion, Den Hartog, energy, and where it ends."""

import math
from functools import partial

import numpy as np
import pytest

from reference_lcp import (
    Chain,
    EventDrivenSystem,
    FrictionContact,
    Harmonic,
    HarmonicBase,
    MassSpringSystem,
    ParameterError,
    Piecewise,
    Spring,
    exact_steady_state,
)
from reference_lcp.exact.continuous_sliding import SlidingMotion, largest_sliding_friction
from reference_lcp.exact.one_contact import OneContact
from reference_lcp.exact.sliding_features import bounding_friction, friction_effect, invariant_frequencies
from tests.reference_lcp.exact.one_contact_systems import PLACES, oscillator, random_chain

OVER_LIMIT = 1e-3
"""Part of the limit by which friction is above it, where contacts have to stop within four periods."""

CHAINS = [(seed, place) for seed in range(8) for place in PLACES]


def exact_motion(system, motion, periods=2):
    """Positions from the closed form's state at t = 0 on, by the event-driven solver, and whether the contact rests."""
    state = {"position": motion.positions(0.0)[0], "velocity": motion.velocities(0.0)[0]}
    end = periods * 2 * np.pi / motion.system.angular_frequency
    stretches = list(EventDrivenSystem(system).stretches(**state, end=end))
    times = np.linspace(0, end, 41)[1:]
    return times, EventDrivenSystem(system).motion(**state, times=times).positions, any(0 in s.modes for s in stretches)


@pytest.mark.parametrize(("seed", "place"), CHAINS)
@pytest.mark.parametrize("part", [0.01, 0.5, 0.99])
def test_chain_that_slides_moves_as_the_exact_solver_finds(seed, place, part) -> None:
    with_friction = random_chain(seed, place)
    system = with_friction(part * largest_sliding_friction(with_friction(0.0)))
    motion = SlidingMotion.of(system)
    times, positions, rests = exact_motion(system, motion)
    assert not rests
    assert motion.positions(times) == pytest.approx(positions, abs=1e-10 * np.max(np.abs(positions)))


@pytest.mark.parametrize(("seed", "place"), CHAINS)
def test_contact_stops_just_above_the_limit_and_the_formula_is_refused_there(seed, place) -> None:
    with_friction = random_chain(seed, place)
    limit = largest_sliding_friction(with_friction(0.0))
    above = with_friction(limit * (1 + OVER_LIMIT))
    with pytest.raises(ParameterError, match=f"allowed: below {limit:.4g} N, from there on the contact stops"):
        SlidingMotion.of(above)
    _, _, rests = exact_motion(above, SlidingMotion.of(with_friction(limit * (1 - 1e-9))), periods=4)
    assert rests


def printed(r: float, friction: float) -> tuple[float, float]:
    """Den Hartog's amplitude and phase, as printed, of m = k = 1 under a force of amplitude one."""
    v, u = 1 / (1 - r**2), math.sin(math.pi / r) / (r * (1 + math.cos(math.pi / r)))
    amplitude = math.sqrt(v**2 - (friction * u) ** 2)
    return amplitude, math.atan2(-friction * u / v, amplitude / v)


@pytest.mark.parametrize(("r", "friction"), [(0.8, 0.3), (0.8, 0.5), (1.3, 0.4), (0.6, 0.2), (0.35, 0.03), (2.5, 0.4)])
def test_one_mass_moves_as_den_hartog_found(r, friction) -> None:
    motion = SlidingMotion.of(oscillator(r, friction))
    amplitude, phase = printed(r, friction)
    assert motion.contact_amplitude == pytest.approx(amplitude, rel=1e-13)
    # it turns back at +x0 half a period after its turn; there the force cos φ is sin ωt
    assert (motion.turn + 0.5) % 1 == pytest.approx((phase / (2 * math.pi) + 0.25) % 1, abs=1e-13)


@pytest.mark.parametrize("seed", range(8))
def test_one_contact_of_a_mass_in_mass_chain_gives_the_transmittance_of_the_exact_steady_state(seed) -> None:
    rng = np.random.default_rng(seed)
    cells = int(rng.integers(1, 4))
    ratios = {
        "cells": cells, "mass_ratio": rng.uniform(0.5, 2, cells), "stiffness_ratio": rng.uniform(0.5, 2, cells),
        "damping_ratio": 0.02,
    }  # fmt: skip
    place = np.eye(cells)[rng.integers(cells)]
    weak = Chain.from_ratios(friction_ratio=1e-3 * place, **ratios)
    drive = HarmonicBase.from_ratio(weak, rng.uniform(0.6, 2.0))
    wave = SlidingMotion.of_chain(weak, drive)
    unit = wave.system.friction / 1e-3
    limit = abs(wave.system.relative_response) / math.hypot(wave.square_wave.turn, wave.square_wave.hindrance)
    chain = Chain.from_ratios(friction_ratio=0.7 * limit / unit * place, **ratios)
    steady = exact_steady_state(chain, drive)
    level = SlidingMotion.of_chain(chain, drive).fundamental[cells - 1] / drive.amplitude
    assert steady.stuck_fraction == pytest.approx(np.zeros(cells))
    assert 10 ** (steady.transmittance_db / 20) == pytest.approx(abs(level), rel=1e-10)
    assert steady.phase == pytest.approx(np.angle(level), abs=1e-10)


@pytest.mark.parametrize("place", PLACES)
@pytest.mark.parametrize("seed", range(5))
def test_contact_is_locked_from_the_friction_on_that_holds_it(place, seed) -> None:
    """From the motion with the contact held, more friction changes nothing, and less lets it slide."""
    with_friction = random_chain(seed, place)
    own = OneContact.of(with_friction(0.0))
    held = own.response - own.friction_response * own.relative_response / (own.direction @ own.friction_response)
    state = {"position": np.imag(held), "velocity": np.imag(1j * own.angular_frequency * held)}
    for part, slides in ((1.01, False), (0.99, True)):
        solver = EventDrivenSystem(with_friction(part * own.locked_friction))
        end = 2 * np.pi / own.angular_frequency
        assert any(s.modes.any() for s in solver.stretches(**state, end=end)) == slides


def test_den_hartogs_oscillator_has_a_bounded_resonance_above_a_friction_of_pi_over_four() -> None:
    frequencies, frictions = bounding_friction(oscillator)
    assert frequencies == pytest.approx([1.0])
    assert frictions == pytest.approx([math.pi / 4])


def test_one_mass_far_above_its_resonance_stops_from_a_friction_of_two_over_the_root_of_pi_squared_and_four_on() -> (
    None
):
    """Inertia alone is left, and a force on a free mass with friction."""
    assert largest_sliding_friction(oscillator(1e3)) == pytest.approx(2 / math.sqrt(math.pi**2 + 4), rel=1e-5)


def test_friction_amplifies_a_mass_on_a_base_that_moves_with_the_wall_above_its_last_invariant_point() -> None:
    joined = partial(oscillator, joined=True)
    last = invariant_frequencies(joined, 0, lowest=1.1, highest=5.0, moving=1.0)
    assert last == pytest.approx([1.5063], abs=5e-5)
    assert (
        friction_effect(joined(0.99 * last[0]), 0, moving=1.0)
        < 0
        < friction_effect(joined(1.01 * last[0]), 0, moving=1.0)
    )


def row(omega: float, friction: float = 0.0) -> MassSpringSystem:
    """Five equal masses, a force on the first, friction of the third against a wall."""
    springs = [Spring(k, k - 1 if k else None, 1.0) for k in range(5)]
    return MassSpringSystem(
        masses=np.ones(5), springs=springs, friction=[FrictionContact(2, None, 1.0, friction)],
        forces={0: Harmonic(amplitude=1.0, angular_frequency=omega)},
    )  # fmt: skip


def test_resonances_of_a_chain_are_bounded_by_the_friction_that_takes_the_energy_of_their_mode() -> None:
    """Next to a resonance the sliding motion grows without bound below that friction, and there is none above it."""
    frequencies, frictions = bounding_friction(row)
    assert np.unique(np.round(frictions, 6)).size == 5
    for omega, friction in zip(frequencies, frictions, strict=True):
        sizes = [
            SlidingMotion.of(row(omega * (1 + shift), 0.95 * friction)).contact_amplitude for shift in (1e-3, 1e-5)
        ]
        assert sizes[1] > 50 * sizes[0]
        for shift in (-1e-5, 1e-5):
            with pytest.raises(ParameterError, match="from there on the contact stops"):
                SlidingMotion.of(row(omega * (1 + shift), 1.05 * friction))


def test_a_mode_that_does_not_move_the_contact_is_bounded_by_no_friction() -> None:
    middle = MassSpringSystem(
        masses=np.ones(3), springs=[Spring(0, None, 1.0), Spring(1, 0, 1.0), Spring(2, 1, 1.0), Spring(2, None, 1.0)],
        friction=[FrictionContact(1)], forces={0: Harmonic(amplitude=1.0, angular_frequency=1.0)},
    )  # fmt: skip
    assert np.isinf(bounding_friction(lambda _: middle)[1]).tolist() == [False, True, False]


@pytest.mark.parametrize(
    ("family", "body", "moving"),
    [(oscillator, 0, 0.0), (partial(oscillator, joined=True), 0, 1.0), *[(row, body, 0.0) for body in (0, 4)]],
    ids=["wall", "base", *[f"mass {k + 1} of five" for k in (0, 4)]],
)
def test_at_invariant_points_friction_changes_no_amplitude(family, body, moving) -> None:
    found = invariant_frequencies(family, body, lowest=0.45, highest=2.2, moving=moving)
    assert found
    for omega in found:
        limit = largest_sliding_friction(family(omega))
        levels = [abs(SlidingMotion.of(family(omega, part * limit)).fundamental[body] + moving) for part in (0.1, 0.9)]
        assert levels[0] == pytest.approx(levels[1], rel=1e-9)
        nearby = family(1.01 * omega, 0.5 * largest_sliding_friction(family(1.01 * omega)))
        assert abs(friction_effect(nearby, body, moving=moving)) > 1e-6


def test_friction_effect_is_that_of_any_friction() -> None:
    free = abs(SlidingMotion.of(row(0.7, 1e-9)).fundamental) ** 2
    limit = largest_sliding_friction(row(0.7))
    for friction in (0.3 * limit, 0.9 * limit):
        rise = abs(SlidingMotion.of(row(0.7, friction)).fundamental) ** 2 - free
        effects = [friction_effect(row(0.7), body) for body in range(5)]
        assert rise == pytest.approx(friction**2 * np.array(effects), rel=1e-7)


LOWER = math.sqrt((3 - math.sqrt(5)) / 2)
"""Natural frequency of two unit masses on unit springs [rad/s]."""


def push(omega: float, phase: float = 0.0) -> Harmonic:
    return Harmonic(amplitude=1.0, angular_frequency=omega, phase=phase)


def rough(coefficient: float = 0.01, *, normal: Harmonic | float = 1.0, static: float | None = None) -> list:
    return [FrictionContact(1, 0, normal, coefficient, static)]


def changed(**other) -> MassSpringSystem:
    """Two masses, a force on the first and friction between them, with something else."""
    given = {
        "masses": np.ones(2), "springs": [Spring(0, None, 1.0), Spring(1, 0, 1.0)],
        "friction": rough(), "forces": {0: push(0.8)},
    }  # fmt: skip
    return MassSpringSystem(**(given | other))


@pytest.mark.parametrize(
    ("system", "message"),
    [
        (changed(friction=[]), r"contacts with friction = 0; allowed: 1"),
        (changed(friction=[FrictionContact(k, None, 1.0, 0.1) for k in range(2)]), "contacts with friction = 2"),
        (changed(friction=rough(0.1, static=0.2)), r"static_coefficient = 0\.2; allowed: coefficient, 0\.1"),
        (changed(friction=rough(normal=Harmonic(1.0, 0.1, 1.0))), "normal_force = .* allowed: a constant"),
        (changed(springs=[Spring(1, 0, 1.0)]), "softest motion = .* allowed: > 0"),
        (changed(forces={}), r"angular frequencies of forces = \[\]"),
        (changed(forces={0: 1.0}), "force on body 0 = .* allowed: A sin"),
        (changed(forces={0: Piecewise({0.0: 1.0, 1.0: 2.0})}), "force on body 0 = pieces"),
        (changed(forces={0: push(1.0), 1: push(2.0)}), r"forces = \[1\.0, 2\.0\] rad/s; allowed: one"),
        (changed(forces={0: push(LOWER)}), "in resonance with an undamped mode"),
        (changed(forces={0: push(LOWER / 3)}), "in resonance .* a third"),
    ],
)
def test_motion_without_a_closed_form_is_refused_with_what_is_allowed(system, message) -> None:
    with pytest.raises(ParameterError, match=message):
        SlidingMotion.of(system)


@pytest.mark.parametrize(
    ("system", "body", "highest", "message"),
    [
        (changed(springs=[Spring(0, None, 1, 0.1), Spring(1, 0, 1)]), 0, 1.0, r"damping = 0\.1 N s/m; allowed: none"),
        (changed(), 2, 1.0, "body = 2; allowed: 0 to 1"),
        (changed(forces={0: push(0.8), 1: push(0.8, 1.0)}), 0, 1.0, "phases of the forces differ"),
        (changed(), 0, 0.4, "highest = 0.4 rad/s; allowed: above lowest, 0.5 rad/s"),
    ],
)
def test_feature_of_other_systems_or_frequencies_is_refused(system, body, highest, message) -> None:
    with pytest.raises(ParameterError, match=message):
        invariant_frequencies(lambda _: system, body, lowest=0.5, highest=highest)
