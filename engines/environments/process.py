"""The worker process of an environment: which files it runs, and where it finds the adapter."""

import functools
import json
import sys
from pathlib import Path

from engines.environments.environment import Environment
from engines.interface.engine import Engine
from engines.out_of_process.process import EngineProcess

SERVER = Path(__file__).with_name("server.py")

PACKAGES = ("engines", "reference_lcp")
"""What the adapters of the suite are made of."""

FIRST_USE_LIMIT = 600.0
"""Seconds that an engine may take to be imported, and to build its first lanes: some compile for minutes then."""


def started(adapter: type[Engine], environment: Environment) -> EngineProcess:
    """Give a worker process, which starts with its first request, for one engine in its environment."""
    folders = {name: _folder(name) for name in dict.fromkeys([*PACKAGES, adapter.__module__.partition(".")[0]])}
    served = json.dumps({"module": adapter.__module__, "class": adapter.__qualname__, "folders": folders})
    return EngineProcess(environment.name, str(environment.interpreter), SERVER, served)


def shared_process(adapter: Engine, environment: Environment) -> EngineProcess:
    """Give the worker process that all lanes of an engine share."""
    return _shared(type(adapter), environment, environment.folder)


@functools.cache
def _shared(adapter: type[Engine], environment: Environment, _folder: Path) -> EngineProcess:
    return started(adapter, environment)


def _folder(package: str) -> str:
    """Give the folder that holds a package of this process."""
    file = sys.modules[package].__file__
    assert file is not None, "every package has a file"
    return str(Path(file).resolve().parents[1])


def tried_versions(adapter: Engine, environment: Environment) -> dict[str, str]:
    """Import the engine in its environment; gives the versions of engine and Python.

    Raises
    ------
    EngineProcessError
        If that fails.
    """
    process = started(type(adapter), environment)
    try:
        return {name: str(value) for name, value in process.request("versions", FIRST_USE_LIMIT).items()}
    finally:
        process.close()
