"""What must not matter: units, what makes up a bound, how large a motion is, in how many parts it is run."""

import dataclasses

import numpy as np
import pytest

from multibody_xval.engines.contract.lanes import drive_of, lane_of, random_state, run_of, tolerance_of
from multibody_xval.engines.interface.presets import FrictionLaw
from multibody_xval.engines.interface.tolerances import ROUND_OFF, SINGLE, STEPS
from multibody_xval.engines.interface.variant import Variant
from reference_lcp.chain.drives import HarmonicBase, StillBase
from reference_lcp.chain.mass_in_mass import Chain
from reference_lcp.chain.simulation import Lane
from reference_lcp.chain.trajectory import State, Trajectory
from reference_lcp.defaults import BASE_AMPLITUDE
from reference_lcp.errors import ParameterError
from reference_lcp.validation import FloatArray

SAME_MOTION = {"double": 1e-12, "single": 10 * np.sqrt(STEPS) * SINGLE}
"""Of positions over a period, over the largest: round-off, in single precision three standard deviations of it, for
motions of some six displacement scales."""

OWN_SOLVER = 10
"""What it may round, over that of the scheme."""

PARTS, ROUND_OFF_SPLIT = 40, 1e-12
"""Runs that a period is split into, and a split tolerance that is round-off of a state, and no other beginning."""

FAR = {"joint": 1e4, "contact": 100.0}
"""Times the displacement scale: far above any motion of a chain, and within the plates of contacts."""

CREEPS = {"double": 1e-13, "single": 32 * SINGLE}
"""Of the slip velocity of a stuck contact, over the drive's: some roundings of the velocities that it is between, which
are several times as large."""

STILL = 1e-15
"""Of the displacement scale, and of the speed of the drive's at it: less than the last place of any motion."""


def run_or_skip(variant: Variant, lane: Lane, state: State, steps: int = STEPS) -> Trajectory:
    """Run one lane; an engine may also say that it takes no such numbers."""
    try:
        return run_of(variant, lane, state, steps)
    except (ParameterError, RuntimeError) as refusal:
        pytest.skip(f"refused: {refusal}")


def assert_same_motion(tested: Variant, positions: FloatArray, expected: FloatArray, what: str) -> None:
    """Compare positions, in the same unit; a solver of an engine's own rounds more than the step of the scheme."""
    difference = np.max(np.abs(positions - expected)) / np.max(np.abs(expected))
    allowed = tolerance_of(tested, SAME_MOTION) * (1 if tested.preset.shares_scheme else OWN_SOLVER)
    assert difference <= allowed, f"{what}, over its largest position"


@pytest.mark.parametrize(
    ("mass", "stiffness", "length"),
    [(1e-15, 1e6, 1e-9), (1e9, 1e3, 100.0), (1e-3, 1e15, 1e-6)],
    ids=["nanometres", "hundred metres", "micrometres"],
)
def test_units_do_not_matter(tuned: Variant, mass: float, stiffness: float, length: float) -> None:
    """Nanometres at gigahertz move as metres at hertz do; mass [kg], stiffness [N/m], displacement scale [m]."""
    chain = Chain.from_ratios(friction_ratio=0.3, outer_mass=mass, chain_stiffness=stiffness, base_amplitude=length)
    lane = Lane.periodic(chain, HarmonicBase.from_ratio(chain, 0.6, length), STEPS)
    run, usual = (run_or_skip(tuned, each, State.at_rest(1, 7)) for each in (lane, lane_of(0.3, 0.6)))
    assert_same_motion(
        tuned,
        run.positions / length,
        usual.positions / BASE_AMPLITUDE,
        "the motion in these units differs from that in SI units",
    )


@pytest.mark.parametrize(
    "coefficient", [0.001, 0.1, 3.0, (0.5, 0.05, 0.3, 1.0, 0.02, 2.0, 0.7)], ids=["tiny", "small", "large", "uneven"]
)
def test_only_the_bound_enters_whatever_the_coefficient(
    sharing: Variant, coefficient: float | tuple[float, ...]
) -> None:
    """The same μ λ_N of another coefficient and another normal force."""
    usual = lane_of(0.3, 0.6)
    coefficients = np.broadcast_to(coefficient, 7).astype(float)
    normal_force = usual.chain.friction_bound / coefficients
    chain = dataclasses.replace(usual.chain, friction_coefficient=coefficients, normal_force=normal_force)
    lane = dataclasses.replace(usual, chain=chain)
    run, expected = run_or_skip(sharing, lane, random_state(1)), run_of(sharing, usual, random_state(1), STEPS)
    assert_same_motion(
        sharing,
        run.positions,
        expected.positions,
        "the motion with this coefficient and the same bound differs from the usual one",
    )
    pressed = np.max(np.abs(run.normal_force / normal_force - 1))
    assert pressed <= tolerance_of(sharing, ROUND_OFF), "the normal force is off, as a part"


def test_motion_far_above_the_displacement_scale_is_not_cut_off(exact: Variant) -> None:
    """Largest velocities, and what else an engine bounds, are no part of the chain."""
    state = random_state(1)
    far = FAR[exact.formulation]
    fast = State(far * state.positions, far * state.velocities)
    run, expected = (
        run_or_skip(variant, lane_of(0.3, 0.6), fast, STEPS // 8) for variant in (exact, Variant("reference"))
    )
    assert_same_motion(exact, run.positions, expected.positions, "a large motion differs from the reference's")


def test_chain_at_rest_without_a_drive_stays_there(tested: Variant) -> None:
    """Drives, motors and contacts push nothing by themselves."""
    lane = dataclasses.replace(lane_of(0.3, 0.6), drive=StillBase(BASE_AMPLITUDE))
    end = tested.build([lane]).advance(State.at_rest(1, 7), 0, STEPS)
    moved = np.max(np.abs(end.positions)) / BASE_AMPLITUDE
    assert moved <= STILL, "a chain at rest has moved [U0]"
    speed = np.max(np.abs(end.velocities)) * lane.time_step * STEPS / BASE_AMPLITUDE
    assert speed <= STILL, "a chain at rest moves, over U0 a period"


def test_stuck_contact_does_not_creep(sharing: Variant) -> None:
    """Under a friction that never slips, whatever the drive does; by no more than the preset states."""
    lane = lane_of(5.0, 0.3)
    run = run_of(sharing, lane, State.at_rest(1, 7), 3 * STEPS)
    creep = np.max(np.abs(run.relative_velocity)) / (BASE_AMPLITUDE * drive_of(lane).angular_frequency)
    allowed = CREEPS[sharing.capabilities.precision] + sharing.preset.residual_slip_compliance
    assert creep <= allowed, "a stuck contact creeps, over the velocity of the drive"


def test_state_is_rounded_once_and_not_with_every_run(tested: Variant) -> None:
    """A period in forty parts is the whole one, to what the preset states for two halves, or for each part."""
    if tested.capabilities.friction_law is FrictionLaw.BRISTLE:
        pytest.skip("its Newton method begins every run from another guess")
    simulation = tested.build([lane_of(0.3, 0.6)])
    whole = simulation.advance(random_state(1), 0, STEPS)
    state = random_state(1)
    for part in range(PARTS):
        state = simulation.advance(state, part * STEPS // PARTS, STEPS // PARTS)
    off = np.max(np.abs(state.positions - whole.positions)) / BASE_AMPLITUDE
    stated = tested.preset.split_tolerance
    assert off <= stated * (1 if stated <= ROUND_OFF_SPLIT else PARTS), f"another motion after {PARTS} runs [U0]"
