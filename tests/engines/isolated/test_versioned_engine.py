"""A version in an environment of its own moves as the one beside the suite, under another name, and dies alone."""

import dataclasses
import os
import signal
import time
from pathlib import Path

import numpy as np
import pytest

from engines.interface.engine import EngineNotInstalled
from engines.interface.presets import Formulation, Preparation, Preset
from engines.interface.registry import engine
from engines.interface.scene import ArmScene, ContactScene, JointScene, Scene, SceneSetting, formulation_of
from engines.interface.variant import Variant
from engines.isolated.environment import Environment
from engines.isolated.installation import Plan, install
from engines.isolated.process import EngineProcessError
from engines.isolated.versioned_engine import Requirement, engine_of_its_own_environment
from engines.mujoco import MuJoCo
from engines.shared.pip_engine import PipEngine
from reference_lcp.chain.simulation import Lane, Simulation
from reference_lcp.chain.trajectory import State
from reference_lcp.errors import ParameterError
from tests.engines.scheme_oracle import lane_of, random_state

BESIDE, OWN = Variant("mujoco"), Variant("mujoco@3.99.0")

pytestmark = pytest.mark.usefixtures("installed_versions")


@pytest.mark.parametrize("formulation", ["joint", "contact"])
def test_lanes_in_an_environment_move_as_beside_the_suite(formulation: str) -> None:
    lanes = [lane_of(), lane_of()]
    beside, own = (dataclasses.replace(each, formulation=formulation).build(lanes) for each in (BESIDE, OWN))
    one = random_state()
    state = State(np.tile(one.positions, (2, 1)), np.tile(one.velocities, (2, 1)))
    for expected, moved in zip(beside.run(state, 3, 20), own.run(state, 3, 20), strict=True):
        for name in ("time", "positions", "velocities", "friction", "normal_force"):
            assert np.array_equal(getattr(moved, name), getattr(expected, name))
    assert np.array_equal(own.advance(state, 3, 20).positions, beside.advance(state, 3, 20).positions)
    own.close()
    assert np.array_equal(own.subset([1]).run(one, 0, 5)[0].positions, beside.subset([1]).run(one, 0, 5)[0].positions)


SCENES = (
    ContactScene(slope=0.4),
    JointScene(kind="slide", load=0.9),
    ArmScene(friction=(2.0, 1.0)),
)


@pytest.mark.parametrize("scene", SCENES, ids=lambda scene: type(scene).__name__)
@pytest.mark.parametrize("preset", ["default", "recommended", "default:solver=PGS"])
def test_scenes_in_an_environment_move_as_beside_the_suite(scene: Scene, preset: str) -> None:
    rows = []
    for variant in (BESIDE, OWN):
        adapter, formulation = engine(variant.engine), formulation_of(scene)
        world = adapter.scene_world(scene, SceneSetting(adapter.preset(formulation, preset), adapter.scene_step))
        first = world.run(20)
        if isinstance(scene, ContactScene):
            world.launch((1.0, 0.5, 0.0), 2.0)
        rows.append(np.concatenate([first, world.run(30)]))
        world.close()
    assert np.array_equal(*rows)
    assert np.ptp(rows[0], axis=0).max() > 0


def test_a_scene_that_was_lost_with_its_worker_does_not_begin_anew_in_silence() -> None:
    adapter = engine(OWN.engine)
    world = adapter.scene_world(SCENES[0], SceneSetting(adapter.preset("contact", "default"), 0.002))
    world.run(5)
    process = adapter._process()
    os.kill(process.pid, signal.SIGKILL)
    while process.alive():
        time.sleep(0.01)
    with pytest.raises(EngineProcessError, match="a scene was lost with its worker"):
        world.run(5)


def test_what_the_adapter_refuses_there_is_refused_here() -> None:
    state = random_state()
    far = State(1e300 * state.positions, state.velocities)
    with pytest.raises(ParameterError, match=r"^initial positions reach .*; allowed by MuJoCo: "):
        OWN.build([lane_of()]).run(far, 0, 1)


def test_a_lost_worker_is_started_anew() -> None:
    simulation = OWN.build([lane_of()])
    before = simulation.run(random_state(), 0, 5)[0]
    os.kill(simulation._process.pid, signal.SIGKILL)
    while simulation._process.alive():
        time.sleep(0.01)
    assert np.array_equal(simulation.run(random_state(), 0, 5)[0].positions, before.positions)


def test_version_and_python_are_those_of_the_environment() -> None:
    own = engine(OWN.engine)
    record = Environment(OWN.engine).record()
    assert record is not None
    assert (own.version(), own.python()) == ("3.99.0", record.python)
    assert own.capabilities.title == "MuJoCo 3.99.0"
    assert own.capabilities.optional
    assert own.host == OWN.engine
    assert OWN.law is None
    default = dataclasses.replace(OWN, preset_name="default")
    assert default.law == Variant("mujoco@law", "joint", "default")


def test_the_version_beside_the_suite_needs_no_environment() -> None:
    version = MuJoCo().version()
    own = engine(f"mujoco@{version}")
    assert own.unavailable_reason() is None
    assert own.version() == version
    assert own.name == f"mujoco@{version}"


@pytest.mark.parametrize("text", ["mujoco@3.98.0", "mujoco@3.98.0:contact", "mujoco@3.98.0:joint:default"])
def test_a_version_that_is_not_there_names_the_command_that_installs_it(text: str) -> None:
    with pytest.raises(ParameterError, match=r"is not installed; multibody-xval engines install mujoco@3\.98\.0$"):
        Variant.parse(text)
    assert Variant.recorded(text).engine == "mujoco@3.98.0"


def test_a_version_that_the_adapter_does_not_take_names_those_that_it_does() -> None:
    with pytest.raises(ParameterError, match=r"mujoco@3\.3\.6'.*; allowed: mujoco >=3\.3\.7,<5"):
        Variant.parse("mujoco@3.3.6")


class Absent(PipEngine):
    """MuJoCo, as an adapter whose package is not beside the suite."""

    name = "absent"
    module = "no_such_module"
    capabilities = MuJoCo.capabilities


def test_an_engine_that_is_not_beside_the_suite_runs_in_its_environment() -> None:
    assert engine_of_its_own_environment(Absent()) is None
    folder = Environment("absent").folder
    folder.symlink_to(Environment(OWN.engine).folder)
    own = engine_of_its_own_environment(Absent())
    assert own is not None
    assert (own.name, own.version(), own.unavailable_reason()) == ("absent", "3.99.0", None)
    folder.unlink()


class Apart(PipEngine):
    """MuJoCo, as an adapter that must not run beside the suite."""

    name = "apart"
    module = "mujoco"
    apart = True
    capabilities = MuJoCo.capabilities
    preparation = Preparation("compiles", 1.0)

    def _build(self, lanes: tuple[Lane, ...], formulation: Formulation, preset: Preset) -> Simulation:
        return MuJoCo().build(lanes, str(formulation))


def test_an_engine_that_does_not_fit_beside_the_suite_runs_in_its_environment_alone() -> None:
    with pytest.raises(EngineNotInstalled, match=r"an environment of its own; multibody-xval engines install apart$"):
        Apart().build([lane_of()])
    folder = Environment("apart").folder
    folder.symlink_to(Environment(OWN.engine).folder)
    own = engine_of_its_own_environment(Apart())
    assert own is not None
    assert own.preparation == Apart.preparation
    state = random_state()
    moved, expected = (each.build([lane_of()]).run(state, 0, 5)[0].positions for each in (own, MuJoCo()))
    assert np.array_equal(moved, expected)
    folder.unlink()


def test_a_newer_version_under_the_same_name_is_another_engine(folder: Path) -> None:
    install(Plan.of(Requirement.of(MuJoCo(), "4.99")))
    assert engine("mujoco@4.99").version() == "4.99.0"
