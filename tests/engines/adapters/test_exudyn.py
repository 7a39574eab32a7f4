"""Exudyn: its two friction laws, its restarts and its units."""

import numpy as np
import pytest

from multibody_xval.engines.exudyn import ExudynBristle, ExudynRegularised
from multibody_xval.engines.exudyn.joint import STATIC_DECAY_PER_KICK, static_decays
from multibody_xval.engines.interface.engine import Engine
from multibody_xval.engines.shared.script_units import SI
from reference_lcp.chain.drives import Drive, HarmonicBase
from reference_lcp.chain.mass_in_mass import Chain
from reference_lcp.chain.simulation import Lane
from reference_lcp.chain.trajectory import State
from reference_lcp.errors import ParameterError
from reference_lcp.observables.transmittance import decibel, transmittance
from reference_lcp.one_call import exact_steady_state
from reference_lcp.steady.orbits import periodic_orbits
from tests.engines.scheme_oracle import AMPLITUDE, STEPS, built_with, lane_of, random_state

pytestmark = pytest.mark.needs("exudyn-bristle")

both_laws = pytest.mark.parametrize("engine", [ExudynRegularised(), ExudynBristle()], ids=lambda engine: engine.name)


def distance(one: State, other: State, lane: Lane) -> float:
    """Largest difference of positions over U0 and of velocities over U0 ω_r."""
    speed = AMPLITUDE * lane.chain.resonator_frequency
    return float(
        max(
            np.max(np.abs(one.positions - other.positions)) / AMPLITUDE,
            np.max(np.abs(one.velocities - other.velocities)) / speed,
        )
    )


class Sampled:
    """A drive that the engine does not know, with the load of another."""

    def __init__(self, drive: Drive):
        self._drive = drive
        self.parameters = drive.parameters
        self.displacement_scale = drive.displacement_scale
        self.load = drive.load


def sampled(lane: Lane) -> Lane:
    """Give the lane a drive whose load Exudyn takes from a table."""
    return Lane(lane.chain, Sampled(lane.drive), lane.time_step)


@both_laws
def test_rows_lie_at_the_ends_of_the_steps(engine: Engine) -> None:
    lane = lane_of(0.3, 0.6)
    simulation = engine.build([lane])
    start = 1000 * STEPS
    (trajectory,) = simulation.run(random_state(), start, 2 * STEPS)
    middle = simulation.advance(random_state(), start, 123)
    assert trajectory.steps == 2 * STEPS
    np.testing.assert_allclose(trajectory.positions[122], middle.positions[0], rtol=0, atol=1e-9 * AMPLITUDE)


@both_laws
@pytest.mark.parametrize("begin", [0, 37])
def test_any_drive_loads_cell_1_as_its_function_says(engine: Engine, begin: int) -> None:
    lane = lane_of(0.3, 0.6)
    ends = [engine.build([each]).advance(State.at_rest(1, 7), begin, STEPS) for each in (lane, sampled(lane))]
    assert np.max(np.abs(ends[0].positions)) > 0.1 * AMPLITUDE
    assert distance(ends[0], ends[1], lane) < 1e-9


def test_fresh_bristle_carries_the_load_that_it_meets() -> None:
    """A stuck contact that starts without internal state must not let go."""
    lane = lane_of(5.0, 0.6)
    simulation = ExudynBristle().build([lane])
    state = simulation.advance(State.at_rest(1, 7), 0, STEPS)
    forgotten = State(state.positions, state.velocities)
    kept, lost = (simulation.run(start, 0, STEPS)[0] for start in (state, forgotten))
    difference = np.max(np.abs(kept.positions - lost.positions)) / AMPLITUDE
    assert 0 < difference < 1e-3


def test_a_disc_moves_as_the_connector_of_the_same_zone_does() -> None:
    """Two implementations of one law: what differs is the integration across the corners of the zone."""
    lane = lane_of(0.3, 0.9)
    zone = {"zone": 0.01, "substeps": 4, "zone_per_kick": 0.0}
    (pressed,), (joined,) = (
        built_with(ExudynRegularised(), lane, formulation, **zone).run(random_state(), 0, STEPS)
        for formulation in ("contact", "joint")
    )
    assert np.max(np.abs(pressed.positions - joined.positions)) < 1e-3 * AMPLITUDE
    assert pressed.normal_force == pytest.approx(np.broadcast_to(lane.chain.normal_force, (STEPS, 7)), rel=1e-6)


def largest_creep(engine: Engine, lane: Lane, preset: str) -> float:
    """Largest relative velocity from rest under friction that no motion overcomes, over U0 ω."""
    (trajectory,) = engine.build([lane], preset=preset).run(State.at_rest(1, 7), 0, STEPS)
    scale = lane.drive.displacement_scale(lane.chain)
    return float(np.max(np.abs(trajectory.relative_velocity)) / (scale * lane.drive.angular_frequency))


def test_bristles_without_iterations_would_not_move_and_are_refused() -> None:
    with pytest.raises(ParameterError, match=r"discontinuous_iterations = 0 .* whole numbers >= 1"):
        built_with(ExudynBristle(), lane_of(), discontinuous_iterations=0)


@pytest.mark.parametrize(("steps", "substeps"), [(STEPS, 1), (STEPS, 4), (2 * STEPS, 1)])
def test_static_friction_of_a_stiff_bristle_decays_over_a_part_of_a_kick(steps, substeps) -> None:
    """A kick is what the bound does to the relative velocity in a step of the solver."""
    chain = Chain.from_ratios(friction_ratio=0.3, base_amplitude=AMPLITUDE, mass_ratio=0.5)
    lane = Lane.periodic(chain, HarmonicBase.from_ratio(chain, 0.9, AMPLITUDE), steps)
    (inside,) = built_with(ExudynBristle(), lane, substeps=substeps).models
    bound, reduced = chain.friction_bound[0], 1 / (1 / chain.outer_mass[0] + 1 / chain.inner_mass[0])
    kick = bound / reduced * lane.time_step / substeps
    assert static_decays(lane, inside._preset, SI)[0] == pytest.approx(STATIC_DECAY_PER_KICK * kick)


def test_a_default_bristle_is_so_soft_that_stuck_contacts_move() -> None:
    creep = [largest_creep(ExudynBristle(), lane_of(5.0), preset) for preset in ("tuned", "default")]
    assert creep[0] < 1e-3
    assert creep[1] > 0.01


def test_a_default_zone_in_metres_per_second_is_too_wide_for_small_motions() -> None:
    chain = Chain.from_ratios(friction_ratio=5.0, base_amplitude=AMPLITUDE / 100)
    lane = Lane.periodic(chain, HarmonicBase.from_ratio(chain, 0.6, AMPLITUDE / 100), STEPS)
    assert largest_creep(ExudynRegularised(), lane, "tuned") < 0.01
    assert largest_creep(ExudynRegularised(), lane, "default") > 0.03


@pytest.mark.slow
def test_error_of_transmittance_is_in_proportion_to_the_zone() -> None:
    """The law of regularised friction: where cells hardly move, creep within the zone is all of the error."""
    lane = lane_of(0.1, 1.4)
    exact = exact_steady_state(lane.chain, lane.drive).transmittance_db
    errors = []
    for zone in (4e-3, 2e-3, 1e-3):
        simulation = built_with(ExudynRegularised(), lane, zone=zone)
        errors.append(decibel(transmittance(periodic_orbits(simulation, STEPS)[0])) - exact)
    assert errors[0] / errors[1] == pytest.approx(2, rel=0.05)
    assert errors[1] / errors[2] == pytest.approx(2, rel=0.05)


def test_a_zone_so_narrow_that_newtons_iteration_fails_needs_steps_that_may_be_halved() -> None:
    simulation = built_with(ExudynRegularised(), lane_of(1.0, 0.7), "joint", "default", smallest_step=0.9)
    with pytest.raises(RuntimeError, match=r"exudyn stopped at \S+ s: no convergence"):
        simulation.advance(random_state(), 0, 2 * STEPS)
