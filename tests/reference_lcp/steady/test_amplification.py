"""How far a motion is from its steady state, beside how far one period shows: measured by plain periods."""

import numpy as np
import pytest

from reference_lcp import Chain, HarmonicBase, HarmonicForce
from reference_lcp.chain.preload import Preload
from reference_lcp.chain.simulation import Lane
from reference_lcp.chain.trajectory import State
from reference_lcp.steady.amplification import residual_amplification
from reference_lcp.steady.orbits import PeriodicOrbit, periodic_orbits
from reference_lcp.steady.state_scales import StateScales
from reference_lcp.stepping.euler_compiled import CompiledSimulation


def orbit_of(chain: Chain, frequency_ratio: float, steps: int = 400) -> PeriodicOrbit:
    lane = Lane.periodic(chain, HarmonicBase.from_ratio(chain, frequency_ratio), steps)
    (orbit,) = periodic_orbits(CompiledSimulation([lane]), steps, tolerance=1e-12)
    return orbit


def ratios(orbit: PeriodicOrbit, periods: int, start: State) -> list[float]:
    """Distance from the steady state over the residual, period after period."""
    simulation, steps = CompiledSimulation([orbit.lane]), orbit.trajectory.steps
    scales, state = StateScales([orbit.lane], steps), start
    steady, measured = scales.vectors(orbit.trajectory.end, [0]), []
    for _ in range(periods):
        before, state = state, simulation.advance(state, 0, steps)
        distance, residual = (
            np.max(np.abs(scales.vectors(before, [0]) - other)) for other in (steady, scales.vectors(state, [0]))
        )
        measured.append(float(distance / residual))
    return measured


def test_what_is_left_of_a_free_vibration_is_as_far_off_as_its_slowest_mode_tells() -> None:
    """The base moves at the frequency of one mode: 1 / |1 − exp(λT)| of it, in the limit of small steps."""
    orbit = orbit_of(Chain.from_ratios(cells=1), (np.sqrt(5) - 1) / 2, 1600)
    factor, measured = residual_amplification(orbit), ratios(orbit, 100, State.at_rest(1, 1))
    assert 20 < measured[-1] <= factor * 1.01
    assert factor <= 2 * measured[-1]


@pytest.mark.parametrize("place", [(0.3, 0.67), (0.1, 0.5), (0.3, 0.9), (1.0, 1.05)])
def test_no_motion_near_a_steady_state_with_friction_is_farther_off_than_that(place) -> None:
    """Motions that differ by a hundred thousandth: contacts stick and slip as in the steady state but for moments."""
    friction, eta = place
    orbit, rng = orbit_of(Chain.from_ratios(friction_ratio=friction), eta), np.random.default_rng(3)
    factor, end = residual_amplification(orbit), orbit.trajectory.end
    scale = orbit.lane.drive.displacement_scale(orbit.lane.chain)
    rate = scale * 2 * np.pi / (orbit.trajectory.steps * orbit.lane.time_step)
    # velocities alone: an offset of a cell that stays stuck lasts, and is no error
    near = State(end.positions, end.velocities + 1e-5 * rate * rng.normal(size=end.velocities.shape))
    worst = max(ratios(orbit, 40, near)[5:])
    assert 1 < worst <= 1.5 * factor


def test_residual_of_a_well_damped_chain_is_hardly_amplified() -> None:
    assert residual_amplification(orbit_of(Chain.from_ratios(damping_ratio=0.5, inner_damping_ratio=0.5), 0.1)) < 2.5


def test_residual_of_a_chain_whose_contacts_open_is_amplified_by_some_tens_at_most() -> None:
    """Gaps do not depend on the motion along the row: they are as in the steady state."""
    chain = Chain.from_ratios(friction_ratio=0.3)
    drive = HarmonicBase.from_ratio(chain, 0.5)
    lane = Lane.periodic(chain, drive, 400, Preload.at_multiple(drive, 1.5, 1))
    (orbit,) = periodic_orbits(CompiledSimulation([lane]), 400)
    assert lane.opens
    assert orbit.converged
    assert 1 <= residual_amplification(orbit) < 100


@pytest.mark.parametrize("frequency_ratio", [0.8, 1.3])
def test_offset_of_a_mass_so_heavy_that_it_stands_is_no_error(frequency_ratio) -> None:
    """Den Hartog's oscillator beside a mass a million times as heavy: both may stand elsewhere, and move alike."""
    chain = Chain(
        cells=1, outer_mass=1.0, inner_mass=1e6, chain_stiffness=50.0, inner_stiffness=50.0, normal_force=4.0,
        friction_coefficient=1.0,
    )  # fmt: skip
    lane = Lane.periodic(chain, HarmonicForce(10.0, frequency_ratio * 10), 800)
    (orbit,) = periodic_orbits(CompiledSimulation([lane]), 800)
    assert residual_amplification(orbit) < 10
