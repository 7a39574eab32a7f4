"""A constant of an engine is stated once: two copies of one number drift apart."""

import ast
import tomllib
from collections import Counter
from collections.abc import Iterator
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
PROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
REGISTERED = PROJECT["entry-points"]["multibody_xval.engines"]
FOLDERS = sorted({ROOT / value.partition(":")[0].replace(".", "/") for value in REGISTERED.values()})


def constants(module: Path) -> Iterator[str]:
    """Give the names of the numbers and texts that a module states."""
    for statement in ast.parse(module.read_text(encoding="utf-8")).body:
        targets = statement.targets if isinstance(statement, ast.Assign) else [getattr(statement, "target", None)]
        for target in targets:
            names = target.elts if isinstance(target, ast.Tuple) else [target]
            yield from (name.id for name in names if isinstance(name, ast.Name) and name.id.isupper())


@pytest.mark.parametrize("folder", FOLDERS, ids=lambda folder: folder.name)
def test_constant_of_an_engine_is_stated_once(folder: Path) -> None:
    stated = Counter(name for module in sorted(folder.glob("*.py")) for name in constants(module))
    assert {name for name, times in stated.items() if times > 1} == set()
