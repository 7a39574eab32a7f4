"""Newton: what only its graph, its worlds, its single precision, its drives and its friction anchors do."""

import functools
from typing import Any

import numpy as np
import pytest

from multibody_xval.engines.newton import Newton
from multibody_xval.engines.newton.joint import JointWorlds
from multibody_xval.engines.newton.worlds import NewtonWorlds, import_newton
from multibody_xval.engines.shared.warp_worlds import import_warp
from reference_lcp.chain.drives import HarmonicBase
from reference_lcp.chain.mass_in_mass import Chain
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


def run(lane: Lane, state: State, steps: int = STEPS, formulation: str = "joint", **options: object) -> Trajectory:
    return built_with(Newton(), lane, formulation, **options).run(state, 0, steps)[0]


def chain_of(mass: float, stiffness: float, length: float, frequency_ratio: float = 0.9) -> Lane:
    chain = Chain.from_ratios(friction_ratio=0.3, outer_mass=mass, chain_stiffness=stiffness, base_amplitude=length)
    return Lane.periodic(chain, HarmonicBase.from_ratio(chain, frequency_ratio, length), STEPS)


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
    monkeypatch.setattr("multibody_xval.engines.newton.JointWorlds", AugmentedWorlds)
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
    monkeypatch.setattr("multibody_xval.engines.newton.JointWorlds", KaminoWorlds)
    chain = Chain.from_ratios(cells=1, friction_ratio=0.3, base_amplitude=AMPLITUDE)
    lane = Lane.periodic(chain, HarmonicBase.from_ratio(chain, 0.9, AMPLITUDE), STEPS)
    state = State(AMPLITUDE * np.array([[1.0, -0.5]]), AMPLITUDE * np.array([[20.0, -30.0]]))
    slips = scheme(lane, state, 40)[2] / chain.friction_bound
    assert 0 < np.sum(np.abs(slips) == 1) < slips.size
    assert distance(lane, state, run(lane, state, 40, units="SI")) < ROUNDINGS


@pytest.mark.parametrize(("beta", "moved"), [(0.0, False), (0.2, True)])
def test_anchors_draw_contacts_back(beta: float, moved: bool) -> None:
    """In a chain of a micrometre, whose spheres SolverSteel takes to be larger than they are: more counts as stick."""
    lane, rest = chain_of(1e-3, 1.0, 1e-6), State.at_rest(1, 7)
    motion = run(lane, rest, STEPS, "contact", units="SI", friction_anchor_beta=beta)
    apart = np.max(np.abs(motion.positions - scheme(lane, rest, STEPS)[0])) / 1e-6
    assert apart > 10 * ROUNDINGS if moved else apart < ROUNDINGS


def test_a_run_forgets_where_contacts_stuck_in_the_one_before() -> None:
    """Else they would be drawn back from where the next run puts them."""
    lane, rest = lane_of(5.0, 0.3), State.at_rest(1, 7)
    moved = State(np.repeat([0.0, 0.1 * AMPLITUDE], 7)[None], rest.velocities)
    simulation = Newton().build([lane], "contact", "default")
    simulation.advance(rest, 0, 50)
    fresh = Newton().build([lane], "contact", "default").run(moved, 0, 50)[0]
    assert_same_bits(simulation.run(moved, 0, 50)[0], fresh)


def test_contacts_of_heavy_masses_sink_in() -> None:
    lane = chain_of(1e7, 1e10, AMPLITUDE)
    motion = Newton().build([lane], "contact", "default").run(State.at_rest(1, 7), 0, STEPS)[0]
    assert np.max(np.abs(motion.normal_force / lane.chain.normal_force - 1)) > 0.1
