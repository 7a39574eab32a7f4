"""Modes, transitions and energies of contacts, on motions made by hand and on simulated ones."""

import numpy as np
import pytest

from reference_lcp import (
    Chain,
    HarmonicBase,
    Lane,
    Mode,
    PeriodicOrbit,
    Trajectory,
    dissipated_energy,
    steady_state,
    stuck_fraction,
    transitions,
)
from reference_lcp.observables.stick_slip import contact_modes, creep_velocity
from reference_lcp.observables.transmittance import fundamental
from reference_lcp.steady.orbits import OrbitStatus

STEPS = 20


def orbit_with_friction(force, velocity=None) -> PeriodicOrbit:
    """One cell with a bound of 1 N whose friction force over a period is given."""
    chain = Chain(
        cells=1, outer_mass=np.asarray(1.0), inner_mass=np.asarray(1.0), chain_stiffness=np.asarray(1.0),
        inner_stiffness=np.asarray(1.0), normal_force=np.asarray(2.0), friction_coefficient=np.asarray(0.5),
    )  # fmt: skip
    lane = Lane.periodic(chain, HarmonicBase(1.0, 2 * np.pi), STEPS)
    relative = -np.sign(force) if velocity is None else velocity
    velocities = np.column_stack([np.zeros(STEPS), relative])
    trajectory = Trajectory(
        lane.times(0, STEPS), np.zeros((STEPS, 2)), velocities, np.reshape(force, (STEPS, 1)), np.full((STEPS, 1), 2.0)
    )
    return PeriodicOrbit(lane, trajectory, 0.0, 1, OrbitStatus.CONVERGED)


def test_force_below_the_bound_sticks_and_at_the_bound_slips_against_it() -> None:
    orbit = orbit_with_friction(np.repeat([0.5, 1.0, -0.2, -1.0], 5))
    assert contact_modes(orbit)[:, 0].tolist() == [0] * 5 + [-1] * 5 + [0] * 5 + [1] * 5
    assert stuck_fraction(orbit) == pytest.approx([0.5])
    assert [(t.cell, round(t.time * STEPS), t.kind) for t in transitions(orbit)] == [
        (1, 0, Mode.STICK),
        (1, 5, Mode.BACKWARD),
        (1, 10, Mode.STICK),
        (1, 15, Mode.FORWARD),
    ]


def test_stick_of_one_step_is_a_reversal() -> None:
    force = np.array([1.0] * 9 + [0.3] + [-1.0] * 9 + [-0.3])
    orbit = orbit_with_friction(force)
    assert stuck_fraction(orbit) == pytest.approx([0.0])
    assert [(round(t.time * STEPS), t.kind) for t in transitions(orbit)] == [(9, Mode.FORWARD), (19, Mode.BACKWARD)]


def test_stick_across_the_start_of_the_period_is_one_stick() -> None:
    force = np.array([0.1] * 3 + [1.0] * 14 + [0.1] * 3)
    orbit = orbit_with_friction(force)
    assert [(round(t.time * STEPS), t.kind) for t in transitions(orbit)] == [(3, Mode.BACKWARD), (17, Mode.STICK)]


def test_contact_that_never_slips_has_no_transitions() -> None:
    orbit = orbit_with_friction(np.full(STEPS, 0.4))
    assert transitions(orbit) == []
    assert stuck_fraction(orbit) == pytest.approx([1.0])


def test_creep_is_the_largest_velocity_inside_sticks_only() -> None:
    force = np.repeat([0.5, 1.0], 10)
    velocity = np.concatenate([[5.0], np.full(8, 1e-3), [5.0], np.full(10, -1.0)])
    assert creep_velocity(orbit_with_friction(force, velocity)) == pytest.approx([1e-3])


def test_dissipated_energy_is_force_times_slip() -> None:
    orbit = orbit_with_friction(np.repeat([1.0, -1.0], 10), np.repeat([-0.5, 0.5], 10))
    assert dissipated_energy(orbit) == pytest.approx([0.5])


def test_frictionless_contact_never_sticks_and_has_no_transitions() -> None:
    chain = Chain.from_ratios(friction_ratio=0.0)
    steady = steady_state(chain, HarmonicBase.from_ratio(chain, 0.9))
    assert np.all(steady.stuck_fraction == 0)
    assert steady.transitions == []


def test_energy_put_in_by_the_drive_is_what_friction_and_dashpots_take_out() -> None:
    """Over a period of the steady state nothing is stored; the balance closes to the scheme's first order."""
    chain = Chain.from_ratios(friction_ratio=0.3)
    drive = HarmonicBase.from_ratio(chain, 0.62)
    defects = []
    for steps in (800, 1600, 3200):
        orbit = steady_state(chain, drive, steps_per_period=steps).orbit
        run, dt = orbit.trajectory, orbit.lane.time_step
        work = np.sum(drive.load(chain, run.time) * run.velocities[:, 0]) * dt
        dashpots = np.einsum("ti,ij,tj->", run.velocities, chain.damping_matrix, run.velocities) * dt
        defects.append(abs(work - dashpots - dissipated_energy(orbit).sum()) / work)
    assert defects[-1] < 5e-3
    assert defects[0] / defects[2] == pytest.approx(4.0, rel=0.3)


def test_steady_state_is_symmetric_in_time_as_the_drive_is() -> None:
    """Half a period later everything has the other sign: transitions come in pairs of opposite direction."""
    chain = Chain.from_ratios(friction_ratio=0.3)
    steady = steady_state(chain, HarmonicBase.from_ratio(chain, 0.9))
    modes = contact_modes(steady.orbit)
    assert np.mean(modes[:200] == -modes[200:]) > 0.98


def test_fundamental_of_a_sine_is_its_amplitude_and_phase() -> None:
    phase = 2 * np.pi * np.arange(1, 401) / 400
    signal = 3 * np.sin(phase + 0.4) + 0.5 * np.sin(3 * phase) + 2
    assert fundamental(signal) == pytest.approx(3 * np.exp(0.4j))
