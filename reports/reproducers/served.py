"""A scene that another Python builds: the functions of its server, read here, where their engine need not be."""

import ast
import sys
from collections.abc import Mapping
from pathlib import Path
from types import ModuleType
from typing import Any

import numpy as np

from multibody_xval.reports.reproducers.known import SUITE


class Given(dict[str, Any]):
    """What a server is given, as the worker gives it: arrays by name."""


def given(parameters: Mapping[str, Any]) -> Given:
    """Make arrays of all."""
    return Given({name: np.asarray(value) for name, value in parameters.items()})


def builder(server: Path) -> Any:
    """Give the function ``scene`` of a server, for which modules of the engine are names alone."""
    space: dict[str, Any] = {"__name__": f"{SUITE}.{server.stem}"}
    for line in ast.parse(server.read_text(encoding="utf-8")).body:
        module = line.module if isinstance(line, ast.ImportFrom) else None
        if isinstance(line, ast.Import | ast.ImportFrom) and not _here(module or line.names[0].name):
            names = {own.asname or own.name: f"{module}." * bool(module) + own.name for own in line.names}
            space |= {name: ModuleType(full) for name, full in names.items()}
        else:
            exec(compile(ast.Module([line], []), str(server), "exec"), space)
    return space["scene"]


def _here(module: str) -> bool:
    return module.partition(".")[0] in {"numpy", *sys.stdlib_module_names}
