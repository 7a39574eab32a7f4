"""What every engine must do, whatever it is: one suite over all that are installed."""

import dataclasses
import sys
from dataclasses import dataclass

import numpy as np
import pytest

from engines import engine, engine_names
from engines.interface import Capabilities, Formulation, FrictionLaw, Preset
from reference_lcp import (
    Chain,
    HarmonicBase,
    Lane,
    ParameterError,
    State,
    decibel,
    frictionless_transmittance,
    periodic_orbits,
    stuck_transmittance,
    transmittance,
)
from reference_lcp.convergence import STICK_SLIP_POINTS
from scenarios.agreement import CONVERGED_TOLERANCE_DB, SCHEME_TOLERANCE_DB

STEPS = 400

BOUND_MARGIN = 1e-6
"""Part by which a reported force may pass its bound: far above the round-off of any solver, and what the
reading of stick and slip takes for equal."""

LINEAR_TOLERANCE_DB = 0.1
"""Of the frictionless and stuck limits at 400 steps: the scheme's own first-order error there is below 0.07 dB."""

GROWTH = 2 * 2 * np.pi * 2.3 / STEPS
"""By which a first-order scheme may let the distance of two motions grow, over the distance: 2 Δt ω_max."""


INSTALLED = [name for name in engine_names() if engine(name).why_not_installed() is None]


@dataclass(frozen=True)
class Setup:
    """One engine in one formulation with one preset."""

    name: str
    formulation: str
    preset: str

    def build(self, lanes):
        return engine(self.name).build(lanes, self.formulation, self.preset)

    @property
    def options(self) -> Preset:
        return engine(self.name).preset(self.formulation, self.preset)

    @property
    def capabilities(self) -> Capabilities:
        return engine(self.name).capabilities


SETUPS = [
    Setup(name, str(formulation), preset)
    for name in INSTALLED
    for formulation, presets in engine(name).capabilities.presets.items()
    for preset in ("tuned", "default")
    if preset in presets
]
TUNED = [setup for setup in SETUPS if setup.preset == "tuned"]
DEFAULT = [setup for setup in SETUPS if setup.preset == "default"]


def label(setup: Setup) -> str:
    return f"{setup.name}-{setup.formulation}-{setup.preset}"


@pytest.fixture(params=SETUPS, ids=label)
def tested(request) -> Setup:
    """Whatever is set up: clauses that hold for defaults too."""
    return request.param


@pytest.fixture(params=TUNED, ids=label)
def tuned(request) -> Setup:
    """The best known options: clauses of accuracy."""
    return request.param


@pytest.fixture(params=DEFAULT, ids=label)
def default(request) -> Setup:
    """What a newcomer gets."""
    return request.param


@pytest.fixture(params=INSTALLED)
def installed(request) -> str:
    return request.param


def test_every_engine_that_has_a_wheel_for_this_python_is_installed() -> None:
    without_wheel = {"pybullet"} if sys.version_info >= (3, 12) else set()
    assert set(engine_names()) - set(INSTALLED) <= without_wheel
    assert len(INSTALLED) >= 4


def lane_of(friction_ratio, frequency_ratio, steps=STEPS) -> Lane:
    chain = Chain.from_ratios(friction_ratio=friction_ratio)
    return Lane.periodic(chain, HarmonicBase.from_ratio(chain, frequency_ratio), steps)


def random_state(lanes: int, seed: int = 0) -> State:
    rng = np.random.default_rng(seed)
    return State(rng.normal(0, 0.01, (lanes, 14)), rng.normal(0, 0.2, (lanes, 14)))


def test_split_run_equals_whole_run(tested) -> None:
    simulation = tested.build([lane_of(0.3, 0.6)])
    whole = simulation.run(random_state(1), 0, 200)[0]
    first = simulation.run(random_state(1), 0, 100)[0]
    second = simulation.run(first.end, 100, 100)[0]
    allowed = tested.options.split_tolerance * 0.01
    assert np.max(np.abs(whole.positions[100:] - second.positions)) <= allowed
    assert whole.time[100:] == pytest.approx(second.time)


def test_repeated_run_is_bitwise_equal(tested) -> None:
    simulation = tested.build([lane_of(0.3, 0.6)])
    assert tested.capabilities.deterministic
    one, other = (simulation.run(random_state(1), 0, 50)[0] for _ in range(2))
    assert np.array_equal(one.positions, other.positions)
    assert np.array_equal(one.friction, other.friction)


def test_batch_equals_its_lanes_alone_and_subset_keeps_them(tested) -> None:
    lanes = [lane_of(0.3, 0.6), lane_of(0.1, 0.9), lane_of(1.0, 1.3)]
    state = random_state(3)
    together = tested.build(lanes)
    runs, part = together.run(state, 0, 40), together.subset([2, 0]).run(state.subset([2, 0]), 0, 40)
    for index, lane in enumerate(lanes):
        alone = tested.build([lane]).run(state.subset([index]), 0, 40)[0]
        assert np.array_equal(alone.positions, runs[index].positions)
    assert np.array_equal(part[0].positions, runs[2].positions)
    assert np.array_equal(part[1].positions, runs[0].positions)


def test_advance_ends_where_run_ends(tested) -> None:
    simulation = tested.build([lane_of(0.3, 0.6)])
    end = simulation.run(random_state(1), 0, 60)[0].end
    short = simulation.advance(random_state(1), 0, 60)
    assert np.array_equal(end.positions, short.positions)
    assert np.array_equal(end.velocities, short.velocities)


def test_trajectory_has_one_row_a_step_in_si_units(tested) -> None:
    lane = lane_of(0.3, 0.6)
    run = tested.build([lane]).run(random_state(1), 3, 25)[0]
    assert run.time == pytest.approx(lane.time_step * np.arange(4, 29))
    assert run.positions.shape == run.velocities.shape == (25, 14)
    assert run.friction.shape == run.normal_force.shape == (25, 7)
    assert np.all(run.normal_force > 0)


def test_normal_force_is_the_one_that_is_given(tuned) -> None:
    """A measured one as well: nothing may press harder while a contact slides."""
    lane = lane_of(0.3, 0.6)
    run = tuned.build([lane]).run(random_state(1), 0, 50)[0]
    assert run.normal_force == pytest.approx(np.broadcast_to(lane.chain.normal_force, (50, 7)), rel=1e-9)


def test_cells_without_friction_feel_none(tested) -> None:
    """Of both kinds: no normal force, and no coefficient of friction."""
    chain = Chain.from_ratios(friction_ratio=[0.3, 0.0, 0.3, 0.3, 0.1, 0.3, 1.0])
    coefficient = np.where(np.arange(7) == 3, 0.0, chain.friction_coefficient)
    chain = dataclasses.replace(chain, friction_coefficient=coefficient)
    lane = Lane.periodic(chain, HarmonicBase.from_ratio(chain, 0.6), STEPS)
    run = tested.build([lane]).run(random_state(1), 0, 50)[0]
    without = chain.friction_bound == 0
    assert np.count_nonzero(without) == 2
    assert np.all(run.friction[:, without] == 0)
    assert np.all(np.any(run.friction[:, ~without] != 0, axis=0))


def test_friction_stays_within_its_bound_and_opposes_slip(tested) -> None:
    """Sign convention: λ_T as it acts on the inner mass, so that its power with ġ_T takes energy out."""
    lane = lane_of(0.3, 0.6)
    run = tested.build([lane]).run(random_state(1), 0, STEPS)[0]
    bound = lane.chain.friction_coefficient * run.normal_force
    assert np.all(np.abs(run.friction) <= bound * (1 + BOUND_MARGIN))
    sliding = np.abs(run.relative_velocity) > 0.1 * 0.01 * lane.drive.angular_frequency
    if tested.capabilities.friction_law is FrictionLaw.BRISTLE or tested.preset == "default":
        # a bristle that has been bent gives its energy back after a reversal, and a soft constraint acts late:
        # only their sum is a loss
        assert np.all(np.sum(run.friction * run.relative_velocity, axis=0) < 0)
    else:
        assert np.all((run.friction * run.relative_velocity)[sliding] < 0)


def test_equation_of_motion_holds_between_rows(tuned) -> None:
    """Momentum: M Δq = ∫ (f − K u − C q + W_T λ_T) dt over a period, with the reported forces."""
    lane = lane_of(0.3, 0.9, 1600)
    chain = lane.chain
    run = tuned.build([lane]).run(random_state(1), 0, 1600)[0]
    load = np.zeros_like(run.positions)
    load[:, 0] = lane.drive.load(chain, run.time)
    force = load - run.positions @ chain.stiffness_matrix - run.velocities @ chain.damping_matrix
    impulse = np.sum(force[:-1] + (run.friction @ chain.contact_directions.T)[1:], axis=0) * lane.time_step
    change = (run.velocities[-1] - run.velocities[0]) * np.diag(chain.mass_matrix)
    assert np.max(np.abs(impulse - change)) < 0.01 * np.max(np.abs(chain.mass_matrix @ run.velocities.T))


@pytest.mark.parametrize("ratio", [0.5, 0.9, 1.6])
def test_frictionless_limit_is_the_linear_response(tuned, ratio) -> None:
    lane = lane_of(0.0, ratio)
    orbit = periodic_orbits(tuned.build([lane]), STEPS)[0]
    exact = decibel(frictionless_transmittance(lane.chain, lane.drive))
    assert orbit.converged
    assert decibel(transmittance(orbit)) == pytest.approx(exact, abs=LINEAR_TOLERANCE_DB)


@pytest.mark.parametrize("ratio", [0.5, 0.9, 1.2])
def test_stuck_limit_is_the_chain_of_locked_masses(tuned, ratio) -> None:
    lane = lane_of(20.0, ratio)
    orbit = periodic_orbits(tuned.build([lane]), STEPS)[0]
    exact = decibel(stuck_transmittance(lane.chain, lane.drive))
    assert decibel(transmittance(orbit)) == pytest.approx(exact, abs=LINEAR_TOLERANCE_DB)


def test_two_motions_under_one_drive_never_drift_apart(tuned) -> None:
    lane = lane_of(0.3, 0.6)
    one, other = tuned.build([lane, lane]).run(random_state(2), 0, 4 * STEPS)
    x, v = one.positions - other.positions, one.velocities - other.velocities
    chain = lane.chain
    kinetic = np.einsum("ti,ij,tj->t", v, chain.mass_matrix, v)
    distance = np.sqrt(kinetic + np.einsum("ti,ij,tj->t", x, chain.stiffness_matrix, x))
    growth = distance[1:] / np.minimum.accumulate(distance)[:-1] - 1
    assert np.max(growth) < GROWTH
    assert distance[-1] < distance[0]


def test_transmittance_at_six_points_agrees_with_the_reference(tuned) -> None:
    lanes = [lane_of(*place) for place in STICK_SLIP_POINTS]
    shares = tuned.options.shares_scheme
    ruler = engine("reference").build(lanes, preset="tuned" if shares else "converged")
    tolerance = SCHEME_TOLERANCE_DB if shares else CONVERGED_TOLERANCE_DB
    found = periodic_orbits(tuned.build(lanes), STEPS)
    expected = periodic_orbits(ruler, STEPS)
    for place, orbit, reference in zip(STICK_SLIP_POINTS, found, expected, strict=True):
        assert orbit.converged, place
        difference = decibel(transmittance(orbit)) - decibel(transmittance(reference))
        assert abs(difference) <= tolerance, place


def test_every_option_of_a_preset_has_a_reason(installed) -> None:
    presets = [preset for named in engine(installed).capabilities.presets.values() for preset in named.values()]
    assert all(option.reason for preset in presets for option in preset.options.values())
    assert all(preset.description for preset in presets)


def test_unknown_formulation_preset_and_mixed_lengths_are_refused(installed) -> None:
    with pytest.raises(ParameterError, match=f"formulation of {installed} = 'glue' is unknown; allowed: joint"):
        engine(installed).build([lane_of(0.3, 0.6)], formulation="glue")
    with pytest.raises(ParameterError, match=f"preset of {installed} = 'best' is unknown; allowed: tuned"):
        engine(installed).build([lane_of(0.3, 0.6)], preset="best")
    short = Chain.from_ratios(cells=2)
    with pytest.raises(ParameterError, match=r"chains of \[2, 7\] cells"):
        engine(installed).build([lane_of(0.3, 0.6), Lane.periodic(short, HarmonicBase.from_ratio(short, 0.9), STEPS)])
    assert Formulation.JOINT in engine(installed).capabilities.presets


SHARING = [setup for setup in TUNED if setup.options.shares_scheme and setup.name != "reference"]


@pytest.mark.parametrize("sharing", SHARING, ids=label)
def test_who_shares_the_scheme_equals_the_reference_to_round_off_over_forty_periods(sharing) -> None:
    lane = lane_of(0.3, 0.9)
    runs = [built.build([lane]).run(State.at_rest(1, 7), 0, 40 * STEPS)[0] for built in (sharing, engine("reference"))]
    assert np.max(np.abs(runs[0].positions - runs[1].positions)) <= 1e-12 * 0.01
    assert np.max(np.abs(runs[0].friction - runs[1].friction)) <= 1e-9 * lane.chain.friction_bound[0]


def test_default_stays_finite_and_near_the_reference_for_a_period(default) -> None:
    """How far a default is off is for reports to say; that it is the same chain must show at once."""
    lane = lane_of(0.3, 0.9)
    found, expected = (
        built.build([lane]).run(State.at_rest(1, 7), 0, STEPS)[0] for built in (default, engine("reference"))
    )
    difference = np.max(np.abs(found.positions - expected.positions)) / 0.01
    assert 0 < difference < 1


def test_unknown_engine_is_refused_with_the_known_ones() -> None:
    with pytest.raises(ParameterError, match="engine = 'bullet' is unknown; allowed: reference"):
        engine("bullet")
