"""Which configurations a name stands for, and what of it has to be installed."""

import pytest

from multibody_xval.engines.interface.variant import variants_named
from multibody_xval.engines.mujoco import MuJoCo
from reference_lcp.errors import ParameterError


def named(*names: str) -> list[str]:
    return list(map(str, variants_named(names)))


@pytest.mark.parametrize(
    ("name", "variants"),
    [
        ("mujoco", "mujoco"),
        ("mujoco:all", "mujoco mujoco:contact"),
        ("mujoco:joint:all", "mujoco mujoco:joint:default"),
        ("mujoco:all:all", "mujoco mujoco:joint:default mujoco:contact mujoco:contact:newton mujoco:contact:default"),
        ("mujoco:all:recommended", "mujoco:joint:recommended mujoco:contact:recommended"),
    ],
)
def test_parts_that_are_left_out_are_joint_and_tuned_and_all_is_every_one(name: str, variants: str) -> None:
    assert named(name) == variants.split()


def test_all_engines_are_each_joint_and_tuned_and_a_name_counts_once() -> None:
    assert {(each.formulation, each.preset_name) for each in variants_named(["all"])} == {("joint", "tuned")}
    assert {"mujoco:joint:recommended", "pybullet:contact:recommended"} <= set(named("all:all:recommended"))
    assert named("mujoco", "mujoco:all", "mujoco:joint:tuned") == ["mujoco", "mujoco:contact"]


@pytest.mark.parametrize(
    ("name", "message"),
    [
        ("mujoco:all:best", "preset of mujoco = 'best' is unknown; allowed: tuned, recommended, default, newton"),
        ("mujoco:glue:all", "formulation of mujoco = 'glue' is unknown; allowed: joint, contact"),
        ("all:joint:best", "preset of all = 'best' is unknown"),
        ("mujoco:all:noslip_iterations=3", "sets noslip_iterations=3 in several variants; allowed: in one"),
        ("mujocko:all", "engine = 'mujocko' is unknown"),
    ],
)
def test_a_selection_of_nothing_is_refused(name: str, message: str) -> None:
    with pytest.raises(ParameterError, match=message):
        variants_named([name])


@pytest.mark.parametrize("name", ["mujoco", "mujoco:all:all", "mujoco:noslip_iterations=3"])
def test_a_named_engine_that_is_missing_is_refused_and_one_of_all_is_not(name, monkeypatch) -> None:
    monkeypatch.setattr(MuJoCo, "unavailable_reason", lambda _: "no wheel; pip install mujoco")
    with pytest.raises(ParameterError, match="engine = mujoco is not installed: no wheel; pip install mujoco"):
        variants_named([name])
    assert "mujoco" in named("all")
