"""Steady states, motions and scenes: each is one text, one key, and runs through the same door."""

import math
import pickle
from dataclasses import replace

import numpy as np
import pytest

from multibody_xval.engines.interface.scene import Box, ContactScene, Shaker, SteppedWorld
from multibody_xval.scenarios.cases.carrier_drives import Vibration
from multibody_xval.scenarios.cases.motions import Block, BlockMotion, ChainMotion
from multibody_xval.scenarios.cases.scene_motion import SceneMotion, Tone
from multibody_xval.scenarios.catalogue.all_scenarios import SCENARIOS
from multibody_xval.scenarios.compute.batch import run_batch
from multibody_xval.scenarios.compute.scenes import followed
from multibody_xval.scenarios.model import REFERENCE, Case, Config, Run, Status
from reference_lcp.chain.drives import HarmonicForce, StillBase
from reference_lcp.chain.transient import RecordedBase, SweptSine
from reference_lcp.errors import ParameterError

DECAY = ChainMotion(
    friction_ratio=(0.1, 0.2), cells=2, drive=StillBase(0.01), time=1.0, rows=50, recorded="decay", shape="stretched"
)
THROW = BlockMotion(
    block=Block(mass=1.0, normal_force=9.8, stiffness=3.0), drive=Vibration(0.1, 0.01, 5.0), time=0.5, rows=50
)
RECORD = RecordedBase((0.0, 1.0, 2.0, 3.0), (0.0, 1e-3, 0.0, 1e-3))

CASES = [
    Case(friction_ratio=0.3, frequency_ratio=0.9),
    DECAY,
    THROW,
    ChainMotion(friction_ratio=0.1, drive=SweptSine(0.01, 1.0, 20.0, 3.0), time=3.0, rows=30),
    BlockMotion(block=THROW.block, drive=HarmonicForce(1.0, 2.0, 0.1), time=0.5, rows=50, static_ratio=1.5),
    ChainMotion(friction_ratio=0.1, drive=HarmonicForce(1.0, 2.0), time=3.0, rows=30, shape="stretched"),
    SceneMotion(
        scene=ContactScene(boxes=(Box(), Box(mass=2.0)), shaker=Shaker()),
        time=1.0,
        shake=(Tone(force=1.0, frequency=2.0),),
    ),
    *(case for scenario in SCENARIOS.values() for case in scenario.cases.values()),
]  # fmt: skip


def test_a_run_is_read_back_from_its_text_and_other_cases_are_other_runs() -> None:
    runs = [Run(REFERENCE, case, 400) for case in CASES]
    for run in runs:
        again = Run.from_text(run.text)
        assert again == run
        assert hash(again) == hash(run)
        assert again.text == run.text
        assert pickle.loads(pickle.dumps(run)) == run
        assert again.case.title == run.case.title
    assert len({run.text for run in runs}) == len(set(runs)) == len(CASES)


def test_a_motion_along_a_users_record_comes_back_by_its_hash_and_does_not_run() -> None:
    case = ChainMotion(friction_ratio=0.1, drive=RECORD, time=2.0, rows=20)
    again = Run.from_text(Run(REFERENCE, case, 400).text)
    assert again == Run(REFERENCE, case, 400)
    assert again.case.title == case.title
    assert run_batch([Run(REFERENCE, case, 400)])[0].status is Status.FINISHED
    (result,) = run_batch([again])
    assert result.status is Status.UNSUPPORTED
    assert "record with SHA-256" in result.reason


def test_rows_of_motions_are_at_the_same_times_whatever_the_steps_and_other_steps_are_refused() -> None:
    coarse, fine, wrong = (run_batch([Run(REFERENCE, DECAY, steps)])[0] for steps in (400, 800, 75))
    assert len(coarse.series["swing"]) == len(fine.series["swing"]) == DECAY.rows
    assert DECAY.row_times[[0, -1]] == pytest.approx([0.02, 1.0])
    assert wrong.status is Status.UNSUPPORTED
    assert "steps = 75 are no multiple of rows = 50; allowed: multiples" in wrong.reason
    with pytest.raises(ParameterError, match="time = 0"):
        replace(DECAY, time=0.0)


def world(*rows: tuple[float, ...]) -> SteppedWorld:
    states = iter(rows)
    return SteppedWorld(step=lambda: None, state=lambda: next(states))


STILL = (0.0, 0.0, 0.1, 1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0)


def test_a_scene_that_explodes_fails() -> None:
    case = SceneMotion(scene=ContactScene(), time=1.0)
    result = followed(case, 2, world(STILL, (1e6, *STILL[1:])))
    assert (result.status, result.reason) == (Status.FAILED, "the scene exploded")
    assert followed(case, 2, world(STILL, (math.nan, *STILL[1:]))).status is Status.FAILED


def test_ways_of_a_box_count_from_where_it_has_settled() -> None:
    case = SceneMotion(scene=ContactScene(), time=1.0, settling=0.5)
    rows = [(x, *STILL[1:]) for x in (0.001, 0.002, 0.004)]
    result = followed(case, 2, world(*rows))
    assert np.allclose(result.series["along"], [0.001, 0.003])
    assert result.series["from the start"] == pytest.approx((0.004, 0.0, 0.0), abs=1e-12)
    assert result.series["time"] == (0.5, 1.0)


def test_a_preset_of_the_chain_has_no_scenes() -> None:
    (result,) = run_batch([Run(Config("mujoco", "contact"), SceneMotion(scene=ContactScene(), time=1.0), 100)])
    assert result.status is Status.UNSUPPORTED
    assert result.reason == "preset = tuned is for the chain; allowed in scenes: default, recommended"
