"""Every published number is met by the event-driven motion, and friction that is slightly wrong is found by them."""

import csv
import math

import numpy as np
import pytest

from reference_lcp import EventDrivenSystem
from tests.reference_lcp.published.anchors import (
    ANCHORS,
    ROOT,
    brake,
    coupled_clutches,
    exact_values,
    friction_oscillator,
    half_turns,
    rows,
    sdnd100,
    sdnd104,
    sdnd106,
    sdnd106_motion,
    stopped,
    wear_power,
)


@pytest.fixture(scope="module")
def values() -> dict[str, float]:
    return exact_values()


@pytest.mark.parametrize("name", ANCHORS)
def test_exact_motion_meets_the_published_number(name, values) -> None:
    assert values[name] == pytest.approx(ANCHORS[name].value, abs=ANCHORS[name].uncertainty)


def test_table_in_the_documentation_has_these_values_and_no_other(values) -> None:
    with (ROOT / "docs/targets/exact_values.csv").open(encoding="utf-8") as file:
        table = {row["value"]: float(row["exact motion"]) for row in csv.DictReader(file)}
    assert set(table) == set(values) == set(ANCHORS)
    assert table == pytest.approx(values, rel=1e-7, abs=1e-12)


@pytest.mark.parametrize(
    ("name", "wrong"),
    [
        ("sdnd100-1", lambda: half_turns(sdnd100(0.101))[0]),
        ("sdnd100-4", lambda: half_turns(sdnd100(0.101))[3]),
        ("sdnd104-15", lambda: wear_power(sdnd104(15, 0.0999))),
        ("sdnd104-1.5", lambda: wear_power(sdnd104(1.5, 0.0999))),
        ("sdnd104-1.01", lambda: wear_power(sdnd104(1.01, 0.0999))),
        ("sdnd104-0.99", lambda: wear_power(sdnd104(0.99, 0.098))),
        ("sdnd106-2", lambda: sdnd106_motion(sdnd106(static=0.2), 0.15)[0][0]),
        ("brake", lambda: stopped(brake(1.001))),
    ],
)
def test_friction_that_is_slightly_wrong_misses_the_published_number(name, wrong) -> None:
    """By a hundredth, or a thousandth; static friction that is the kinetic one; a brake that presses harder."""
    value, uncertainty = ANCHORS[name]
    assert abs(wrong() - value) > max(3 * uncertainty, 1e-6)


CLUTCH_UNCERTAINTY = 1e-4
"""Of angles [rad] and velocities [rad/s] of about ten, from an integration with a relative tolerance of 1e-6."""

START = {"position": np.zeros(4), "velocity": [10, 0, 0, 0]}


@pytest.mark.parametrize(
    ("clutches", "least", "most"),
    [
        ({}, 0, 1),
        ({"order": (0, 2, 1)}, 1e4, math.inf),
        ({"order": (1, 0, 2)}, 1e4, math.inf),
        ({"coefficient": 0.5005}, 10, math.inf),
        ({"peak": 1.0}, 10, math.inf),
    ],
)
def test_published_clutches_close_one_after_the_other_and_wrong_ones_are_found(clutches, least, most) -> None:
    """Largest distance from 60 rows: angle and velocity of J1, relative velocities of the clutches."""
    time, *published = rows("coupled_clutches")
    motion = EventDrivenSystem(coupled_clutches(**clutches)).motion(**START, times=time)
    own = [motion.positions[:, 0], motion.velocities[:, 0], *motion.relative_velocity.T]
    assert least < np.max(np.abs(np.array(own) - published)) / CLUTCH_UNCERTAINTY < most


SCHEME_UNCERTAINTY = 0.03
"""Of Siconos's x and v: each of seven reversals falls within a step h, which leaves open 2 F h = 0.02."""

OSCILLATOR = {"position": [12.0], "velocity": [6.0]}


@pytest.mark.parametrize(("bound", "right"), [(1.0, True), (1.01, False)])
def test_published_rows_of_the_oscillator_are_those_of_the_exact_motion(bound, right) -> None:
    time, x, v, _ = rows("friction_oscillator")
    motion = EventDrivenSystem(friction_oscillator(bound)).motion(**OSCILLATOR, times=time)
    errors = np.abs(np.array([motion.positions[:, 0] - x, motion.velocities[:, 0] - v]))
    assert bool(np.max(errors) <= SCHEME_UNCERTAINTY) is right


def test_oscillator_turns_where_the_closed_form_does_and_stays_at_the_last() -> None:
    """Each half turn loses two F / k, until F holds what is left: the seventh place is 2 nearer to zero each time."""
    first = math.hypot(13.0, 6.0) - 1.0
    places = (-1.0) ** np.arange(7) * (first - 2 * np.arange(7))
    times = math.atan2(6.0, 13.0) + math.pi * np.arange(7)
    motion = EventDrivenSystem(friction_oscillator()).motion(**OSCILLATOR, times=[*times, 24.0, 100.0])
    assert motion.positions[:7, 0] == pytest.approx(places, abs=1e-12)
    assert motion.velocities[:7, 0] == pytest.approx(0, abs=1e-12)
    assert motion.velocities[-2:, 0].tolist() == [0, 0]
    assert motion.positions[-2:, 0] == pytest.approx(2 - places[-1], abs=1e-12)
