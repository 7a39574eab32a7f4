"""Steady states of chains with inclined contacts: linear limits, symmetry, lift-off, and one that repels."""

import cmath
import dataclasses
import functools
import math
import re
from pathlib import Path

import numpy as np
import pytest

from reference_lcp import Chain, HarmonicBase, Lane, Preload, State
from reference_lcp.chain.linear_response import frictionless_response, sliding_mass, stuck_basis, stuck_response
from reference_lcp.chain.simulation import PeriodicOrbit
from reference_lcp.observables.stick_slip import largest_gap, open_fraction
from reference_lcp.one_call import SteadyState
from reference_lcp.schemes.euler import euler_simulation
from reference_lcp.steady.attraction import largest_multiplier
from reference_lcp.steady.orbits import FROM_REST, LONGEST_MULTIPLE, periodic_orbits
from tests.reference_lcp.cases import driven

AMPLITUDE, STEPS, CELLS = 0.01, 400, 7
INCLINATION = math.radians(12)
CERTIFIED = 1e-8
LINEAR_RESIDUAL = 1e-11
"""Residual to which linear motions are searched; times the amplification of 300, and the few units of the response."""

LINEAR_ERROR = 1e-8


def multiplier_of(found: PeriodicOrbit) -> float:
    return largest_multiplier(euler_simulation([found.lane]), found)


@functools.cache
def orbit(
    friction_ratio: float,
    frequency_ratio: float,
    degrees: float,
    *,
    modulation: float = 0.0,
    mu: float | None = None,
    steps: int = STEPS,
    tolerance: float = CERTIFIED,
    longest_multiple: int = LONGEST_MULTIPLE,
) -> PeriodicOrbit:
    chain = Chain.from_ratios(friction_ratio=friction_ratio, base_amplitude=AMPLITUDE)
    if mu is not None:
        chain = dataclasses.replace(chain, friction_coefficient=np.full(CELLS, mu))
    drive = HarmonicBase.from_ratio(chain, frequency_ratio, AMPLITUDE)
    preload = Preload.at_multiple(drive, modulation, 2)
    lane = Lane.periodic(chain, drive, steps, preload, math.radians(degrees))
    simulation = euler_simulation([lane])
    return periodic_orbits(simulation, steps, tolerance=tolerance, longest_multiple=longest_multiple)[0]


def transmittance(found: PeriodicOrbit) -> complex:
    state = SteadyState.of(found)
    return cmath.rect(10 ** (state.transmittance_db / 20), state.phase)


def last_over_base(response) -> complex:
    return complex(response[CELLS - 1]) / AMPLITUDE


def scheme_response(lane: Lane, basis, inclination: float) -> complex:
    """Closed form of the linear scheme: with z = exp(iωΔt), (z − 1)² / (z Δt²) M + (1 − 1/z) / Δt C + K."""
    chain, drive, dt = lane.chain, lane.drive, lane.time_step
    z = cmath.exp(1j * drive.angular_frequency * dt)
    dynamic = (
        (z - 1) ** 2 / (z * dt**2) * sliding_mass(chain, inclination)
        + (1 - 1 / z) / dt * chain.damping_matrix
        + chain.stiffness_matrix
    )
    force = np.zeros(2 * CELLS, dtype=complex)
    force[0] = (chain.chain_stiffness[0] + 1j * drive.angular_frequency * chain.chain_damping[0]) * drive.amplitude
    return last_over_base(basis @ np.linalg.solve(basis.T @ dynamic @ basis, basis.T @ force))


def test_without_friction_the_steady_state_is_the_closed_form_of_the_linear_scheme() -> None:
    free = orbit(50.0, 0.7, 12, mu=0.0, tolerance=LINEAR_RESIDUAL)
    expected = scheme_response(free.lane, np.eye(2 * CELLS), INCLINATION)
    assert transmittance(free) == pytest.approx(expected, abs=LINEAR_ERROR)
    assert largest_gap(free).max() < 1e-12 * AMPLITUDE
    flat = scheme_response(free.lane, np.eye(2 * CELLS), 0.0)
    assert abs(flat - expected) > 1e-3, "the inclination matters"


def test_contacts_that_stay_stuck_are_the_closed_form_of_the_linear_scheme() -> None:
    stuck = orbit(50.0, 0.5, 12, tolerance=LINEAR_RESIDUAL)
    expected = scheme_response(stuck.lane, stuck_basis(stuck.lane.chain), INCLINATION)
    assert transmittance(stuck) == pytest.approx(expected, abs=LINEAR_ERROR)


@pytest.mark.parametrize("free", [True, False], ids=["without friction", "stuck"])
def test_the_linear_scheme_tends_to_the_closed_form_at_first_order(free) -> None:
    chain, drive = driven(0.5, friction_ratio=50.0, base_amplitude=AMPLITUDE)
    preload = Preload.at_multiple(drive, 0.0, 2)
    exact = frictionless_response(chain, drive, INCLINATION) if free else stuck_response(chain, drive)
    basis = np.eye(2 * CELLS) if free else stuck_basis(chain)
    lanes = (Lane.periodic(chain, drive, steps, preload, INCLINATION) for steps in (8000, 16000))
    coarse, fine = (abs(scheme_response(lane, basis, INCLINATION) - last_over_base(exact)) for lane in lanes)
    assert coarse / fine == pytest.approx(2, rel=0.05)
    assert fine < 1e-3


def test_little_friction_changes_the_closed_form_in_proportion() -> None:
    free, *rubbed = (transmittance(orbit(50.0, 0.5, 12, mu=mu, longest_multiple=1)) for mu in (0.0, 1e-5, 1e-6))
    changes = [abs(response - free) for response in rubbed]
    assert changes[0] / changes[1] == pytest.approx(10, rel=0.05)


@pytest.mark.parametrize(("modulation", "degrees"), [(0.0, 12), (0.5, 12), (0.0, 25), (1.5, 12)])
def test_opposite_inclinations_have_the_same_transmittance(modulation, degrees) -> None:
    """The mirrored chain, half a period later: N(t) at 2 ω is then the same."""
    one_way, other_way = (
        orbit(0.3, 0.7, sign * degrees, modulation=modulation, longest_multiple=1) for sign in (1, -1)
    )
    assert one_way.converged
    assert other_way.converged
    assert abs(transmittance(one_way)) == pytest.approx(abs(transmittance(other_way)), abs=1e-5)
    half = STEPS // 2
    mirrored = -np.roll(other_way.trajectory.outer_positions, half, axis=0)
    assert one_way.trajectory.outer_positions == pytest.approx(mirrored, abs=1e-5 * AMPLITUDE)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("point", "opens"),
    [
        ((0.1, 0.7, 12, 0.0), False),
        ((0.3, 0.7, 12, 0.0), False),
        ((0.3, 0.7, 25, 0.0), False),
        ((0.1, 0.7, 25, 0.0), True),
        ((0.3, 0.9, -12, 0.5), False),
        ((0.3, 0.7, 12, 1.5), True),
    ],
    ids=str,
)
def test_steady_states_are_certified_and_attract(point, opens) -> None:
    """Also of contacts that the motion alone opens, without an actuator that pulls."""
    *place, modulation = point
    found = orbit(*place, modulation=modulation)
    assert found.converged
    assert found.residual <= CERTIFIED
    assert multiplier_of(found) < 1
    assert found.reason.startswith("reached from rest; attracts, largest multiplier 0.99")
    assert found.periods > FROM_REST, "of the motion from rest, and of two searches"
    assert bool(np.any(open_fraction(found) > 0.1)) is opens


def test_certified_steady_state_may_repel_where_normal_forces_depend_on_the_motion() -> None:
    """Friction with a given normal force is monotone: no multiplier is above one there. Here a small offset grows."""
    found = orbit(0.1, 0.9, 25, longest_multiple=1)
    assert found.converged
    growth = multiplier_of(found)
    assert growth > 1.5
    end, simulation = found.trajectory.end, euler_simulation([found.lane])
    offset = np.zeros_like(end.positions)
    offset[0, CELLS - 1] = 1e-4 * AMPLITUDE
    moved = State(end.positions + offset, end.velocities, end.internal_state)
    after = simulation.advance(moved, 0, 30 * STEPS)
    assert np.max(np.abs(after.positions - end.positions)) > 100 * np.max(offset)


PHYSICS = (Path(__file__).parents[3] / "docs/physics.md").read_text(encoding="utf-8").replace("−", "-")
ROWS = re.findall(
    r"^\| ([\d.]+), ([\d.]+), ([+-]?\d+)°, ([\d.]+).*? \| (\d+) \| (\S+) \| ([\d.]+)", PHYSICS, re.MULTILINE
)


def test_all_rows_of_the_published_table_are_read() -> None:
    assert len(ROWS) == 8


@pytest.mark.slow
@pytest.mark.parametrize("row", ROWS, ids=" ".join)
def test_published_steady_states_are_what_the_search_finds(row: tuple[str, ...]) -> None:
    friction, eta, degrees, modulation, steps, level, multiplier = row
    place = float(friction), float(eta), float(degrees)
    found = orbit(*place, modulation=float(modulation), steps=int(steps), longest_multiple=1)
    assert found.converged
    assert f"{SteadyState.of(found).transmittance_db:.3f}" == level
    growth = multiplier_of(found)
    assert growth == pytest.approx(float(multiplier), abs=0.5 * 10.0 ** -len(multiplier.partition(".")[2]))


@pytest.mark.slow
def test_search_from_rest_names_what_no_motion_from_rest_reaches() -> None:
    found = orbit(0.1, 0.9, 25)
    assert not found.converged
    assert "which repels, largest multiplier 1.8" in found.reason


@pytest.mark.slow
def test_motion_from_rest_reaches_another_attractor_than_the_steady_state() -> None:
    """A certified steady state attracts what is near; from rest, the chain moves with twice the drive's period."""
    chain = Chain.from_ratios(
        cells=5, mass_ratio=0.706, stiffness_ratio=1.371, damping_ratio=0.0068, friction_ratio=0.1675
    )
    drive = HarmonicBase.from_ratio(chain, 1.549)
    lane = Lane.periodic(chain, drive, STEPS, Preload.at_multiple(drive, 0.0, 2), math.radians(8.8))
    simulation = euler_simulation([lane])
    (fixed,) = periodic_orbits(simulation, STEPS, longest_multiple=1)
    assert fixed.converged
    assert SteadyState.of(fixed).transmittance_db == pytest.approx(-39.33, abs=0.01)
    (found,) = periodic_orbits(simulation, STEPS)
    assert not found.converged
    assert found.multiple == 2
    assert SteadyState.of(found).transmittance_db == pytest.approx(-21.6, abs=0.5)
    assert "steady state at -39.33" in found.reason


def test_multiplier_is_that_of_the_mirrored_motion_half_a_period_later() -> None:
    """A contact has landed in the last step there: its gap is zero, and its rate is not."""
    found = orbit(0.3, 0.5, -12, modulation=1.5, steps=800, longest_multiple=1)
    lane = dataclasses.replace(found.lane, inclination=-found.lane.inclination)
    half = euler_simulation([found.lane]).advance(found.trajectory.end, 0, 400)
    (trajectory,) = euler_simulation([lane]).run(State(-half.positions, -half.velocities, half.internal_state), 0, 800)
    mirrored = dataclasses.replace(found, lane=lane, trajectory=trajectory)
    gaps, rates = trajectory.end.normal_state(CELLS)
    assert np.any((gaps < 1e-12 * AMPLITUDE) & (np.abs(rates) > 1e-3 * AMPLITUDE))
    assert multiplier_of(mirrored) == pytest.approx(multiplier_of(found), abs=1e-4)
