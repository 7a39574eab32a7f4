"""Steady states, motions and scenes: each is one text, one key, and runs through the same door."""

import math
import pickle
from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest

from multibody_xval.engines.interface.scene import ArmScene, Box, ContactScene, Shaker, SteppedWorld
from multibody_xval.scenarios.cases.motions import Block, BlockMotion, ChainMotion
from multibody_xval.scenarios.cases.scene_motion import SceneMotion, Tone
from multibody_xval.scenarios.catalogue.all_scenarios import SCENARIOS
from multibody_xval.scenarios.compute.batch import run_batch
from multibody_xval.scenarios.compute.scenes import followed
from multibody_xval.scenarios.model import REFERENCE, Case, Config, Run, Status
from reference_lcp.chain.drives import HarmonicForce, StillBase
from reference_lcp.chain.transient import RecordedBase, SweptSine
from reference_lcp.errors import ParameterError

STEADY = Case(friction_ratio=0.3, frequency_ratio=0.9)
DECAY = ChainMotion(
    friction_ratio=(0.1, 0.2), cells=2, drive=StillBase(0.01), time=1.0, rows=50, recorded="decay", shape="stretched"
)
BLOCK = Block(mass=1.0, normal_force=9.8, stiffness=3.0)
SHAKING = HarmonicForce(1.0, 2.0, 0.1)
SHAKEN = ContactScene(boxes=(Box(), Box(mass=2.0)), shaker=Shaker())

CASES = [
    STEADY,
    DECAY,
    ChainMotion(friction_ratio=0.1, drive=SweptSine(0.01, 1.0, 20.0, 3.0), time=3.0, rows=30),
    ChainMotion(friction_ratio=0.1, drive=HarmonicForce(1.0, 2.0), time=3.0, rows=30, shape="stretched"),
    SceneMotion(scene=SHAKEN, time=1.0, shake=(Tone(force=1.0, frequency=2.0),)),
    *(case for scenario in SCENARIOS.values() for case in scenario.cases.values()),
]


def test_a_run_is_read_back_from_its_text_and_other_cases_are_other_runs() -> None:
    runs = [Run(REFERENCE, case, 400) for case in CASES]
    for run in runs:
        again = Run.from_text(run.text)
        assert again == run == pickle.loads(pickle.dumps(run))
        assert (hash(again), again.text, again.case.title) == (hash(run), run.text, run.case.title)
    assert len({run.text for run in runs}) == len(set(runs)) == len(CASES)


@pytest.mark.needs("mujoco")
def test_a_steady_state_is_the_same_beside_a_normal_force_that_swings() -> None:
    """In MuJoCo contacts move across then, and the state of the other lane would have that motion too."""
    still = Case(friction_ratio=0.1, frequency_ratio=1.4)
    runs = [Run(Config("mujoco", "contact"), case, 800) for case in (still, replace(still, modulation=0.5))]
    (alone,), (beside, _) = run_batch(runs[:1]), run_batch(runs)
    assert (beside.status, beside.periods, beside.residual) == (alone.status, alone.periods, alone.residual)
    assert beside.status is Status.PERIODIC


def test_a_motion_along_a_users_record_comes_back_by_its_hash_and_does_not_run() -> None:
    record = RecordedBase((0.0, 1.0, 2.0, 3.0), (0.0, 1e-3, 0.0, 1e-3))
    run = Run(REFERENCE, ChainMotion(friction_ratio=0.1, drive=record, time=2.0, rows=20), 400)
    again = Run.from_text(run.text)
    assert (again, again.case.title) == (run, run.case.title)
    first, second = run_batch([run])[0], run_batch([again])[0]
    assert (first.status, second.status) == (Status.FINISHED, Status.UNSUPPORTED)
    assert "record with SHA-256" in second.reason


def test_rows_of_motions_are_at_the_same_times_whatever_the_steps_and_other_steps_are_refused() -> None:
    coarse, fine, wrong = (run_batch([Run(REFERENCE, DECAY, steps)])[0] for steps in (400, 800, 75))
    assert len(coarse.series["swing"]) == len(fine.series["swing"]) == DECAY.rows
    assert DECAY.row_times[[0, -1]] == pytest.approx([0.02, 1.0])
    assert wrong.status is Status.UNSUPPORTED
    assert "steps = 75 are no multiple of rows = 50; allowed: multiples" in wrong.reason


BAD: list[tuple[Callable[[], object], str]] = [
    (lambda: BlockMotion(block=BLOCK, drive=SHAKING, time=0.5, rows=50, static_ratio=0.9).lane(200), "static_ratio"),
    (lambda: replace(STEADY, modulation=0.5, modulation_multiple=0), "modulation_multiple = 0 "),
    (lambda: ContactScene(slope=math.radians(95)), "slope = 95°; allowed: >= 0 and < 90°"),
    (lambda: ArmScene(friction=()), "friction = .*at least one"),
]


@pytest.mark.parametrize(("build", "message"), BAD)
def test_a_case_that_cannot_be_is_refused_with_its_value(build, message) -> None:
    with pytest.raises(ParameterError, match=message):
        build()


STILL = (0.0, 0.0, 0.1, 1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0)


def at(*places: float) -> SteppedWorld:
    """Give a world in which a box is at these places along the plane."""
    states = iter([(x, *STILL[1:]) for x in places])
    return SteppedWorld(step=lambda: None, state=lambda: next(states))


def test_ways_of_a_box_count_from_where_it_has_settled_and_a_scene_that_explodes_fails() -> None:
    result = followed(SceneMotion(scene=ContactScene(), time=1.0, settling=0.5), 2, at(0.001, 0.002, 0.004))
    assert np.allclose(result.series["along"], [0.001, 0.003])
    assert result.series["from the start"] == pytest.approx((0.004, 0.0, 0.0), abs=1e-12)
    assert result.series["time"] == (0.5, 1.0)
    for place in (1e6, math.nan):
        exploded = followed(SceneMotion(scene=ContactScene(), time=1.0), 2, at(0.0, place))
        assert (exploded.status, exploded.reason) == (Status.FAILED, "the scene exploded")
