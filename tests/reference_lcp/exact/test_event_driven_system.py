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
    RickerPulse,
    Spring,
    State,
    StillBase,
)
from reference_lcp.errors import ParameterError
from reference_lcp.exact.event_driven import EventDrivenSimulation
from reference_lcp.exact.event_driven_system import EventDrivenBodies, SystemStretch


@pytest.mark.parametrize("make", [HarmonicBase, HarmonicForce])
def test_a_lane_of_bodies_moves_as_the_event_driven_chain_does_and_may_be_split(make) -> None:
    chain = Chain.from_ratios(cells=3, friction_ratio=0.1, base_amplitude=0.01)
    lane = Lane.periodic(chain, make(0.01 if make is HarmonicBase else 10.0, 0.8 * chain.resonator_frequency), 50)
    (expected,) = EventDrivenSimulation([lane]).run(State.at_rest(1, 3), 0, 300)
    first = EventDrivenBodies(lane).run(State.at_rest(1, 3), 0, 130)
    second = EventDrivenBodies(lane).run(first.end, 130, 170)
    for name, tolerance in (("positions", 1e-11), ("friction", 1e-9)):
        whole, parts = getattr(expected, name), [getattr(first, name), getattr(second, name)]
        assert np.vstack(parts) == pytest.approx(whole, abs=tolerance * np.max(np.abs(whole)))


def three_blocks(kinetic, static, frequency) -> EventDrivenSystem:
    """Blocks in a row that rub on each other, the last one on the ground; the first and the last one are pulled."""
    contacts = [
        FrictionContact(k, k + 1 if k < 2 else None, Harmonic(2, 1, frequency / 3), *coefficients)
        for k, coefficients in enumerate(zip(kinetic, static, strict=True))
    ]
    blocks = MassSpringSystem(
        masses=np.array([1.0, 0.5, 2.0]),
        springs=[Spring(0, stiffness=3.0), Spring(1, 2, stiffness=2.0)],
        friction=contacts,
        forces={0: Harmonic(0, 2, frequency), 2: Piecewise({0.0: 0.0, 1.0: -1.5})},
    )
    return EventDrivenSystem(blocks)


def stretches_of(solver: EventDrivenSystem) -> list[SystemStretch]:
    """Six seconds from rest."""
    return list(solver.stretches(position=np.zeros(3), velocity=np.zeros(3), end=6.0))


def test_a_load_that_reaches_the_bound_while_nothing_else_moves_is_decided_by_its_growth() -> None:
    """All contacts have one bound, and the load on the first mass reaches it while nothing else moves."""
    stretches = stretches_of(three_blocks([0.5] * 3, [0.5] * 3, 1.0))
    slides = next(stretch for stretch in stretches if np.any(stretch.modes != 0))
    # 2 sin t = 0.5 (2 + sin(t / 3)), when the load passes what the first contact holds alone
    assert 2 * np.sin(slides.start) == pytest.approx(0.5 * (2 + np.sin(slides.start / 3)), abs=1e-9)


@settings(max_examples=15, deadline=None)
@given(
    kinetic=st.lists(st.floats(0.05, 0.5), min_size=3, max_size=3),
    extra=st.lists(st.floats(0, 0.5), min_size=3, max_size=3),
    frequency=st.floats(0.5, 6),
)
def test_law_of_friction_holds_in_every_stretch_of_coupled_contacts(kinetic, extra, frequency) -> None:
    """|λ_T| <= μ_s N at rest, −μ_k N sign ġ_T in motion, and nothing jumps but the friction."""
    assume(min(abs(np.diff(sorted(kinetic)))) > 1e-6)  # equal bounds may be reached together, which is refused
    static = [mu * (1 + more) for mu, more in zip(kinetic, extra, strict=True)]
    before = np.zeros(6)
    for stretch in stretches_of(three_blocks(kinetic, static, frequency)):
        times = np.linspace(stretch.start, stretch.end, 7)
        motion, normal, friction, slip = (
            stretch.values(series, times)
            for series in (stretch.coefficients, stretch.normal_force, stretch.friction, stretch.slip)
        )
        assert motion[0] == pytest.approx(before, abs=1e-9)
        before = motion[-1]
        rest = stretch.modes == 0
        held = np.array(static) * normal
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


def lane_with(static_ratio: float) -> Lane:
    return Lane(Chain.from_ratios(cells=1, friction_ratio=0.1), StillBase(), 1e-3, static_ratio=static_ratio)


def of_one_mass(**contact) -> EventDrivenSystem:
    friction = [FrictionContact(0, coefficient=0.1, **contact)]
    return EventDrivenSystem(MassSpringSystem(masses=np.array([1.0]), friction=friction))


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (lambda: CompiledSimulation([lane_with(1.5)]), r"static_ratio = 1\.5: .* one coefficient; allowed: 1"),
        (lambda: EventDrivenSimulation([lane_with(1.5)]), r"static_ratio = 1\.5: .* one coefficient; allowed: 1"),
        (
            lambda: EventDrivenSimulation([Lane(Chain.from_ratios(), RickerPulse(0.01, 30.0, 0.4), 1e-3)]),
            "RickerPulse has no event-driven solution; allowed: HarmonicBase",
        ),
        (lambda: lane_with(0.9), r"static_ratio = 0\.9; allowed: >= 1"),
        (
            lambda: of_one_mass(normal_force=Harmonic(1, 2, 1)).motion(position=[0.0], velocity=[10.0], times=6.0),
            r"normal force of contact 0 = -.* N .*allowed: >= 0",
        ),
        (lambda: of_one_mass().motion(position=[0.0], velocity=[0.0], times=[2.0, 1.0]), "times do not rise"),
        (lambda: of_one_mass().motion(position=[0.0], velocity=[0.0], times=[0.0, 1.0]), "times = 0"),
    ],
)
def test_what_has_no_event_driven_motion_is_refused(make, message) -> None:
    with pytest.raises(ParameterError, match=message):
        make()
