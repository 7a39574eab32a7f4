"""Against the reference: steady states at six points, and whole motions of those that share its scheme."""

from functools import cache

import numpy as np
import pytest

from multibody_xval.engines.contract.lanes import (
    FINER,
    finer,
    lane_of,
    pulse_lane_of,
    random_state,
    run_of,
    tolerance_of,
)
from multibody_xval.engines.interface.registry import engine
from multibody_xval.engines.interface.tolerances import (
    CONVERGED_TOLERANCE_DB,
    FRICTION_TOLERANCE,
    PULSE_TOLERANCE,
    SAME_CHAIN,
    SCHEME_TOLERANCE_DB,
    SINGLE,
    STEPS,
    TRAJECTORY_TOLERANCE,
)
from multibody_xval.engines.interface.variant import Variant
from reference_lcp.chain.drives import HarmonicBase
from reference_lcp.chain.mass_in_mass import Chain
from reference_lcp.chain.simulation import Lane, PeriodicOrbit
from reference_lcp.chain.trajectory import State
from reference_lcp.defaults import BASE_AMPLITUDE, STICK_SLIP_POINTS
from reference_lcp.observables.transmittance import decibel, transmittance
from reference_lcp.steady.neighbours import beside_euler
from reference_lcp.steady.orbits import periodic_orbits

UNINFORMED_POINTS = 1
"""Points at which an engine is searched from harmonic balance; at the others its search begins in the orbit of the
reference, which saves tens of periods; Newton's steps of Euler's scheme save as many where the scheme is not shared.
Either way it is the residual of the engine's own period that ends it."""


def test_transmittance_at_six_points_agrees_with_the_reference(tuned: Variant) -> None:
    """At equal time step where the scheme is shared, with the reference at finer steps otherwise."""
    lanes = [lane_of(*place) for place in STICK_SLIP_POINTS]
    shares = tuned.preset.shares_scheme
    tolerance = SCHEME_TOLERANCE_DB if shares else CONVERGED_TOLERANCE_DB
    expected = _reference_orbits(1 if shares else FINER)
    starts = State.stack([orbit.trajectory.end for orbit in expected[UNINFORMED_POINTS:]])
    orbits = [
        *_orbits(tuned, lanes[:UNINFORMED_POINTS], None),
        *_orbits(tuned, lanes[UNINFORMED_POINTS:], starts),
    ]
    for place, orbit, reference in zip(STICK_SLIP_POINTS, orbits, expected, strict=True):
        assert orbit.converged, f"no steady state at {place}"
        difference = float(decibel(transmittance(orbit)) - decibel(transmittance(reference)))
        assert abs(difference) <= tolerance, f"transmittance off at friction ratio, frequency ratio {place} [dB]"


@cache
def _reference_orbits(substeps: int) -> list[PeriodicOrbit]:
    lanes = [finer(lane_of(*place), substeps) for place in STICK_SLIP_POINTS]
    return periodic_orbits(engine("reference").build(lanes), substeps * STEPS)


def _orbits(tuned: Variant, lanes: list[Lane], start: State | None) -> list[PeriodicOrbit]:
    simulation, residual = tuned.build(lanes), tuned.capabilities.residual
    if start is None or tuned.preset.shares_scheme:
        return periodic_orbits(simulation, STEPS, start=start, tolerance=residual)
    return beside_euler(simulation, STEPS, start=start, tolerance=residual)


def test_variant_that_shares_the_scheme_equals_the_reference_to_round_off_over_forty_periods(exact: Variant) -> None:
    """The same equations, solved by another code; what other presets share, a period shows."""
    lane = lane_of(0.3, 0.9)
    run, expected = (
        run_of(variant, lane, State.at_rest(1, 7), 40 * STEPS) for variant in (exact, Variant("reference"))
    )
    motion = np.max(np.abs(run.positions - expected.positions)) / BASE_AMPLITUDE
    force = np.max(np.abs(run.friction - expected.friction)) / lane.chain.friction_bound[0]
    assert motion <= tolerance_of(exact, TRAJECTORY_TOLERANCE), "the motion differs from the reference's [U0]"
    assert force <= tolerance_of(exact, FRICTION_TOLERANCE), "the friction differs from the reference's, over its bound"


def test_pulse_of_the_base_moves_the_chain_as_it_moves_the_reference(tuned: Variant) -> None:
    """A drive is any function of time: over four periods of the resonator, from rest."""
    lane = pulse_lane_of(0.3)
    shares = tuned.preset.shares_scheme
    part, rest = (1 if shares else FINER), State.at_rest(1, 7)
    expected = run_of(Variant("reference"), finer(lane, part), rest, 4 * STEPS * part).positions[part - 1 :: part]
    run = run_of(tuned, lane, rest, 4 * STEPS)
    difference = np.max(np.abs(run.positions - expected)) / BASE_AMPLITUDE
    tolerance = tolerance_of(tuned, TRAJECTORY_TOLERANCE) if shares else PULSE_TOLERANCE
    assert difference <= tolerance, "the motion after a pulse of the base differs from the reference's [U0]"


@pytest.mark.parametrize("friction", [0.0, 0.3, 5.0], ids=["frictionless", "slipping", "stuck"])
def test_cells_that_differ_are_each_built_as_given(sharing: Variant, friction: float) -> None:
    """Every mass, spring, dashpot and bound its own, and one cell without friction."""
    rng = np.random.default_rng(5)
    mass, stiffness, rubbing, outer, springs = rng.uniform(0.5, 2, (5, 7))
    chain_dashpot, inner_dashpot = rng.uniform(0.01, 0.1, (2, 7))
    rubbing[2] = 0.0
    chain = Chain.from_ratios(
        mass_ratio=mass, stiffness_ratio=stiffness, friction_ratio=friction * rubbing,
        damping_ratio=chain_dashpot, inner_damping_ratio=inner_dashpot,
        outer_mass_ratio=outer, chain_stiffness_ratio=springs,
    )  # fmt: skip
    lane = Lane.periodic(chain, HarmonicBase.from_ratio(chain, 0.9, BASE_AMPLITUDE), STEPS)
    run, expected = (run_of(variant, lane, random_state(1), 2 * STEPS) for variant in (sharing, Variant("reference")))
    motion = np.max(np.abs(run.positions - expected.positions)) / np.max(np.abs(expected.positions))
    assert motion <= tolerance_of(sharing, TRAJECTORY_TOLERANCE), (
        "the motion of unequal cells differs from the reference's, as a part"
    )
    if sharing.capabilities.precision == "single":
        assert motion > SINGLE / 10, "a finer result than single precision can have is another engine's"
    force, bound = np.max(np.abs(run.friction - expected.friction)), np.max(chain.friction_bound)
    assert force <= tolerance_of(sharing, FRICTION_TOLERANCE) * bound, (
        "the friction of unequal cells differs from the reference's [N]"
    )


def test_default_stays_finite_and_near_the_reference_for_a_period(default: Variant) -> None:
    """How far a default is off is a finding of reports; that it is the same chain must show at once."""
    lane = lane_of(0.3, 0.9)
    run, expected = (run_of(variant, lane, State.at_rest(1, 7), STEPS) for variant in (default, Variant("reference")))
    difference = np.max(np.abs(run.positions - expected.positions)) / BASE_AMPLITUDE
    assert difference <= SAME_CHAIN, "the motion differs from the reference's [U0]"
