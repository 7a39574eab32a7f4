"""Masses, springs and friction contacts from event to event, beside the event-driven chain and closed forms."""

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from reference_lcp import (
    Chain,
    CompiledSimulation,
    EventDrivenSystem,
    FrictionContact,
    Harmonic,
    HarmonicBase,
    HarmonicForce,
    Lane,
    MassSpringSystem,
    Piecewise,
    Spring,
    State,
    StillBase,
)
from reference_lcp.errors import ParameterError
from reference_lcp.exact.event_driven import EventDrivenSimulation
from reference_lcp.exact.event_driven_system import EventDrivenBodies, system_of_lane


@pytest.mark.parametrize("friction_ratio", [0.05, 0.2])
def test_a_chain_moves_as_the_event_driven_chain_does(friction_ratio) -> None:
    chain = Chain.from_ratios(cells=3, friction_ratio=friction_ratio)
    drive = HarmonicForce(float(chain.chain_stiffness[0]) * 0.01, 0.8 * chain.resonator_frequency)
    lane = Lane.periodic(chain, drive, 50)
    (expected,) = EventDrivenSimulation([lane]).run(State.at_rest(1, 3), 0, 300)
    solver = EventDrivenSystem(system_of_lane(lane))
    motion = solver.motion(position=np.zeros(6), velocity=np.zeros(6), times=lane.times(0, 300))
    assert motion.positions == pytest.approx(expected.positions, abs=1e-11 * np.max(np.abs(expected.positions)))
    assert motion.friction == pytest.approx(expected.friction, abs=1e-9 * np.max(np.abs(expected.friction)))


def test_a_lane_of_bodies_moves_as_the_event_driven_chain_does_and_may_be_split() -> None:
    """Under a moving base, from any step on."""
    chain = Chain.from_ratios(cells=2, friction_ratio=0.1)
    lane = Lane.periodic(chain, HarmonicBase.from_ratio(chain, 0.8), 50)
    (expected,) = EventDrivenSimulation([lane]).run(State.at_rest(1, 2), 0, 90)
    model = EventDrivenBodies(lane)
    first = model.run(State.at_rest(1, 2), 0, 40)
    second = model.run(first.end, 40, 50)
    positions = np.vstack([first.positions, second.positions])
    assert positions == pytest.approx(expected.positions, abs=1e-11 * np.max(np.abs(expected.positions)))


@pytest.mark.parametrize("simulation", [CompiledSimulation, EventDrivenSimulation])
def test_solvers_with_one_coefficient_refuse_static_friction_of_its_own(simulation) -> None:
    chain = Chain.from_ratios(cells=1, friction_ratio=0.1)
    lane = Lane(chain, HarmonicBase.from_ratio(chain, 0.8), 1e-3, static_ratio=1.5)
    with pytest.raises(ParameterError, match=r"static_ratio = 1\.5: .* one coefficient; allowed: 1"):
        simulation([lane])


def test_static_friction_below_kinetic_friction_is_refused() -> None:
    with pytest.raises(ParameterError, match=r"static_ratio = 0\.9; allowed: >= 1"):
        Lane(Chain.from_ratios(cells=1, friction_ratio=0.1), StillBase(), 1e-3, static_ratio=0.9)


coefficients = st.floats(0.05, 0.5)


def test_a_load_that_reaches_the_bound_while_nothing_else_moves_is_decided_by_its_growth() -> None:
    """All contacts have one bound, and the load on the first mass reaches it while nothing else moves."""
    contacts = [FrictionContact(k, k + 1 if k < 2 else None, Harmonic(2, 1, 1 / 3), 0.5, 0.5) for k in range(3)]
    system = MassSpringSystem(
        masses=np.array([1.0, 0.5, 2.0]),
        springs=[Spring(0, stiffness=3.0), Spring(1, 2, stiffness=2.0)],
        friction=contacts,
        forces={0: Harmonic(0, 2, 1.0), 2: Piecewise({0.0: 0.0, 1.0: -1.5})},
    )
    stretches = list(EventDrivenSystem(system).stretches(position=np.zeros(3), velocity=np.zeros(3), end=6.0))
    slides = next(stretch for stretch in stretches if np.any(stretch.modes != 0))
    # 2 sin t = 0.5 (2 + sin(t / 3)), when the load passes what the first contact holds alone
    assert 2 * np.sin(slides.start) == pytest.approx(0.5 * (2 + np.sin(slides.start / 3)), abs=1e-9)


@settings(max_examples=25, deadline=None)
@given(
    kinetic=st.lists(coefficients, min_size=3, max_size=3),
    extra=st.lists(st.floats(0, 0.5), min_size=3, max_size=3),
    frequency=st.floats(0.5, 6),
)
def test_law_of_friction_holds_in_every_stretch_of_coupled_contacts(kinetic, extra, frequency) -> None:
    """|λ_T| <= μ_s N at rest, −μ_k N sign ġ_T in motion, and nothing jumps but the friction."""
    assume(min(abs(np.diff(sorted(kinetic)))) > 1e-6)  # equal bounds may be reached together, which is refused
    contacts = [
        FrictionContact(k, k + 1 if k < 2 else None, Harmonic(2, 1, frequency / 3), mu, mu * (1 + more))
        for k, (mu, more) in enumerate(zip(kinetic, extra, strict=True))
    ]
    system = MassSpringSystem(
        masses=np.array([1.0, 0.5, 2.0]),
        springs=[Spring(0, stiffness=3.0), Spring(1, 2, stiffness=2.0)],
        friction=contacts,
        forces={0: Harmonic(0, 2, frequency), 2: Piecewise({0.0: 0.0, 1.0: -1.5})},
    )
    before = np.zeros(6)
    for stretch in EventDrivenSystem(system).stretches(position=np.zeros(3), velocity=np.zeros(3), end=6.0):
        times = np.linspace(stretch.start, stretch.end, 7)
        motion, normal, friction, slip = (
            stretch.values(series, times)
            for series in (stretch.motion, stretch.normal_force, stretch.friction, stretch.slip)
        )
        assert motion[0] == pytest.approx(before, abs=1e-9)
        before = motion[-1]
        rest = stretch.modes == 0
        held = np.array([mu * (1 + more) for mu, more in zip(kinetic, extra, strict=True)]) * normal
        assert np.all(np.abs(friction[:, rest]) <= held[:, rest] * (1 + 1e-9))
        assert np.all(stretch.modes * slip >= -1e-9)
        assert friction[:, ~rest] == pytest.approx(-(stretch.modes * np.array(kinetic) * normal)[:, ~rest], abs=1e-12)


def test_sliding_distance_of_a_block_that_swings_to_rest_adds_up_all_half_swings() -> None:
    """From 8.5 mm, each half swing ends 2 F / k = 2 mm nearer, on the other side, until 0.5 mm are held."""
    rough = FrictionContact(0, normal_force=1.0, coefficient=0.1)
    block = MassSpringSystem(masses=np.array([1.0]), springs=[Spring(0, stiffness=100.0)], friction=[rough])
    stretches = list(EventDrivenSystem(block).stretches(position=[8.5e-3], velocity=[0.0], end=2.0))
    assert sum(stretch.sliding_distance(0, 2) for stretch in stretches) == pytest.approx([36e-3], rel=1e-12)
    assert sum(stretch.sliding_distance(np.pi / 10, 2) for stretch in stretches) == pytest.approx([21e-3], rel=1e-12)


def test_a_normal_force_that_becomes_negative_is_refused_with_its_time() -> None:
    contact = FrictionContact(0, normal_force=Harmonic(1, 2, 1), coefficient=0.1)
    solver = EventDrivenSystem(MassSpringSystem(masses=np.array([1.0]), friction=[contact]))
    with pytest.raises(ParameterError, match=r"normal force of contact 0 = -.* N .*allowed: >= 0"):
        solver.motion(position=[0.0], velocity=[10.0], times=6.0)


@pytest.mark.parametrize("times", [[2.0, 1.0], [0.0, 1.0]])
def test_times_that_do_not_rise_from_zero_are_refused(times) -> None:
    solver = EventDrivenSystem(MassSpringSystem(masses=np.array([1.0])))
    with pytest.raises(ParameterError, match="times"):
        solver.motion(position=[0.0], velocity=[0.0], times=times)
