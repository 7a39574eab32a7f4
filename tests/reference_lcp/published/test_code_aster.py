"""Dry friction in the test cases of code_aster: SDND100, SDND104 and SDND106, manuals V5.01.100, 104 and 106."""

import math

import numpy as np
import pytest

from reference_lcp import EventDrivenSystem, simulate_system
from tests.reference_lcp.published.anchors import ANCHORS, sdnd100, sdnd104, sdnd106

SDND106_TIMES = {"sdnd106-1": (0.02, 1), "sdnd106-2": (0.15, 0), "sdnd106-3": (0.15, 1), "sdnd106-5": (0.339965, 1)}
"""When which mass is where it is printed."""


def half_turns(system):
    """Where the mass of SDND100 turns, along y."""
    times = np.pi / 100 * np.arange(1, 5)
    motion = EventDrivenSystem(system).motion(position=[0.85e-3], velocity=[0.0], times=times)
    return motion.positions[:, 0] * math.cos(math.pi / 4)


def published_half_turns():
    return [ANCHORS[f"sdnd100-{k}"] for k in range(1, 5)]


def test_sdnd100_mass_on_a_rough_plane_loses_two_slips_a_half_turn() -> None:
    for value, anchor in zip(half_turns(sdnd100()), published_half_turns(), strict=True):
        assert value == pytest.approx(anchor.value, abs=anchor.uncertainty)


def test_sdnd100_with_a_hundredth_more_friction_turns_elsewhere() -> None:
    wrong = half_turns(sdnd100(0.101))
    assert all(abs(v - a.value) > 10 * a.uncertainty for v, a in zip(wrong, published_half_turns(), strict=True))


def wear_power(system) -> float:
    """N times the mean |ġ_T| from 4 s to 12 s [W]."""
    stretches = EventDrivenSystem(system).stretches(position=[0.0], velocity=[0.0], end=12.0)
    return 10.0 * float(sum(stretch.sliding_distance(4.0, 12.0)[0] for stretch in stretches)) / 8.0


@pytest.mark.parametrize("amplitude", [15, 1.5, 1.01, 0.99])
def test_sdnd104_table_wears_out_what_slips_on_it(amplitude) -> None:
    value, uncertainty = ANCHORS[f"sdnd104-{amplitude:g}"]
    assert wear_power(sdnd104(amplitude)) == pytest.approx(value, abs=uncertainty)


@pytest.mark.parametrize("amplitude", [15, 1.5, 1.01])
def test_sdnd104_with_a_thousandth_less_friction_wears_more(amplitude) -> None:
    value, uncertainty = ANCHORS[f"sdnd104-{amplitude:g}"]
    assert abs(wear_power(sdnd104(amplitude, 0.0999)) - value) > 3 * uncertainty


@pytest.mark.parametrize("name", SDND106_TIMES)
def test_sdnd106_pulled_mass_breaks_its_neighbour_loose(name) -> None:
    time, mass = SDND106_TIMES[name]
    motion = EventDrivenSystem(sdnd106()).motion(position=[0.0, 0.0], velocity=[0.0, 0.0], times=time)
    assert motion.positions[0, mass] == pytest.approx(ANCHORS[name].value, abs=ANCHORS[name].uncertainty)


def test_sdnd106_neighbour_is_at_rest_again_at_the_printed_time() -> None:
    motion = EventDrivenSystem(sdnd106()).motion(position=[0.0, 0.0], velocity=[0.0, 0.0], times=0.339965)
    assert motion.velocities[0, 0] == ANCHORS["sdnd106-4"].value
    assert abs(motion.friction[0, 0]) < 0.3 * 1e4


def test_sdnd106_breaks_loose_when_the_spring_pulls_with_the_static_bound() -> None:
    """cos ω t = 1 − μ_s N / F of the mass that is pulled alone."""
    stretches = EventDrivenSystem(sdnd106()).stretches(position=[0.0, 0.0], velocity=[0.0, 0.0], end=0.1)
    loose = next(stretch.start for stretch in stretches if stretch.modes[0])
    assert loose == pytest.approx(math.acos(1 - 0.3 * 1e4 / 3e3) / math.sqrt(1e4 / 5), rel=1e-13)


def test_sdnd106_without_the_static_coefficient_is_found() -> None:
    motion = EventDrivenSystem(sdnd106(static=0.2)).motion(position=[0.0, 0.0], velocity=[0.0, 0.0], times=0.15)
    assert abs(motion.positions[0, 0] - ANCHORS["sdnd106-2"].value) > 0.02


def test_scheme_breaks_the_neighbour_of_sdnd106_loose_within_a_step() -> None:
    """What is left of its error is of first order: less than the masses move in a step."""
    exact = EventDrivenSystem(sdnd106()).motion(position=[0.0, 0.0], velocity=[0.0, 0.0], times=0.15)
    for steps in (750, 1500, 3000):
        dt = 0.15 / steps
        motion = simulate_system(sdnd106(), position=[0.0, 0.0], velocity=[0.0, 0.0], time_step=dt, steps=steps)
        assert np.max(np.abs(motion.positions[-1] - exact.positions[-1])) < dt * np.max(exact.velocities)
