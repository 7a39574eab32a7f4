"""What the folders of engines may import, whichever are registered: a new one needs a line in no list but that."""

import tomllib
from pathlib import Path

import pytest

pytestmark = pytest.mark.extra

grimp = pytest.importorskip("grimp")

PROJECT = tomllib.loads((Path(__file__).parents[2] / "pyproject.toml").read_text())["project"]
FOLDERS = sorted({value.partition(":")[0] for value in PROJECT["entry-points"]["multibody_xval.engines"].values()})

SHARED = ("multibody_xval.engines.interface", "multibody_xval.engines.shared", "multibody_xval.engines.isolated")
"""What folders of engines may import of the room, and what imports none of them."""

OF_MUJOCO = ("multibody_xval.engines.mujoco_warp", "multibody_xval.engines.genesis")
"""Copies of MuJoCo, and Genesis, whose solver is one: they take models and laws from its folder."""


@pytest.fixture(scope="module")
def graph():
    return grimp.build_graph("multibody_xval", "reference_lcp")


@pytest.mark.parametrize("folder", [*FOLDERS, *SHARED])
def test_folder_imports_no_engine_but_its_own(graph, folder: str) -> None:
    modules = {folder, *graph.find_descendants(folder)}
    found = {other for module in modules for other in graph.find_modules_directly_imported_by(module)} - modules
    allowed = (*SHARED, *(["multibody_xval.engines.mujoco"] if folder in OF_MUJOCO else []))
    of_engines = {other for other in found if other.startswith("multibody_xval.engines.")}
    assert {other for other in of_engines if not other.startswith(allowed)} == set()
