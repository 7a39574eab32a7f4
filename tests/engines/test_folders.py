"""What the folders of engines may import, whichever are registered: a new one needs a line in no list but that."""

import re
import sys
import tomllib
from importlib import metadata
from pathlib import Path

import pytest

from multibody_xval.engines.interface.registry import engine
from multibody_xval.engines.shared.pip_engine import PipEngine

grimp = pytest.importorskip("grimp")

ROOT = Path(__file__).parents[2]
PROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text())["project"]
REGISTERED = PROJECT["entry-points"]["multibody_xval.engines"]
FOLDERS = sorted({value.partition(":")[0] for value in REGISTERED.values()})

SHARED = ("multibody_xval.engines.interface", "multibody_xval.engines.shared", "multibody_xval.engines.isolated")
"""What folders of engines may import of the room, and what imports none of them."""

OF_MUJOCO = ("multibody_xval.engines.mujoco_warp", "multibody_xval.engines.genesis")
"""Copies of MuJoCo, and Genesis, whose solver is one: they take models and laws from its folder."""


@pytest.fixture(scope="module")
def graph():
    return grimp.build_graph("multibody_xval", "reference_lcp", include_external_packages=True)


def imported(graph, package: str) -> set[str]:
    """Modules outside a package that its modules import."""
    modules = {package, *graph.find_descendants(package)}
    return {found for module in modules for found in graph.find_modules_directly_imported_by(module)} - modules


def within(module: str, packages) -> bool:
    return any(f"{module}.".startswith(f"{package}.") for package in packages)


@pytest.mark.parametrize("folder", FOLDERS)
def test_folder_of_an_engine_imports_no_other_one(graph, folder: str) -> None:
    allowed = (*SHARED, *(["multibody_xval.engines.mujoco"] if folder in OF_MUJOCO else []))
    of_engines = {module for module in imported(graph, folder) if module.startswith("multibody_xval.engines.")}
    assert not {module for module in of_engines if not within(module, allowed)}


@pytest.mark.parametrize("folder", SHARED)
def test_what_engines_share_imports_none_of_them(graph, folder: str) -> None:
    assert not [module for module in imported(graph, folder) if within(module, FOLDERS)]


def test_package_of_an_engine_is_imported_in_its_own_folder_only(graph) -> None:
    installed = {re.split(r"[^\w.-]", line)[0].lower() for line in PROJECT["dependencies"]}
    distributions = metadata.packages_distributions()
    base = {name for name, packages in distributions.items() if installed & {each.lower() for each in packages}}
    adapters = {name for folder in FOLDERS for name in imported(graph, folder) if graph.is_module_squashed(name)}
    declared = {own.module for name in REGISTERED if isinstance(own := engine(name), PipEngine)}
    engines = (adapters - base - sys.stdlib_module_names) | declared
    assert {"mujoco", "pydrake", "warp", "siconos"} <= engines
    for package in (
        "reference_lcp",
        "multibody_xval.scenarios",
        "multibody_xval.reports",
        "multibody_xval.engines.interface",
        "multibody_xval.engines.reference",
    ):
        assert not imported(graph, package) & engines
