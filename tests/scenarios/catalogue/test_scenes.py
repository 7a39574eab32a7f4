"""Scenes as users write them: closed forms, and engines that are wrong by little."""

import math
from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest

from multibody_xval.engines.interface.scene import GRAVITY, ArmScene, Box, ContactScene, JointScene, SteppedWorld
from multibody_xval.scenarios.catalogue.registry import CATALOGUE
from multibody_xval.scenarios.catalogue.scenes import base
from multibody_xval.scenarios.catalogue.scenes.base import COMMON_STEP, CREEP, SceneScenario
from multibody_xval.scenarios.catalogue.scenes.hold import HEAVY, STACK_SLOPE
from multibody_xval.scenarios.catalogue.scenes.joints import TURNING, arm
from multibody_xval.scenarios.catalogue.scenes.spin import CORNERS, TORQUE, UNIFORM
from multibody_xval.scenarios.runs.scene import SceneTask
from multibody_xval.scenarios.verdicts.finding import Finding, Verdict
from reference_lcp.errors import ParameterError
from tests.scenarios.in_process import findings
from tests.scenarios.point_mass import CONTACT, JOINT, judged

SCENES = [scenario for scenario in CATALOGUE.values() if isinstance(scenario, SceneScenario)]
HOLDING = ("slope-hold", "stack-hold", "heavy-on-light", "grip", "held-while-shaken", "joint-hold", "arm-hold")
SLIDING = ("slope-slide", "slide-to-stop", "conveyor")

needs_mujoco = pytest.mark.needs("mujoco")


def each_of(names):
    """Parametrise a test: by default a box that may slide and a joint that may turn."""
    slow = [[] if name in ("slope-hold", "arm-hold") else [pytest.mark.slow] for name in names]
    return pytest.mark.parametrize(
        "name", [pytest.param(name, marks=own) for name, own in zip(names, slow, strict=True)]
    )


def disagreeing(found: list[Finding]) -> list[Finding]:
    return [finding for finding in found if finding.comparison.verdict is not Verdict.AGREE]


@pytest.mark.parametrize("scenario", SCENES, ids=lambda each: each.name)
def test_coulomb_s_law_in_euler_s_steps_agrees_with_every_scene(scenario) -> None:
    assert not disagreeing(judged(scenario))


@each_of(HOLDING)
def test_creep_of_a_micrometre_a_second_is_found_in_everything_that_should_hold(name) -> None:
    found = [each for each in judged(CATALOGUE[name], creep=1e-6) if each.metric in (CREEP, TURNING)]
    assert disagreeing(found) == found


@pytest.mark.slow
@pytest.mark.parametrize("wrong", [{"friction": 0.99}, {"normal": 1.01}], ids=["less friction", "pressed harder"])
@pytest.mark.parametrize("name", SLIDING)
def test_friction_that_is_wrong_by_a_hundredth_is_found_in_everything_that_slides(name, wrong) -> None:
    """Where Euler's own step is a smaller error than that: at 1 ms, and not at 1 m/s."""
    found = [each for each in judged(CATALOGUE[name], **wrong) if each.case.endswith("1 ms")]
    wrong_ones = {each.case for each in disagreeing(found)}
    slow = {each.case for each in found if each.case.startswith("1 m/s, 1 ms")}
    assert wrong_ones | slow == {each.case for each in found}
    assert wrong_ones


@pytest.mark.parametrize(("friction", "sound"), [(1.01, False), (1.0, True), (UNIFORM / CORNERS, True), (0.53, False)])
def test_torque_that_no_pressure_can_make_is_found(friction, sound) -> None:
    """More than at the corners, or less than under a uniform pressure: the latter is 0.541 of the former."""
    found = [each for each in judged(CATALOGUE["spin"], friction=friction) if each.case.endswith("1 ms")]
    assert {each.metric for each in disagreeing(found)} == (set() if sound else {TORQUE})


def test_drift_after_the_stop_is_found() -> None:
    found = judged(CATALOGUE["slide-to-stop"], creep=1e-6)
    assert {each.metric.name for each in disagreeing(found)} == {"drift"}


@each_of([name for name in HOLDING if name not in ("joint-hold", "held-while-shaken")])
def test_what_falls_at_once_and_rests_is_found(name) -> None:
    """It does not creep when that is measured."""
    found = judged(CATALOGUE[name], fall=0.01)
    assert {each.metric.name for each in disagreeing(found)} <= {"sag", "turned"}
    assert disagreeing(found)


@needs_mujoco
def test_mujoco_s_joint_creeps_by_its_own_law() -> None:
    """A (1 − d_0) / d_0 · load · d_max τ / 2, with its own d_0 = 0.9, d_max = 0.95 and τ = 20 ms."""
    for finding in findings(CATALOGUE["joint-hold"], JOINT):
        load = float(finding.case.split("load ")[1].split(",")[0]) * (1.0 if "hinge" in finding.case else 5.0)
        assert finding.value == pytest.approx(1e6 * (1 - 0.9) / 0.9 * load * 0.95 * 0.02 / 2, rel=1e-5)


@needs_mujoco
def test_box_creeps_in_mujoco_as_one_writes_it_and_hardly_with_the_recommended_options() -> None:
    worst = {}
    for preset in ("default", "recommended"):
        found = findings(CATALOGUE["slope-hold"], replace(CONTACT, preset_name=preset))
        worst[preset] = max(each.value for each in found if each.metric == CREEP)
    assert worst["default"] > 1000
    assert worst["recommended"] < 1


@needs_mujoco
def test_exploding_scene_is_a_failure_of_the_engine(monkeypatch) -> None:
    def exploding(task) -> SteppedWorld:
        return SteppedWorld(lambda: None, lambda: (np.full(10, np.nan),))

    monkeypatch.setattr("multibody_xval.scenarios.runs.scene.built", exploding)
    found = findings(CATALOGUE["grip"], CONTACT)
    assert {each.comparison.verdict for each in found} == {Verdict.DISAGREE}
    assert "exploded" in found[0].comparison.reason


def test_presets_for_the_chain_have_no_scenes() -> None:
    found = findings(CATALOGUE["grip"], replace(CONTACT, preset_name="tuned"))
    assert {each.comparison.verdict for each in found} == {Verdict.BLOCKED}
    assert "is for the chain; allowed in scenes: default, recommended" in found[0].comparison.reason


BAD: list[tuple[Callable[[], object], str]] = [
    (lambda: ContactScene(slope=math.radians(95)), "slope = 95°; allowed: >= 0 and < 90°"),
    (lambda: Box(mass=-1.0), "mass = -1.*allowed: > 0"),
    (lambda: ContactScene(grip=1.0, boxes=(Box(), Box())), "boxes = 2; allowed: 1 in a grip"),
    (lambda: JointScene(kind="ball"), "kind = 'ball' is unknown; allowed: hinge, slide"),
    (lambda: ArmScene(friction=()), "friction = .*at least one"),
    (lambda: SceneTask(variant=JOINT, scene=JointScene(), time_step=0.0, time=1.0), "time_step = 0.*allowed: > 0"),
]


@pytest.mark.parametrize(("build", "message"), BAD)
def test_scene_that_cannot_be_is_refused(build, message) -> None:
    with pytest.raises(ParameterError, match=message):
        build()


def test_scenes_are_what_their_names_say() -> None:
    heavy = CATALOGUE["heavy-on-light"].cases[0].scene
    assert [box.mass for box in heavy.boxes] == [1.0, HEAVY]
    assert heavy.slope == STACK_SLOPE
    assert arm(1, 0.9).friction == pytest.approx([GRAVITY * 0.1 / 0.9])
    assert arm(2, 1.0).friction == pytest.approx([GRAVITY * (0.1 + 0.3), GRAVITY * 0.1])
    heights = [place[2] for place in ContactScene(boxes=(Box(side=0.2), Box(side=0.1))).places]
    assert heights == pytest.approx([0.1, 0.25])
    assert COMMON_STEP == 1e-3


@pytest.mark.parametrize("name", SLIDING[1:])
def test_scene_in_steps_as_long_as_its_motion_shows_nothing(name, monkeypatch) -> None:
    """At 1 m/s, 50 ms are a quarter of the time that friction takes: half of it or all of it is left open."""
    monkeypatch.setattr(base, "COMMON_STEP", 0.05)
    found = [each for each in judged(CATALOGUE[name]) if each.case.endswith("50 ms") and each.metric.unit == "%"]
    assert Verdict.TOO_COARSE in {each.comparison.verdict for each in found}
    assert Verdict.AGREE not in {each.comparison.verdict for each in found if each.case.startswith("1 m/s")}
