"""Newton: what only its graph, its worlds, its single precision, its drives and its friction anchors do."""

import dataclasses
import functools
from typing import Any

import numpy as np
import pytest

from multibody_xval.engines.interface.law import Law
from multibody_xval.engines.interface.registry import law_of
from multibody_xval.engines.newton import Newton
from multibody_xval.engines.newton.step_model import ANCHORED_PERIOD
from multibody_xval.engines.newton.worlds import JointWorlds, NewtonWorlds, import_newton
from multibody_xval.engines.shared.warp_worlds import import_warp
from reference_lcp.chain.drives import HarmonicBase
from reference_lcp.chain.mass_in_mass import Chain
from reference_lcp.chain.preload import Preload
from reference_lcp.chain.simulation import Lane
from reference_lcp.chain.trajectory import State, Trajectory
from tests.engines.scheme_oracle import (
    AMPLITUDE,
    ROUNDINGS,
    STEPS,
    assert_same_bits,
    built_with,
    distance,
    lane_of,
    scheme,
)

pytestmark = pytest.mark.needs("newton")

both_formulations = pytest.mark.parametrize("formulation", ["joint", "contact"])
every_preset = pytest.mark.parametrize(
    ("formulation", "preset"),
    [("joint", "tuned"), ("joint", "default"), ("contact", "tuned"), ("contact", "default")],
)


def run(lane: Lane, state: State, steps: int = STEPS, formulation: str = "joint", **options: object) -> Trajectory:
    return built_with(Newton(), lane, formulation, **options).run(state, 0, steps)[0]


def chain_of(mass: float, stiffness: float, length: float, frequency_ratio: float = 0.9) -> Lane:
    chain = Chain.from_ratios(friction_ratio=0.3, outer_mass=mass, chain_stiffness=stiffness, base_amplitude=length)
    return Lane.periodic(chain, HarmonicBase.from_ratio(chain, frequency_ratio, length), STEPS)


def anchored() -> Law:
    law = law_of(Newton().preset("contact", "default"))
    assert law is not None
    return law


def from_law(lane: Lane, law: Law, motion: Trajectory) -> float:
    """Largest distance of a motion from rest from the law's, over the displacement scale."""
    predicted = law.build([lane]).run(State.at_rest(1, 7), 0, motion.steps)[0].positions
    return float(np.max(np.abs(motion.positions - predicted))) / lane.drive.displacement_scale(lane.chain)


@pytest.mark.parametrize(("formulation", "cells"), [("joint", 40), ("contact", 12)])
def test_chains_with_more_constraints_than_the_solver_has_room_for_by_itself(
    formulation: str, cells: int, monkeypatch: pytest.MonkeyPatch, capfd: pytest.CaptureFixture[str]
) -> None:
    """It has room for 32, of all cells; what does not fit is left out, which it says on standard output."""
    chain = Chain.from_ratios(cells=cells, friction_ratio=0.3)
    lane = Lane.periodic(chain, HarmonicBase.from_ratio(chain, 0.9), STEPS)
    state = State(*AMPLITUDE * np.random.default_rng(4).normal(size=(2, 1, 2 * cells)))
    assert distance(lane, state, Newton().build([lane], formulation).run(state, 0, STEPS)[0]) < ROUNDINGS
    assert capfd.readouterr() == ("", "")
    solvers = import_newton().solvers
    own = {"articulation_constraint_max": 32}
    short = functools.partial(_with_options, solvers.SolverSteel, own)
    monkeypatch.setattr(solvers, "SolverSteel", short)
    assert distance(lane, state, Newton().build([lane], formulation).run(state, 0, STEPS)[0]) > 0.01
    assert "constraint-row overflow" in capfd.readouterr().out


def _with_options(solver: Any, own: dict[str, Any], model: Any, **options: Any) -> Any:
    return solver(model, **{**options, **own})


class AugmentedWorlds(JointWorlds):
    """Drives as SolverSteel has them by itself; they have no rows to read."""

    def _allocate_forces(self) -> tuple[Any, Any]:
        self._effort_limits = self._by_world(self._model.joint_effort_limit)
        zeros, size = import_warp().zeros, len(self._chains)
        return zeros((size, self._chains[0].cells), dtype=float), zeros((size, 0), dtype=float)

    def _read_forces(self) -> None:
        return


def test_a_drive_that_is_no_row_locks_its_joint_whatever_its_effort_limit(monkeypatch: pytest.MonkeyPatch) -> None:
    """SolverSteel's own mode of drives: it bounds the part of the damping that is not in the mass matrix."""
    monkeypatch.setattr("multibody_xval.engines.newton.worlds.JointWorlds", AugmentedWorlds)
    lane, state = lane_of(), State.at_rest(1, 7)
    rows, locked = (run(lane, state, drive_mode=mode) for mode in ("rows", "augmented"))
    assert distance(lane, state, rows) < ROUNDINGS
    assert distance(lane, state, locked) > 0.1
    assert np.max(np.abs(locked.relative_velocity)) < 1e-3 * np.max(np.abs(rows.relative_velocity))


def test_the_dry_friction_of_joints_is_there_on_graphics_cards_only() -> None:
    newton = import_newton()
    builder = newton.ModelBuilder()
    link = builder.add_link(mass=1.0, inertia=import_warp().mat33(*np.eye(3).ravel()))
    builder.add_articulation([builder.add_joint_prismatic(-1, link, friction=1.0)])
    with pytest.raises(NotImplementedError, match="enable_joint_friction=True; these features require CUDA"):
        newton.solvers.SolverSteel(builder.finalize(device="cpu"), enable_joint_friction=True)


class KaminoWorlds(JointWorlds):
    """Joints with a dry friction of their own, stepped by SolverKamino, of the first chain's bounds."""

    def _add_inner(self, builder: Any, outer: int, inner: int, cell: int) -> int:
        bound = float(self._chains[0].friction_bound[cell])
        return builder.add_joint_prismatic(outer, inner, axis=import_newton().Axis.X, friction=bound)

    def _allocate_forces(self) -> tuple[Any, Any]:
        self._kamino = import_newton().solvers.SolverKamino(self._model)
        zeros, size = import_warp().zeros, len(self._chains)
        return zeros((size, self._chains[0].cells), dtype=float), zeros((size, 0), dtype=float)

    def _set_forces(self) -> None:
        NewtonWorlds._set_forces(self)

    def _take_step(self) -> None:
        after = self._after
        self._kamino.step(self._before, after, self._control, None, self._time_step)
        import_newton().eval_ik(self._model, after, after.joint_q, after.joint_qd)

    def _read_forces(self) -> None:
        return


@pytest.mark.slow
def test_kamino_takes_the_step_of_the_scheme_too(monkeypatch: pytest.MonkeyPatch) -> None:
    """Its step takes 48 ms on a processor, and so a tenth of a period of one cell is all that is asked here."""
    monkeypatch.setattr("multibody_xval.engines.newton.worlds.JointWorlds", KaminoWorlds)
    chain = Chain.from_ratios(cells=1, friction_ratio=0.3, base_amplitude=AMPLITUDE)
    lane = Lane.periodic(chain, HarmonicBase.from_ratio(chain, 0.9, AMPLITUDE), STEPS)
    state = State(AMPLITUDE * np.array([[1.0, -0.5]]), AMPLITUDE * np.array([[20.0, -30.0]]))
    slips = scheme(lane, state, 40)[2] / chain.friction_bound
    assert 0 < np.sum(np.abs(slips) == 1) < slips.size
    assert distance(lane, state, run(lane, state, 40, units="SI")) < ROUNDINGS


@pytest.mark.parametrize(("symbol", "factor"), [("β", 1.01), ("ε", 1.1), ("s", 1.1)])
def test_anchors_draw_contacts_back_as_the_law_says(symbol: str, factor: float) -> None:
    """In a chain of a micrometre, whose spheres SolverSteel takes to be larger than they are: more counts as stick."""
    lane, law = chain_of(1e-3, 1.0, 1e-6), anchored()
    motion = Newton().build([lane], "contact", "default").run(State.at_rest(1, 7), 0, STEPS)[0]
    assert from_law(lane, law, motion) < ANCHORED_PERIOD / 10
    assert distance(lane, State.at_rest(1, 7), motion) > 10 * ANCHORED_PERIOD
    constant = law.constants[symbol]
    wrong = {**law.constants, symbol: dataclasses.replace(constant, value=factor * constant.value)}
    assert from_law(lane, dataclasses.replace(law, constants=wrong), motion) > ANCHORED_PERIOD / 2


@pytest.mark.parametrize(
    ("mass", "stiffness", "length"),
    [(1e-15, 1e6, 1e-9), (1e-3, 1e15, 1e-6), (1e-3, 1.0, 1e-6), (1.0, 1e3, 1.0), (1e5, 1e8, AMPLITUDE)],
)
def test_small_large_and_heavy_chains_step_by_the_law_of_the_default(
    mass: float, stiffness: float, length: float
) -> None:
    """Some so small that SolverSteel takes no motion of theirs for slip."""
    lane = chain_of(mass, stiffness, length)
    assert anchored().unmodelled_reason(lane) is None
    motion = Newton().build([lane], "contact", "default").run(State.at_rest(1, 7), 0, STEPS)[0]
    assert from_law(lane, anchored(), motion) < ANCHORED_PERIOD


def test_a_run_forgets_where_contacts_stuck_in_the_one_before() -> None:
    """Else they would be drawn back from where the next run puts them."""
    lane, rest = lane_of(5.0, 0.3), State.at_rest(1, 7)
    moved = State(np.repeat([0.0, 0.1 * AMPLITUDE], 7)[None], rest.velocities)
    simulation = Newton().build([lane], "contact", "default")
    simulation.advance(rest, 0, 50)
    fresh = Newton().build([lane], "contact", "default").run(moved, 0, 50)[0]
    assert_same_bits(simulation.run(moved, 0, 50)[0], fresh)


def test_a_contact_that_is_not_pressed_lets_go_of_its_anchor() -> None:
    """In a chain of a micrometre, every fourth step without a normal force."""
    lane = chain_of(1e-3, 1.0, 1e-6)
    fast = Preload(modulation=1.0, angular_frequency=np.pi / 2 / lane.time_step)
    pressed = dataclasses.replace(lane, preload=fast)
    assert np.sum(pressed.preloads(0, STEPS)[:, 0] == 0) == STEPS // 4
    motion = Newton().build([pressed], "contact", "default").run(State.at_rest(1, 7), 0, STEPS)[0]
    assert from_law(pressed, anchored(), motion) < ANCHORED_PERIOD / 10


def test_contacts_of_heavy_masses_sink_in_and_the_law_does_not_claim_them() -> None:
    lane = chain_of(1e7, 1e10, AMPLITUDE)
    assert anchored().unmodelled_reason(lane) == "contacts of 1e+07 kg sink in; allowed: at most 100000 kg"
    motion = Newton().build([lane], "contact", "default").run(State.at_rest(1, 7), 0, STEPS)[0]
    assert np.max(np.abs(motion.normal_force / lane.chain.normal_force - 1)) > 0.1
