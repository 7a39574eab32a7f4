"""MuJoCo's LuGre friction: its law, what it holds, and how it gives way under a load that swings below its bound."""

import dataclasses

import numpy as np
import pytest

from engines.interface.engine import EngineNotInstalled
from engines.interface.presets import Formulation
from engines.interface.registry import law_of
from engines.mujoco import MuJoCo
from reference_lcp.chain.drives import HarmonicForce
from reference_lcp.chain.mass_in_mass import Chain
from reference_lcp.chain.simulation import Lane
from reference_lcp.chain.trajectory import State, Trajectory
from tests.engines.scheme_oracle import AMPLITUDE, STEPS, built_with, lane_of, random_state, uneven_lane

LUGRE = MuJoCo().capabilities.presets[Formulation.JOINT]["lugre"]

pytestmark = pytest.mark.skipif(
    MuJoCo().unavailable_reason_of(LUGRE) is not None, reason="no mujoco with motors without an input is installed"
)

ROUND_OFF = 1e-11
"""Of what is computed in a period, over the displacement scale."""

BOUND, HELD = 3.0, 1.0
"""Friction and the force of the spring that it holds [N]."""


def swinging_lane(force: float) -> Lane:
    """Give a block whose spring pulls with 1 N; its carrier is shaken at 50 Hz, which adds a third of this [N]."""
    chain = Chain(
        cells=1, outer_mass=2.0, inner_mass=1.0, chain_stiffness=1e-3, inner_stiffness=1.0, chain_damping=0.0,
        inner_damping=0.0, normal_force=2 * BOUND, friction_coefficient=0.5,
    )  # fmt: skip
    return Lane(chain, HarmonicForce(force, 2 * np.pi * 50), 1e-3)


def held(lane: Lane, preset: str, seconds: int = 2) -> Trajectory:
    start = State(np.array([[0.0, HELD]]), np.zeros((1, 2)))
    return MuJoCo().build([lane], "joint", preset).run(start, 0, 1000 * seconds)[0]


def slips(motion: Trajectory) -> np.ndarray:
    """Mean slip [m] over the periods of the last tenth of each second."""
    slip = np.diff(motion.positions, axis=1)[:, 0] - HELD
    return slip.reshape(-1, 1000)[:, -100:].mean(axis=1)


@pytest.mark.parametrize("lane", [lane_of(), uneven_lane()])
@pytest.mark.parametrize(("phase", "damping"), [(1.0, 0.5), (0.3, 0.5), (1.0, 0.1)])
def test_motors_bend_bristles_as_the_law_says(lane: Lane, phase: float, damping: float) -> None:
    options = {"bristle_phase": phase, "bristle_damping": damping}
    named = {name: dataclasses.replace(LUGRE.options[name], value=value) for name, value in options.items()}
    law = law_of(dataclasses.replace(LUGRE, options={**LUGRE.options, **named}))
    assert law is not None
    own = built_with(MuJoCo(), lane, preset="lugre", **options).run(random_state(), 0, STEPS)[0]
    model = law.build([lane]).run(random_state(), 0, STEPS)[0]
    assert np.max(np.abs(own.positions - model.positions)) < ROUND_OFF * AMPLITUDE
    assert np.max(np.abs(own.friction - model.friction)) < ROUND_OFF * np.max(lane.chain.friction_bound)


def test_a_constant_load_below_the_bound_is_held_without_creep() -> None:
    first, last = slips(held(swinging_lane(1e-9), "lugre"))
    assert abs(last - first) < 1e-12


@pytest.mark.parametrize(("preset", "ratchets"), [("lugre", True), ("tuned", False)])
def test_a_load_that_swings_below_the_bound_ratchets_bristles_and_nothing_else(preset: str, *, ratchets: bool) -> None:
    """Friction swings between 0.2 and 1.8 N of 3: Coulomb's holds it for ever."""
    motion = held(swinging_lane(2.4), preset)
    first, last = slips(motion)
    assert np.max(np.abs(motion.friction[-1000:])) < 0.7 * BOUND
    assert (last < first - 1e-5) == ratchets
    if not ratchets:
        assert last == pytest.approx(0, abs=1e-12)


def test_friction_passes_its_bound_where_a_slip_reverses() -> None:
    """By the damping of bristles, which the contract leaves out for this reason."""
    motion = MuJoCo().build([lane_of()], "joint", "lugre").run(random_state(), 0, STEPS)[0]
    assert np.max(np.abs(motion.friction) / lane_of().chain.friction_bound) > 1.5


def test_a_version_without_motors_without_an_input_is_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(MuJoCo, "version", lambda _: "3.11.0")
    with pytest.raises(EngineNotInstalled, match=r"mujoco 3\.11\.0 is installed, and this preset takes >=3\.12$"):
        MuJoCo().build([swinging_lane(1.0)], "joint", "lugre")
