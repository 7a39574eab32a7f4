"""Exudyn: its two friction laws, its restarts and its units."""

import numpy as np
import pytest

from multibody_xval.engines.exudyn import ExudynBristle, ExudynRegularised
from multibody_xval.engines.exudyn.joint import STATIC_DECAY_PER_KICK
from multibody_xval.engines.exudyn.reproducer import bristle_numbers
from multibody_xval.engines.exudyn.step_model import (
    SPECTRAL_RADIUS,
    ZONE,
    GeneralisedAlphaLane,
    NewtonLane,
    step_rule,
    zone_widths,
)
from multibody_xval.engines.interface.engine import Engine
from multibody_xval.engines.interface.law import Law, NotModelled
from multibody_xval.engines.interface.registry import LawEngine, law_of
from reference_lcp.chain.drives import Drive, HarmonicBase, HarmonicForce
from reference_lcp.chain.linear_response import frictionless_response
from reference_lcp.chain.mass_in_mass import Chain
from reference_lcp.chain.simulation import Lane
from reference_lcp.chain.trajectory import State, Trajectory
from reference_lcp.errors import ParameterError
from reference_lcp.observables.transmittance import decibel, transmittance
from reference_lcp.one_call import exact_steady_state
from reference_lcp.steady.orbits import periodic_orbits
from tests.engines.scheme_oracle import AMPLITUDE, STEPS, built_with, lane_of, random_state

pytestmark = pytest.mark.needs("exudyn-bristle")

both_laws = pytest.mark.parametrize("engine", [ExudynRegularised(), ExudynBristle()], ids=lambda engine: engine.name)


def decibels(trajectory: Trajectory) -> float:
    """Transmittance over one period [dB]."""
    phase = 2 * np.pi * np.arange(1, trajectory.steps + 1) / trajectory.steps
    fundamental = 2 * np.mean(trajectory.outer_positions[:, -1] * np.exp(-1j * phase))
    return float(20 * np.log10(np.abs(fundamental) / AMPLITUDE))


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
def test_frictionless_chain_follows_the_harmonic_solution_at_second_order(engine: Engine) -> None:
    errors = []
    for steps in (100, 200):
        lane = lane_of(0.0, 0.9, steps)
        response = frictionless_response(lane.chain, lane.drive)
        omega = lane.drive.angular_frequency
        start = State(response.imag[None], (1j * omega * response).imag[None])
        (trajectory,) = built_with(engine, lane, substeps=1).run(start, 0, steps)
        exact = np.imag(np.exp(1j * omega * trajectory.time)[:, None] * response)
        errors.append(np.max(np.abs(trajectory.positions - exact)) / AMPLITUDE)
    assert errors[0] < 0.05
    assert np.log2(errors[0] / errors[1]) == pytest.approx(2, abs=0.1)


@pytest.mark.slow
@both_laws
@pytest.mark.parametrize(("friction_ratio", "frequency_ratio", "exact"), [(0.3, 0.6, -0.147), (0.6, 1.3, -15.244)])
def test_steady_state_transmittance_is_the_event_driven_one(
    engine: Engine, friction_ratio: float, frequency_ratio: float, exact: float
) -> None:
    lane = lane_of(friction_ratio, frequency_ratio)
    (orbit,) = periodic_orbits(engine.build([lane]), STEPS)
    assert orbit.converged
    # The tuned presets are within 0.16 dB on all of figure 3 down to -60 dB.
    assert decibels(orbit.trajectory) == pytest.approx(exact, abs=0.05)


def test_regularised_friction_never_drives() -> None:
    lane = lane_of(0.3, 0.9)
    (trajectory,) = ExudynRegularised().build([lane]).run(random_state(), 0, STEPS)
    assert np.all(trajectory.friction * trajectory.relative_velocity <= 0)


def held_inner_mass(engine: Engine, force_ratio: float, **values: object) -> tuple[Lane, Trajectory]:
    """One cell whose outer mass is pushed by a slow force; the contact carries part of it in stick."""
    chain = Chain.from_ratios(cells=1, friction_ratio=1.0, stiffness_ratio=1e-3, damping_ratio=0.5)
    force = HarmonicForce(force_ratio * float(chain.friction_bound[0]), 0.1 * np.sqrt(500.0))
    lane = Lane.periodic(chain, force, STEPS)
    simulation = built_with(engine, lane, **values)
    start = simulation.advance(State.at_rest(1, 1), 0, 2 * STEPS)
    return lane, simulation.run(start, 0, STEPS)[0]


def test_stuck_contact_creeps_in_proportion_to_the_zone() -> None:
    zones = (0.01, 0.02)
    creep = [
        np.max(np.abs(held_inner_mass(ExudynRegularised(), 0.5, zone=zone, zone_per_kick=0.0)[1].relative_velocity))
        for zone in zones
    ]
    assert creep[0] > 0
    assert creep[1] / creep[0] == pytest.approx(2, rel=0.01)


def test_stuck_bristle_gives_way_by_force_over_stiffness() -> None:
    lane, trajectory = held_inner_mass(ExudynBristle(), 0.5)
    tuned = ExudynBristle().preset("joint", "tuned")
    phase = tuned["bristle_phase"] * tuned["substeps"] / lane.time_step
    stiffness = 0.5 * phase**2
    elongation = np.ptp(trajectory.inner_positions - trajectory.outer_positions)
    assert elongation == pytest.approx(np.ptp(trajectory.friction) / stiffness, rel=0.05)


@pytest.mark.parametrize("split", [1, 177, 399])
@pytest.mark.parametrize(
    ("engine", "formulation"),
    [(ExudynRegularised(), "joint"), (ExudynBristle(), "joint"), (ExudynRegularised(), "contact")],
    ids=["zone", "bristle", "disc"],
)
def test_run_split_in_two_equals_the_whole(engine: Engine, formulation: str, split: int) -> None:
    """Of discs nothing is kept but positions and velocities: they are at their static depth, and slip follows."""
    lane = lane_of(0.3, 0.6)
    simulation = engine.build([lane], formulation)
    start = simulation.advance(random_state(), 0, STEPS)
    whole = simulation.advance(start, 0, STEPS)
    halves = simulation.advance(simulation.advance(start, 0, split), split, STEPS - split)
    assert distance(whole, halves, lane) <= engine.preset(formulation, "tuned").split_tolerance


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
    scaled = bound / inside._units.force / (reduced / inside._units.mass) * inside._time_step / substeps
    assert inside._static_decay(0) == pytest.approx(STATIC_DECAY_PER_KICK * scaled)


@pytest.mark.parametrize("preset", ["tuned", "default"])
def test_a_script_sets_what_the_preset_changes_and_nothing_else(preset) -> None:
    own = ExudynBristle().preset("joint", preset)
    solver = "\n".join(bristle_numbers(lane_of(), own, State.at_rest(1, 7))["solver"])
    names = {
        "relative_tolerance": "relativeTolerance",
        "absolute_tolerance": "absoluteTolerance",
        "discontinuous_iterations": "maxIterations",
    }
    changed = {option for option in names if own[option] != own.options[option].default}
    assert {option for option, name in names.items() if name in solver} == changed
    assert len(changed) == (3 if preset == "tuned" else 0)


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


def model_of(tested: Engine, formulation: str, preset: str) -> Law:
    """Give the law of a preset, or what nearly is its law."""
    stated = tested.preset(formulation, preset).stated_law()
    model = stated.nearly if isinstance(stated, NotModelled) else stated
    assert model is not None
    return model


def distance_from_law(tested: Engine, formulation: str, preset: str, lane: Lane) -> float:
    """Largest difference of positions over U0 in a period from a random state, which a run of half of it follows."""
    halves = []
    for simulation in (tested.build([lane], formulation, preset), model_of(tested, formulation, preset).build([lane])):
        middle = simulation.advance(random_state(), 0, STEPS // 2)
        halves.append(simulation.run(middle, STEPS // 2, STEPS)[0].positions)
    return float(np.max(np.abs(halves[0] - halves[1]))) / AMPLITUDE


@pytest.mark.parametrize(
    ("tested", "formulation", "preset"),
    [
        (ExudynRegularised(), "joint", "tuned"),
        (ExudynRegularised(), "joint", "default"),
        (ExudynRegularised(), "contact", "tuned"),
        (ExudynBristle(), "joint", "tuned"),
    ],
    ids=["zone", "default zone", "disc", "bristle"],
)
def test_law_begins_a_run_as_exudyn_does_and_leaves_frictionless_cells_alone(
    tested: Engine, formulation: str, preset: str
) -> None:
    lane = lane_of(np.array([0.1, 0.05, 0.0, 0.1, 0.02, 0.0, 0.05]), 1.2)
    law = law_of(tested.preset(formulation, preset))
    assert law is not None
    assert law.unmodelled_reason(lane) is None
    assert distance_from_law(tested, formulation, preset, lane) <= law.period_bound


def test_bristle_without_friction_is_not_deflected_in_the_law_either() -> None:
    """Its foot is where its contact is, to the last bit: a deflection of round-off would never repeat."""
    lane = lane_of(0.0, 1.422)
    state = LawEngine(ExudynBristle(), "0").build([lane], "joint", "tuned").advance(random_state(), 0, STEPS)
    assert state.internal_state is not None
    assert np.all(state.internal_state == 0)


@pytest.mark.parametrize(
    ("formulation", "preset", "lane"),
    [
        ("joint", "default", lane_of(1.0, 0.7)),
        ("joint", "default", sampled(lane_of(1.0, 0.7))),
        ("joint", "recommended", lane_of(0.1, 1.3)),
        ("contact", "default", lane_of(0.3, 0.8)),
        ("contact", "default", sampled(lane_of(0.3, 0.8))),
    ],
    ids=["zone", "zone, load in a table", "narrow zone", "disc", "disc, load in a table"],
)
def test_law_takes_newtons_path_and_halves_the_steps_in_which_it_fails_as_exudyn_does(
    formulation: str, preset: str, lane: Lane
) -> None:
    """In a zone so narrow, or where friction falls beyond it; steps that may not be halved end in the engine."""
    law = model_of(ExudynRegularised(), formulation, preset)
    assert distance_from_law(ExudynRegularised(), formulation, preset, lane) <= law.period_bound
    whole = built_with(ExudynRegularised(), lane, formulation, preset, smallest_step=0.9)
    with pytest.raises(RuntimeError, match="no convergence"):
        whole.advance(random_state(), 0, 2 * STEPS)


def test_equations_alone_say_how_a_wide_zone_moves_and_not_how_a_narrow_one_does() -> None:
    """Half a kick leads from one side of a zone as narrow as Exudyn's own beyond the other."""
    lane, ends = lane_of(1.0, 0.7), []
    preset = ExudynRegularised().preset("joint", "default")
    for model in (GeneralisedAlphaLane, NewtonLane):
        steps = model(lane, preset, step_rule({"ρ": SPECTRAL_RADIUS}), ZONE, zone_widths(lane, preset))
        ends.append(steps.advance(random_state(), 0, STEPS))
    assert distance(*ends, lane) > 1e-3
    tuned = law_of(ExudynRegularised().preset("joint", "tuned"))
    assert tuned is not None
    assert distance_from_law(ExudynRegularised(), "joint", "tuned", lane) <= tuned.period_bound
