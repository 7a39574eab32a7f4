"""Steady states of bodies that are no chain, ground that moves, and transitions of any motion."""

import re
import time

import numpy as np
import pytest
from scipy.optimize import brentq

from reference_lcp import (
    Chain,
    EventDrivenSystem,
    FrictionContact,
    Harmonic,
    HarmonicBase,
    Lane,
    MassSpringSystem,
    Mode,
    Motion,
    ParameterError,
    Piecewise,
    RickerPulse,
    Spring,
    State,
    simulate,
    simulate_system,
    steady_state,
    stuck_fraction,
    transitions,
)
from reference_lcp.chain.drives import HarmonicForce
from reference_lcp.exact.continuous_sliding import SlidingMotion
from reference_lcp.exact.event_driven_system import EventDrivenBodies
from reference_lcp.schemes.bodies import EulerBodies
from tests.reference_lcp.exact.one_contact_systems import oscillator as forced_mass


def oscillator(ratio: float, friction: float, *, joined: bool = False, damping: float = 0.0) -> MassSpringSystem:
    """One mass on a base that moves as sin rt, with friction against a wall that stands, or moves with the base."""
    base = Motion(amplitude=1.0, angular_frequency=ratio)
    wall = FrictionContact(0, base if joined else None, 1.0, friction)
    return MassSpringSystem(masses=[1.0], springs=[Spring(0, base, 1.0, damping)], friction=[wall])


def coupled(*, static: float = 1.0) -> MassSpringSystem:
    """Three masses in a row with friction between them, on a ground that shakes; one contact is pressed in waves."""
    ground = Motion(velocity=0.2, amplitude=0.3, angular_frequency=2.0)
    springs = [Spring(0, None, 3.0, 0.1), Spring(1, 2, 2.0, 0.1), Spring(2, Motion(0.0, 0.4, 1.0, 0.3), 1.0, 0.2)]
    between = [(0, 1, Harmonic(2.0, 1.0, 1.0), 0.1), (1, 2, 2.0, 0.05), (2, ground, 1.0, 0.3)]
    friction = [FrictionContact(*own, own[-1] * static) for own in between]
    return MassSpringSystem(masses=[1.0, 0.5, 2.0], springs=springs, friction=friction, forces={0: Harmonic(0.1, 2, 1)})


@pytest.mark.parametrize("friction", [0.2, 0.5])
@pytest.mark.parametrize("ratio", [0.6, 0.8, 1.2, 1.5, 2.5])
def test_a_mass_between_a_shaken_base_and_a_wall_moves_as_den_hartog_says(ratio, friction) -> None:
    state, motion = steady_state(oscillator(ratio, friction)), SlidingMotion.of(forced_mass(ratio, friction))
    assert state.orbit.converged
    assert state.amplitude == pytest.approx([motion.contact_amplitude], rel=1e-12)
    assert state.phase == pytest.approx([np.angle(motion.fundamental[0])], abs=1e-12)
    assert state.stuck_fraction == [0]
    assert [change.kind for change in state.transitions] in (
        [Mode.FORWARD, Mode.BACKWARD],
        [Mode.BACKWARD, Mode.FORWARD],
    )


def test_published_amplitude_and_half_a_second_a_point() -> None:
    """Marino, Cicirello and Hills 2019, fixed wall."""
    steady_state(oscillator(0.7, 0.5))  # what is compiled is compiled
    began = time.process_time()
    state = steady_state(oscillator(0.8, 0.5))
    assert time.process_time() - began < 0.5, "some 40 ms on an idle machine"
    assert state.amplitude == pytest.approx([2.33223], abs=5e-6)
    assert repr(state) == "<SystemSteadyState amplitudes 2.33223 m, phases -0.685054 rad, stuck 0>"


def test_a_wall_that_moves_with_the_base_is_one_at_rest_in_coordinates_of_the_base() -> None:
    """Marino, Cicirello and Hills 2019, joined base and wall, with stops that Den Hartog's 0.52855 leaves out."""
    relative = MassSpringSystem(
        masses=[1.0], springs=[Spring(0, stiffness=1.0)], friction=[FrictionContact(0, None, 1.0, 0.2)],
        forces={0: Harmonic(amplitude=0.36, angular_frequency=0.6)},
    )  # fmt: skip
    joined, own = steady_state(oscillator(0.6, 0.2, joined=True)), steady_state(relative)
    assert own.amplitude == pytest.approx([0.52817], abs=5e-6)
    assert own.stuck_fraction == pytest.approx([0.023], abs=5e-4)
    assert joined.stuck_fraction == pytest.approx(own.stuck_fraction, rel=1e-9)
    assert [change.time for change in joined.transitions] == pytest.approx([change.time for change in own.transitions])


@pytest.mark.parametrize("belt", [False, True])
def test_a_pulled_mass_slips_when_the_closed_form_says_and_so_does_one_on_a_belt(belt) -> None:
    """m ẍ = k (v t − x) − μ_k m g from a pull of μ_s m g, until ẋ = 0; a belt under the mass does the same."""
    m, k, v, g, static, kinetic = 10.0, 4000.0, 0.01, 9.81, 0.3, 0.2
    end, ground = (None, Motion(velocity=v)) if belt else (Motion(velocity=v), None)
    contact = FrictionContact(0, ground, m * g, kinetic, static)
    system = MassSpringSystem(masses=[m], springs=[Spring(0, end, k)], friction=[contact])
    omega, extra = np.sqrt(k / m), (static - kinetic) * g * m / k
    slip = brentq(
        lambda t: v + extra * omega * np.sin(omega * t) - v * np.cos(omega * t), np.pi / omega, 1.5 * np.pi / omega
    )
    jump = v * slip + extra * (1 - np.cos(omega * slip)) - v / omega * np.sin(omega * slip)
    times = static * m * g / k / v + np.array([0, slip, slip - (v * slip - jump) / v])
    start = {"position": [0.0], "velocity": [v if belt else 0.0]}
    found = transitions(EventDrivenSystem(system).motion(**start, times=[1.5]))
    assert [change.time for change in found] == pytest.approx(times, abs=1e-12)
    assert times[[0, 2]] == pytest.approx([0.73575, 1.4034414], abs=5e-8)
    slips = Mode.BACKWARD if belt else Mode.FORWARD
    assert [change.kind for change in found] == [slips, Mode.STICK, slips]
    steps = transitions(simulate_system(system, **start, time_step=1e-3, steps=1500))
    assert [change.kind for change in steps] == [change.kind for change in found]
    assert [change.time for change in steps] == pytest.approx(times, abs=3e-3)


def test_the_compiled_scheme_of_bodies_is_lemkes_method_at_every_step() -> None:
    system, rest = coupled(), np.zeros(3)
    own = EulerBodies(Lane(system, HarmonicForce(1.0, 1.0, 1.0), 0.01)).run(State(rest[None], rest[None]), 5, 400)
    other = simulate_system(system, position=rest, velocity=rest, time_step=0.01, steps=400, start=5)
    assert np.any(other.slip == 0)
    for name in ("positions", "velocities", "friction", "slip"):
        assert getattr(own, name) == pytest.approx(getattr(other, name), abs=1e-11)


@pytest.mark.parametrize("system", [coupled(), oscillator(0.6, 0.5, damping=0.05), oscillator(0.6, 0.2, joined=True)])
def test_error_bars_of_bodies_cover_the_exact_steady_state(system) -> None:
    exact, state = steady_state(system), steady_state(system, solver="compiled")
    bar = state.error_bar
    assert np.all(np.abs(state.amplitude - exact.amplitude) <= bar.amplitude)
    assert np.all(bar.amplitude < 0.03 * exact.amplitude)
    assert np.all(np.abs(np.angle(np.exp(1j * (state.phase - exact.phase)))) <= bar.phase)
    assert np.all(np.abs(state.stuck_fraction - exact.stuck_fraction) <= bar.stuck_fraction)


@pytest.mark.parametrize("static", [1.0, 1.4])
def test_a_steady_state_of_coupled_contacts_repeats_and_its_jacobian_is_that_of_the_period_map(static) -> None:
    system = coupled(static=static)
    state = steady_state(system)
    assert state.orbit.residual < 1e-11
    model, period = EventDrivenBodies(state.orbit.lane), state.orbit.lane.drive.period
    x = np.concatenate([state.orbit.trajectory.positions[-1], state.orbit.trajectory.velocities[-1]])

    def after(start: np.ndarray) -> list:
        return list(model.segments(State(start[None, :3], start[None, 3:]), 0.0, period))

    segments = after(x)
    assert {0, 1} <= set(np.ravel([np.abs(own.modes) for own in segments]).tolist())
    end = segments[-1].values(segments[-1].coefficients, period)[0]
    assert end == pytest.approx(x, abs=1e-10)
    way = 1e-6 * np.random.default_rng(1).normal(size=6)
    moved = after(x + way)[-1]
    change = moved.values(moved.coefficients, period)[0] - end
    assert model.monodromy(segments) @ way == pytest.approx(change, abs=1e-9)


BASE = Motion(amplitude=1.0, angular_frequency=1.0)

REFUSED = {
    "body 1 floats, so that it has no steady state; allowed: a spring": {"masses": [1.0, 2.0]},
    "body 0 is at an undamped resonance of 1 rad/s, and friction takes up 0.255 of what": {},
    "nothing in the system repeats; allowed": {"springs": [Spring(0, stiffness=1.0)]},
    "force on body 0 grows by 1 N/s for ever": {"springs": [Spring(0, Motion(1.0, 1.0, 2.0), 1.0)]},
    "force on body 0 switches at 2 s; allowed: what repeats": {"forces": {0: Piecewise({0.0: 1.0, 2.0: 0.0})}},
    "ground under contact 0 repeats 16.9706 times in 75.3982 s": {
        "friction": [FrictionContact(0, Motion(0.0, 1.0, 2**0.5), 1.0, 0.2)]
    },
    "force on body 0 = <function": {"forces": {0: lambda time: time}},
    "normal force of contact 0 = 'N' is not a number": {"friction": [FrictionContact(0, None, "N", 0.2)]},
    "2 contacts join bodies in a ring, which contact 1 closes at body 0": {"friction": [FrictionContact(0)] * 2},
}


@pytest.mark.parametrize("message", REFUSED)
def test_a_system_without_a_steady_state_is_refused_with_the_body_and_the_reason(message: str) -> None:
    given = {"masses": [1.0], "springs": [Spring(0, BASE, 1.0)], "friction": [FrictionContact(0, None, 1.0, 0.2)]}
    with pytest.raises(ParameterError, match=re.escape(message)) as told:
        steady_state(MassSpringSystem(**given | REFUSED[message]))
    assert "\n" not in str(told.value)


def test_friction_enough_bounds_a_resonance_and_a_common_period_is_found() -> None:
    assert steady_state(oscillator(1.0, 0.9)).stuck_fraction == pytest.approx([0.5356], abs=1e-4)
    shaken = [Spring(0, Motion(amplitude=1.0, angular_frequency=2.0), 1.0, 0.1)]
    state = steady_state(MassSpringSystem(masses=[1.0], springs=shaken, forces={0: Harmonic(0, 1, 3.0)}))
    assert state.orbit.lane.drive.period == pytest.approx(2 * np.pi)
    assert state.orbit.converged


@pytest.mark.parametrize("drive", [HarmonicBase(0.01, 20.0), 2.0])
def test_a_drive_that_is_none_is_refused(drive) -> None:
    chain = Chain.from_ratios(cells=1)
    given = (chain, drive) if drive == 2.0 else (oscillator(0.6, 0.2), drive)
    with pytest.raises(ParameterError, match="drive = "):
        steady_state(*given)


def test_stick_slip_times_of_a_pulse_take_three_lines() -> None:
    """With a sixteenth of the step they are the same but for steps."""
    chain = Chain.from_ratios(cells=2, friction_ratio=0.3)
    pulse = RickerPulse(0.01, 30.0, 0.4)
    motion = simulate(chain, pulse, time_step=1e-3, steps=1000)
    found = transitions(motion)
    finer = transitions(simulate(chain, pulse, time_step=1e-3 / 16, steps=16_000))
    own, other = ([change for change in changes if 0.1 < change.time < 0.55] for changes in (found, finer))
    assert [(change.cell, change.kind) for change in own] == [(change.cell, change.kind) for change in other]
    assert len(own) >= 6
    assert [change.time for change in own] == pytest.approx([change.time for change in other], abs=5e-3)
    assert np.all(stuck_fraction(motion) > 0.2)


def test_a_steady_state_is_a_motion_too_and_what_is_none_is_refused() -> None:
    system, chain = oscillator(0.6, 0.2), Chain.from_ratios(cells=1, friction_ratio=0.3)
    for state in (steady_state(system), steady_state(chain, HarmonicBase.from_ratio(chain, 0.9), with_error_bar=False)):
        assert state.transitions
        assert transitions(state) == state.transitions
        assert stuck_fraction(state) == pytest.approx(state.stuck_fraction, abs=0.01)
    for read in (transitions, stuck_fraction):
        with pytest.raises(ParameterError, match=r"MassSpringSystem.* is no motion; allowed: a steady state"):
            read(system)


def test_a_motion_from_event_to_event_has_the_times_of_its_events() -> None:
    chain = Chain.from_ratios(cells=2, friction_ratio=0.3)
    drive = HarmonicBase.from_ratio(chain, 0.9)
    coarse, fine = (simulate(chain, drive, time_step=1 / n, steps=n, solver="exact") for n in (50, 5000))
    assert transitions(coarse) == transitions(fine)
    with pytest.raises(ParameterError, match="a trajectory without friction_coefficient has no modes; allowed"):
        transitions(steady_state(chain, drive, with_error_bar=False).orbit.trajectory)
