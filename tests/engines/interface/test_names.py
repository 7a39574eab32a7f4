"""Engines and configurations by name: which a name stands for, and what is said of one that is unknown or missing."""

import importlib.util
import re
import tomllib
from pathlib import Path

import pytest
from packaging.requirements import Requirement

from multibody_xval.engines import engine, engine_names
from multibody_xval.engines.interface.registry import default_engine_names
from multibody_xval.engines.interface.variant import variants_named
from multibody_xval.engines.isolated import out_of_process
from multibody_xval.engines.mujoco import MuJoCo
from multibody_xval.engines.shared.pip_engine import PipEngine
from reference_lcp.errors import ParameterError

PROJECT = tomllib.loads((Path(__file__).parents[3] / "pyproject.toml").read_text())["project"]


def named(*names: str) -> list[str]:
    return list(map(str, variants_named(names)))


@pytest.mark.parametrize(
    ("name", "variants"),
    [
        ("mujoco", "mujoco"),
        ("mujoco:all:all", "mujoco mujoco:joint:default mujoco:contact mujoco:contact:newton mujoco:contact:default"),
        ("mujoco:all:recommended", "mujoco:joint:recommended mujoco:contact:recommended"),
    ],
)
def test_parts_that_are_left_out_are_joint_and_tuned_and_all_is_every_one(name: str, variants: str) -> None:
    assert named(name) == variants.split()


def test_all_engines_are_each_joint_and_tuned_and_a_name_counts_once() -> None:
    assert {(each.formulation, each.preset_name) for each in variants_named(["all"])} == {("joint", "tuned")}
    assert {"mujoco:contact:recommended", "exudyn-bristle:joint:recommended"} <= set(named("all:all:recommended"))
    assert named("mujoco", "mujoco:all", "mujoco:joint:tuned") == ["mujoco", "mujoco:contact"]


@pytest.mark.parametrize(
    ("name", "message"),
    [
        ("mujocko:all", "engine = 'mujocko' is unknown; allowed: reference"),
        ("mujoco:all:best", "preset of mujoco = 'best' is unknown; allowed: tuned, recommended, default, newton"),
        ("mujoco:glue:all", "formulation of mujoco = 'glue' is unknown; allowed: joint, contact"),
        ("mujoco:all:noslip_iterations=3", "sets noslip_iterations=3 in several variants; allowed: in one"),
    ],
)
def test_a_selection_of_nothing_is_refused(name: str, message: str) -> None:
    with pytest.raises(ParameterError, match=message):
        variants_named([name])


@pytest.mark.parametrize("name", ["mujoco", "mujoco:all:all", "mujoco:noslip_iterations=3"])
def test_a_named_engine_that_is_missing_is_refused_and_all_are_those_that_are_there(name, monkeypatch) -> None:
    monkeypatch.setattr(MuJoCo, "unavailable_reason", lambda _: "no wheel; pip install mujoco")
    with pytest.raises(ParameterError, match="engine = mujoco is not installed: no wheel; pip install mujoco"):
        variants_named([name])
    assert "mujoco" not in named("all")
    assert "mujoco" in engine_names()


SAYS = {
    "drake": r"^the package drake is not installed; pip install '.\[engines\]' in the suite's folder$",
    "pybullet": r"^the package pybullet is not installed; pip install 'pybullet>=3.2.7'",
    "ode": "^apt install python3-pyode, or let MULTIBODY_XVAL_ODE_PYTHON name a Python that has it .*/nowhere",
}


@pytest.mark.parametrize("name", sorted({*engine_names()} - {"reference"}))
def test_engine_that_is_missing_says_how_to_install_it(name, monkeypatch) -> None:
    """Here none may be missing: no package is found, and the system's Python is one that is not there."""
    monkeypatch.setattr(importlib.util, "find_spec", lambda _package: None)
    monkeypatch.setattr(out_of_process, "system_python", lambda: "/nowhere/python3")
    for variable in ("MULTIBODY_XVAL_SICONOS_PYTHON", "MULTIBODY_XVAL_ODE_PYTHON"):
        monkeypatch.delenv(variable, raising=False)
    assert re.search(SAYS.get(name, r"\b(pip|apt) install\b"), engine(name).unavailable_reason())


@pytest.mark.needs("mujoco")
@pytest.mark.parametrize(("version", "taken"), [("3.3.5", False), ("3.3.6", True), ("5.0.0", False)])
def test_another_version_is_a_reason_with_those_that_the_adapter_takes(version: str, taken: bool, monkeypatch) -> None:
    monkeypatch.setattr("multibody_xval.engines.shared.pip_engine.installed_version", {"mujoco": version}.get)
    lacking = f"mujoco {version} is installed, and its adapter takes {MuJoCo.versions}; pip install "
    reason = MuJoCo().unavailable_reason()
    assert reason is None if taken else str(reason).startswith(lacking)


@pytest.mark.needs("mujoco")
@pytest.mark.parametrize(("mujoco", "core"), [("3.3.7", None), ("4.0.0", "4.0.0"), (None, "4.0.1"), ("4.0.0", "4.0.1")])
def test_two_distributions_of_one_engine_at_unequal_versions_are_refused(mujoco, core, monkeypatch) -> None:
    installed = {"mujoco": mujoco, "mujoco-core": core}
    monkeypatch.setattr("multibody_xval.engines.shared.pip_engine.installed_version", installed.get)
    reason = (
        "mujoco 4.0.0 and mujoco-core 4.0.1 are both installed, and overwrite each other's files; "
        "allowed: equal versions"
    )
    assert MuJoCo().version() == (mujoco or core)
    assert MuJoCo().unavailable_reason() == (reason if mujoco != (core or mujoco) and mujoco else None)


def test_engines_that_take_part_by_default_are_those_that_pip_brings_to_this_python() -> None:
    asked = map(Requirement, PROJECT["dependencies"])
    brought = {each.name for each in asked if each.marker is None or each.marker.evaluate()}
    packages = {name: engine(name).capabilities.package for name in engine_names()}
    default = {name for name in default_engine_names() if name != "reference"}
    assert default == {name for name, package in packages.items() if package in brought}
    assert {"mujoco", "exudyn-regularised"} <= default


def test_adapters_take_the_versions_that_the_suite_asks_for() -> None:
    extras = PROJECT["optional-dependencies"]
    asked = map(Requirement, [*PROJECT["dependencies"], *extras["engines"], *extras["genesis"]])
    versions = {each.name: each.specifier for each in asked}
    adapters = [own for name in engine_names() if isinstance(own := engine(name), PipEngine) and own.versions]
    assert adapters
    for own in adapters:
        assert versions[own.capabilities.package] == Requirement(f"any{own.versions}").specifier, own.name
