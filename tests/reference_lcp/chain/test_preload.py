"""Normal forces, constant or changing in time: against equation (7) in full, and against the flight in closed form."""

import math
from itertools import pairwise

import numpy as np
import pytest

from reference_lcp import (
    CompiledSimulation,
    FrictionalStep,
    Lane,
    Mode,
    ParameterError,
    Preload,
    State,
    periodic_orbits,
    stuck_fraction,
    transitions,
)
from reference_lcp.chain.preload import Flight
from reference_lcp.exact.event_driven import EventDrivenSimulation
from reference_lcp.observables.stick_slip import contact_modes, largest_gap, open_fraction
from reference_lcp.schemes.euler import LemkeSimulation
from tests.reference_lcp.cases import driven, moved, orbit_of

AMPLITUDE = 0.01
STEPS = 400
ROUND_OFF = 1e-12
"""Largest difference of two ways to compute one scheme, over U0 or U0 ω: a few thousand roundings."""


def lane_of(modulation, multiple=1, *, phase=0.0, friction=0.3, frequency=0.9, steps=STEPS):
    chain, drive = driven(frequency, friction_ratio=friction, base_amplitude=AMPLITUDE)
    preload = None if modulation is None else Preload.at_multiple(drive, modulation, multiple, phase)
    return Lane.periodic(chain, drive, steps, preload)


class ResolvedLane:
    """3n freedoms, u_1 … u_n, v_1 … v_n, y_1 … y_n [m], all zero at rest with closed contacts, and n contacts.

    The lane has a preload or none.
    """

    def __init__(self, lane: Lane):
        self.lane, n = lane, lane.chain.cells
        none, identity = np.zeros((n, n)), np.eye(n)
        self.freedoms, self.contacts = 3 * n, n
        masses = [lane.chain.outer_mass, lane.chain.inner_mass, lane.chain.inner_mass]
        self.mass_matrix = np.diag(np.concatenate(masses))
        self.normal_directions = np.vstack([none, none, identity])
        self.tangential_directions = np.vstack([-identity, identity, none])

    def step(self, time, position, velocity, time_step) -> FrictionalStep:
        chain, along, preload = self.lane.chain, 2 * self.contacts, self.lane.preload
        factor = 1.0 if preload is None else preload.factor(np.asarray(time))
        force = -self.normal_directions @ (chain.normal_force * factor)
        force[:along] -= chain.stiffness_matrix @ position[:along] + chain.damping_matrix @ velocity[:along]
        force[0] += float(self.lane.drive.load(chain, np.asarray(time)))
        return FrictionalStep(
            mass_matrix=self.mass_matrix, force=force, velocity=velocity, time_step=time_step,
            normal_directions=self.normal_directions, tangential_directions=self.tangential_directions,
            normal_gap=self.normal_directions.T @ position,
            relative_velocity=self.tangential_directions.T @ velocity,
            friction_coefficient=chain.friction_coefficient,
        )  # fmt: skip


@pytest.mark.parametrize(
    ("modulation", "multiple", "solver"),
    [
        *((*case, CompiledSimulation) for case in [(None, 1), (0.5, 2), (1.0, 2), (1.5, 1), (2.5, 2)]),
        *((*case, LemkeSimulation) for case in [(0.5, 2), (1.5, 1)]),
    ],
)
def test_modulated_chain_equals_equation_7_with_the_normal_direction_resolved(modulation, multiple, solver) -> None:
    steps = 2 * 200
    lane = lane_of(modulation, multiple, phase=0.4, steps=steps // 2)
    full = moved(ResolvedLane(lane), lane.time_step, steps)
    along = solver([lane]).run(State.at_rest(1, 7), 0, steps)[0]
    slipping = np.abs(full.relative_velocity) > 1e-9 * AMPLITUDE * lane.drive.angular_frequency
    assert 0.05 < np.mean(slipping) < 0.95, "contacts stick and slip"
    speed = AMPLITUDE * lane.drive.angular_frequency
    force = lane.chain.normal_force[0] * 4 / lane.time_step / lane.drive.angular_frequency  # of an impact
    assert np.max(np.abs(along.positions - full.positions[:, :14])) <= ROUND_OFF * AMPLITUDE
    assert np.max(np.abs(along.velocities - full.velocities[:, :14])) <= ROUND_OFF * speed
    assert np.max(np.abs(along.normal_force - full.normal_force)) <= ROUND_OFF * force
    assert np.max(np.abs(along.friction - full.friction)) <= 1e-10 * lane.chain.friction_bound[0]
    gap = np.zeros((steps, 7)) if along.normal_gap is None else along.normal_gap
    assert np.max(np.abs(gap - full.positions[:, 14:])) <= ROUND_OFF * max(1.0, 10 * np.max(gap))


@pytest.mark.parametrize(("modulation", "multiple"), [(1.1, 1), (1.5, 1), (1.5, 2), (3.0, 1)])
def test_flight_of_the_scheme_tends_to_the_exact_flight(modulation, multiple) -> None:
    """Part of the period in the air, and the highest point: N(t) integrated twice."""
    for steps in (400, 1600):
        lane = lane_of(modulation, multiple, steps=steps)
        orbit = orbit_of(lane, tolerance=1e-6)
        flight = Flight.of(lane.preload)
        scale = lane.chain.normal_force / lane.chain.inner_mass / lane.preload.angular_frequency**2
        # Lift-off and landing are each met to a step, in every cycle; the highest point to a step's fall from it.
        assert np.all(np.abs(open_fraction(orbit) - flight.open_fraction) * steps <= 2 * multiple)
        step_phase = lane.preload.angular_frequency * lane.time_step
        assert np.all(np.abs(largest_gap(orbit) / scale - flight.highest) <= step_phase**2)


def test_open_contact_feels_no_friction_and_is_no_stick() -> None:
    orbit = orbit_of(lane_of(1.5, friction=1.0))
    assert orbit.converged
    opened = orbit.trajectory.normal_force == 0
    assert 0.3 < np.mean(opened) < 0.7
    assert np.all(orbit.trajectory.friction[opened] == 0)
    modes = contact_modes(orbit)
    assert np.all(modes[opened] == np.sign(orbit.trajectory.relative_velocity)[opened])
    assert np.all(stuck_fraction(orbit) <= 1 - open_fraction(orbit))
    assert np.max(stuck_fraction(orbit)) > 0.2


@pytest.mark.parametrize(("modulation", "friction", "frequency"), [(1.5, 0.3, 0.9), (2.5, 0.1, 0.6)])
def test_impact_of_a_landing_is_no_stick(modulation, friction, frequency) -> None:
    """It is over in no time: with any step, the shortest stick of these motions lasts a twentieth of a period."""
    counts = []
    for steps in (400, 1600):
        orbit = orbit_of(lane_of(modulation, 2, friction=friction, frequency=frequency, steps=steps))
        pairs = [(one, other) for one, other in pairwise(transitions(orbit)) if one.cell == other.cell]
        sticks = [other.time - one.time for one, other in pairs if one.kind is Mode.STICK]
        assert min(sticks) > orbit.lane.drive.period / 20
        counts.append([(change.cell, change.kind) for change in transitions(orbit)])
    assert counts[0] == counts[1]


@pytest.mark.parametrize("solver", [CompiledSimulation, LemkeSimulation])
def test_lanes_in_a_batch_and_runs_split_in_flight_are_bitwise_what_they_are_alone_and_whole(solver) -> None:
    lanes = [lane_of(1.5, steps=100), lane_of(None, steps=100), lane_of(2.5, 2, phase=1.0, steps=100)]
    together = solver(lanes)
    half = together.advance(State.at_rest(3, 7), 0, 75)
    assert np.all(half.internal_state[0, :7] > 0), "the split is in a flight"
    second = together.run(half, 75, 25)
    for number, (lane, whole) in enumerate(zip(lanes, together.run(State.at_rest(3, 7), 0, 100), strict=True)):
        alone = solver([lane]).run(State.at_rest(1, 7), 0, 100)[0]
        for name in ("positions", "normal_force", "friction"):
            assert np.array_equal(getattr(alone, name), getattr(whole, name))
            assert np.array_equal(getattr(second[number], name), getattr(whole, name)[75:])


def test_flights_repeat_up_to_the_modulation_at_which_they_last_a_cycle() -> None:
    nearly = math.sqrt(1 + math.pi**2) - 1e-6
    assert Flight.of(Preload(modulation=nearly, angular_frequency=1.0)).open_fraction == pytest.approx(1, abs=1e-3)
    for modulation in (1.0, 3.3):
        with pytest.raises(ParameterError, match=f"modulation = {modulation:g}"):
            Flight.of(Preload(modulation=modulation, angular_frequency=1.0))


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (lambda: Preload(modulation=-0.1, angular_frequency=1.0), "modulation = -0.1"),
        (lambda: Preload(modulation=0.5, angular_frequency=0.0), "modulation_frequency = 0"),
        (lambda: Preload(modulation=0.5, angular_frequency=1.0, phase=math.inf), "modulation_phase = inf"),
        (
            lambda: periodic_orbits(CompiledSimulation([lane_of(0.5, 1.5)]), STEPS),
            r"the preload has 1\.5 times the drive's frequency; allowed: whole",
        ),
        (lambda: EventDrivenSimulation([lane_of(0.5)]), "cannot represent a modulated normal force"),
    ],
)
def test_preload_that_is_impossible_or_cannot_be_computed_is_refused(make, message) -> None:
    with pytest.raises(ParameterError, match=message):
        make()
