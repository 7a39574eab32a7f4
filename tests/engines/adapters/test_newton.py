"""Newton: what only its constraints, its drives and its friction anchors do."""

import functools
from typing import Any

import numpy as np
import pytest

from multibody_xval.engines.interface.registry import engine
from multibody_xval.engines.interface.scene import GRAVITY, Box, ContactScene, SceneSetting
from multibody_xval.engines.newton.scene import STEP
from multibody_xval.engines.newton.worlds import import_newton
from multibody_xval.engines.shared.warp_worlds import import_warp
from reference_lcp.chain.drives import HarmonicBase
from reference_lcp.chain.mass_in_mass import Chain
from reference_lcp.chain.simulation import Lane
from reference_lcp.chain.trajectory import State
from tests.engines.scheme_oracle import AMPLITUDE, ROUNDINGS, STEPS, chain_of, distance, run, scheme

pytestmark = pytest.mark.needs("newton")


@pytest.mark.parametrize(("formulation", "cells"), [("joint", 40), ("contact", 12)])
def test_chains_with_more_constraints_than_the_solver_has_room_for_by_itself(
    formulation: str, cells: int, monkeypatch: pytest.MonkeyPatch, capfd: pytest.CaptureFixture[str]
) -> None:
    """It has room for 32, of all cells; what does not fit is left out, which it says on standard output."""
    chain = Chain.from_ratios(cells=cells, friction_ratio=0.3)
    lane = Lane.periodic(chain, HarmonicBase.from_ratio(chain, 0.9), STEPS)
    state = State(*AMPLITUDE * np.random.default_rng(4).normal(size=(2, 1, 2 * cells)))
    assert distance(lane, state, run(f"newton:{formulation}", lane, state)) < ROUNDINGS
    assert capfd.readouterr() == ("", "")
    solvers = import_newton().solvers
    short = functools.partial(_with_options, solvers.SolverSteel, {"articulation_constraint_max": 32})
    monkeypatch.setattr(solvers, "SolverSteel", short)
    assert distance(lane, state, run(f"newton:{formulation}", lane, state)) > 0.01
    assert "constraint-row overflow" in capfd.readouterr().out


def _with_options(solver: Any, own: dict[str, Any], model: Any, **options: Any) -> Any:
    return solver(model, **{**options, **own})


def test_the_dry_friction_of_joints_is_there_on_graphics_cards_only() -> None:
    newton = import_newton()
    builder = newton.ModelBuilder()
    link = builder.add_link(mass=1.0, inertia=import_warp().mat33(*np.eye(3).ravel()))
    builder.add_articulation([builder.add_joint_prismatic(-1, link, friction=1.0)])
    with pytest.raises(NotImplementedError, match="enable_joint_friction=True; these features require CUDA"):
        newton.solvers.SolverSteel(builder.finalize(device="cpu"), enable_joint_friction=True)


@pytest.mark.parametrize(("beta", "moved"), [(0.0, False), (0.2, True)])
def test_anchors_draw_contacts_back(beta: float, moved: bool) -> None:
    """In a chain of a micrometre, whose spheres SolverSteel takes to be larger than they are: more counts as stick."""
    lane, rest = chain_of(1e-3, 1.0, 1e-6), State.at_rest(1, 7)
    motion = run("newton:contact", lane, rest, units="SI", friction_anchor_beta=beta)
    apart = np.max(np.abs(motion.positions - scheme(lane, rest, STEPS)[0])) / 1e-6
    assert apart > 10 * ROUNDINGS if moved else apart < ROUNDINGS


def places(preset: str, scene: ContactScene, time: float) -> np.ndarray:
    """Follow a box of a scene, shape (steps, 3) [m]."""
    newton = engine("newton")
    world = newton.scene_world(scene, SceneSetting(newton.preset("contact", preset), STEP))
    return world.run(round(time / STEP))[:, :3]


SLOPE = ContactScene(slope=0.25)
"""A load of half of what the friction holds."""


@pytest.mark.slow
def test_a_box_creeps_under_the_friction_of_single_sweeps_and_less_with_more() -> None:
    """In SolverXPBD by millimetres a second, at half of what the friction holds; it rests in SolverSteel.

    In SolverKamino it comes to rest: it still creeps by 0.07 mm/s in the half second that is watched here.
    """
    drifts = []
    for preset in ("xpbd", "xpbd:iterations=10", "default", "kamino"):
        motion = places(preset, SLOPE, 1.0)
        drifts.append(float(np.linalg.norm(motion[-1] - motion[len(motion) // 2])) / 0.5)
    assert drifts[0] > 3 * drifts[1] > 1e-3
    assert drifts[2] < 1e-6
    assert drifts[3] < drifts[1] / 10


@pytest.mark.slow
@pytest.mark.parametrize("stiffness", [2.5e3, 1e4])
def test_a_box_of_vbd_rests_on_the_springs_of_its_four_corners(stiffness: float) -> None:
    scene = ContactScene(boxes=(Box(mass=2.0),))
    sag = scene.places[0][2] - places(f"vbd:ke={stiffness}", scene, 2.0)[-1, 2]
    assert sag == pytest.approx(2.0 * GRAVITY / (4 * stiffness), rel=0.05)
