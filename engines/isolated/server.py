"""What runs in an environment: the suite's own adapter, for the engine that is installed there.

It is loaded by `engines.isolated.worker`. The environment holds nothing of the suite, and nothing else of the
suite's own environment must be found: the packages of the adapter, and no others, are taken from where the suite has
them.
"""

import importlib
import json
import pickle
import sys
from collections.abc import Mapping, Sequence
from functools import cache
from importlib.machinery import ModuleSpec, PathFinder
from types import ModuleType
from typing import Any

import numpy as np

SERVED: dict[str, Any] = json.loads(sys.argv[2])
"""``module`` and ``class`` of the adapter, and ``folders`` of the packages that it is made of, by name."""


class PackagesOfTheSuite:
    """Finds the packages of the adapter where the suite has them."""

    @staticmethod
    def find_spec(name: str, _path: Sequence[str] | None = None, target: ModuleType | None = None) -> ModuleSpec | None:
        """Give the specification of a package of `SERVED`; ``None`` for any other, and for what lies within one."""
        folder = SERVED["folders"].get(name)
        return None if folder is None else PathFinder.find_spec(name, [folder], target)


sys.meta_path.insert(0, PackagesOfTheSuite)


@cache
def _adapter() -> Any:
    adapter = getattr(importlib.import_module(SERVED["module"]), SERVED["class"])()
    adapter.served = True
    return adapter


def versions() -> dict[str, str]:
    """Give the engine's version, once its package has been imported."""
    adapter = _adapter()
    importlib.import_module(adapter.module)
    return {"engine": adapter.version()}


class EngineLane:
    """Lanes of one simulation, from the pickled arguments of `Engine.build`, or a scene."""

    def __init__(self, parameters: Mapping[str, Any]):
        given = pickle.loads(parameters["pickled"].tobytes())
        is_scene = bool(parameters.get("scene", False))
        self._simulation = (_adapter().scene_with if is_scene else _adapter().build)(*given)

    def follow(self, steps: int, launch: Any) -> Any:
        """Give the followed box of a scene a velocity, unless it is empty, and take steps; gives a row a step."""
        if len(launch):
            *velocity, spin = launch.tolist()
            self._simulation.launch(tuple(velocity), spin)
        return self._simulation.run(steps)

    def call(self, pickled: Any) -> dict[str, Any]:
        """Call a method of the simulation, of a pickled name and arguments; gives what it gives."""
        name, *arguments = pickle.loads(pickled.tobytes())
        value = getattr(self._simulation, name)(*arguments)
        return {"pickled": np.frombuffer(pickle.dumps(value), np.uint8)}
