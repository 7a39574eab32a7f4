"""Every engine that is registered, by name."""

from functools import cache
from importlib.metadata import EntryPoint, entry_points
from typing import Any

from engines.interface.engine import Engine
from reference_lcp.validation import checked_choice

ENTRY_POINT_GROUP = "multibody_xval.engines"
"""Group under which a distribution registers its engines; nothing in the suite is edited for a new one."""


@cache
def _entry_points() -> dict[str, EntryPoint]:
    return {entry.name: entry for entry in entry_points(group=ENTRY_POINT_GROUP)}


@cache
def _loaded(name: str) -> Any:
    return _entry_points()[name].load()


def engine_names() -> list[str]:
    """Names of all registered engines; the reference comes first."""
    return sorted(_entry_points(), key=lambda name: (name != "reference", name))


def engine(name: str) -> Engine:
    """Give the engine of this name; its own package is imported when it builds something.

    Raises
    ------
    ParameterError
        If no engine of this name is registered.
    TypeError
        If what is registered under the name is no engine.
    """
    if name not in _entry_points():
        checked_choice("engine", name, engine_names())
    registered = _loaded(name)()
    if not isinstance(registered, Engine):
        raise TypeError(
            f"entry point {name!r} gives a {type(registered).__name__}; allowed: a subclass of engines.Engine"
        )
    return registered


def default_engine_names() -> list[str]:
    """Names of the engines that take part by default: all but those that come with an extra or with the system."""
    return [name for name in engine_names() if not engine(name).capabilities.optional]
