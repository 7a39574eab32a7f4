"""Which variants a name stands for, and what of it has to be installed."""

import pytest

from multibody_xval.engines.interface.engine import Engine
from multibody_xval.engines.interface.registry import engine
from multibody_xval.engines.interface.variant import variants_named
from multibody_xval.engines.mujoco import MuJoCo
from reference_lcp.errors import ParameterError


@pytest.mark.parametrize(
    ("name", "variants"),
    [
        ("mujoco", ["mujoco"]),
        ("mujoco:all", ["mujoco", "mujoco:contact"]),
        ("mujoco:joint:all", ["mujoco", "mujoco:joint:default"]),
        (
            "mujoco:all:all",
            ["mujoco", "mujoco:joint:default", "mujoco:contact", "mujoco:contact:newton", "mujoco:contact:default"],
        ),
        ("mujoco:joint:recommended", ["mujoco:joint:recommended"]),
        ("mujoco:all:recommended", ["mujoco:joint:recommended", "mujoco:contact:recommended"]),
    ],
)
def test_parts_that_are_left_out_are_joint_and_tuned_and_all_is_every_one(name: str, variants: list[str]) -> None:
    assert list(map(str, variants_named([name]))) == variants


def test_all_engines_are_each_joint_and_tuned() -> None:
    assert {(each.formulation, each.preset_name) for each in variants_named(["all"])} == {("joint", "tuned")}


def test_a_preset_of_all_engines_is_named_though_it_is_optional() -> None:
    listed = set(map(str, variants_named(["all:all:recommended"])))
    assert {"mujoco:joint:recommended", "pybullet:contact:recommended"} <= listed
    assert {name.rpartition(":")[2] for name in listed} == {"recommended"}


def test_variants_are_named_once() -> None:
    assert list(map(str, variants_named(["mujoco", "mujoco:all", "mujoco:joint:tuned"]))) == [
        "mujoco",
        "mujoco:contact",
    ]


@pytest.mark.parametrize(
    ("name", "message"),
    [
        (
            "mujoco:all:best",
            "preset of mujoco = 'best' is unknown; allowed: tuned, recommended, default, newton",
        ),
        ("mujoco:glue:all", "formulation of mujoco = 'glue' is unknown; allowed: joint, contact"),
        ("all:joint:best", "preset of all = 'best' is unknown"),
        ("mujoco:all:noslip_iterations=3", "sets noslip_iterations=3 in several variants; allowed: in one"),
        ("mujocko:all", "engine = 'mujocko' is unknown"),
    ],
)
def test_a_selection_of_nothing_is_refused(name: str, message: str) -> None:
    with pytest.raises(ParameterError, match=message):
        variants_named([name])


@pytest.mark.parametrize("name", ["mujoco", "mujoco:contact", "mujoco:all:all", "mujoco:noslip_iterations=3"])
def test_a_named_engine_that_is_missing_is_refused_and_one_of_all_is_not(
    name: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    assert isinstance(engine("mujoco"), Engine)
    monkeypatch.setattr(MuJoCo, "unavailable_reason", lambda _: "no wheel; pip install mujoco")
    with pytest.raises(ParameterError, match="engine = mujoco is not installed: no wheel; pip install mujoco"):
        variants_named([name])
    assert any(each.engine == "mujoco" for each in variants_named(["all"]))
