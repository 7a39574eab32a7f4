"""Every engine that is registered, by name."""

from collections.abc import Callable
from functools import cache
from importlib import import_module
from importlib.metadata import EntryPoint, entry_points
from typing import Any

from engines.interface.engine import Engine
from engines.interface.law_engine import LAW_SUFFIX, LawEngine
from engines.interface.presets import Capabilities
from reference_lcp.refusal import ParameterError, checked_choice

ENTRY_POINT_GROUP = "multibody_xval.engines"
"""Group under which a distribution registers its engines; nothing in the suite is edited for a new one."""

FAMILY_GROUP = "multibody_xval.engine_families"
"""Group under which a distribution registers families of engines: functions that give the engine ``FAMILY@MEMBER``, of
``MEMBER``. Engines of families take part where they are named, and are not listed."""

ENVIRONMENTS = "engines.environments.engine"
"""Module of versions of engines, and of engines in environments of their own: engines, and so loaded by name."""


@cache
def _entry_points() -> dict[str, EntryPoint]:
    return {entry.name: entry for entry in entry_points(group=ENTRY_POINT_GROUP)}


@cache
def _families() -> dict[str, EntryPoint]:
    return {entry.name: entry for entry in entry_points(group=FAMILY_GROUP)}


@cache
def _loaded(name: str) -> Any:
    return _entry_points()[name].load()


def registered_names() -> list[str]:
    """Names of all registered engines, broken ones too; the reference comes first."""
    return sorted(_entry_points(), key=lambda name: (name != "reference", name))


def engine_names() -> list[str]:
    """Names of all registered engines but for broken ones; the reference comes first."""
    return [name for name in registered_names() if broken_reason(name) is None]


@cache
def broken_reason(name: str) -> str | None:
    """Give the reason why a registered engine is none; ``None`` if it is one, whether or not it is installed.

    Its module may be missing or fail, it may be no `Engine`, or it may raise where it describes itself.
    """
    reason = _not_loaded_reason(name)
    return reason if reason is not None else _raised(lambda: _check_versions(_loaded(name)()))


@cache
def _not_loaded_reason(name: str) -> str | None:
    """Give the reason why a registered engine cannot be loaded; its versions, which may need a process, are left."""
    return _raised(lambda: _check_engine(_loaded(name)()))


def _raised(check: Callable[[], None]) -> str | None:
    try:
        check()
    except (Exception, SystemExit) as problem:  # of a stranger's code
        return " ".join(f"{type(problem).__name__}: {problem}".split())
    return None


def _check_engine(registered: Any) -> None:
    """Raise unless this is an engine with capabilities."""
    if not isinstance(registered, Engine):
        raise TypeError(f"it is a {type(registered).__name__}; allowed: a subclass of engines.Engine")
    if not isinstance(registered.capabilities, Capabilities):
        raise TypeError(f"its capabilities are a {type(registered.capabilities).__name__}; allowed: Capabilities")


def _check_versions(registered: Engine) -> None:
    """Raise unless an engine says why it is not installed, or its versions."""
    if registered.unavailable_reason() is None:
        for stated, text in (("version", registered.version()), ("python", registered.python())):
            if not isinstance(text, str):
                raise TypeError(f"its {stated}() gives a {type(text).__name__}; allowed: a text")


def engine(name: str) -> Engine:
    """Give the engine of this name; its own package is imported when it builds something.

    ``NAME@law`` is the model of that engine's laws, which needs no package; ``FAMILY@MEMBER`` is one of a family,
    and ``NAME@VERSION`` a version of an engine, in an environment of its own unless it is the one beside the suite.

    Raises
    ------
    ParameterError
        If no engine of this name is registered, or the one that is registered is broken.
    """
    if name.endswith(LAW_SUFFIX):
        return _law_engine(name.removesuffix(LAW_SUFFIX))
    family, _, member = name.partition("@")
    if member and family in _families():
        return _member(family, member)
    if family in _entry_points() and family != name:
        return _version(family, member)
    return _in_own_environment(name) or registered_engine(name)


def registered_engine(name: str) -> Engine:
    """Give the engine that is registered under a name, as it is beside the suite; see `engine`."""
    if name not in _entry_points():
        checked_choice("engine", name, registered_names())
    reason = broken_reason(name)
    if reason is not None:
        raise ParameterError(f"engine = {name!r} cannot be used: {reason}")
    registered: Engine = _loaded(name)()
    return registered


@cache
def _law_engine(name: str) -> Engine:
    return LawEngine(engine(name), engine("reference").version())


@cache
def _member(family: str, member: str) -> Engine:
    built: Engine = _families()[family].load()(member)
    return built


@cache
def _version(name: str, version: str) -> Engine:
    """Give a version of a registered engine."""
    built: Engine = import_module(ENVIRONMENTS).versioned_engine(registered_engine(name), version)
    return built


@cache
def _in_own_environment(name: str) -> Engine | None:
    """Give an engine that is not beside the suite, but in an environment of its own; ``None`` otherwise."""
    built: Engine | None = import_module(ENVIRONMENTS).engine_of_its_own_environment(registered_engine(name))
    return built


def default_engine_names() -> list[str]:
    """Names of the engines that take part by default: all but broken ones, and those of an extra or the system."""
    loaded = [name for name in registered_names() if _not_loaded_reason(name) is None]
    default = [name for name in loaded if not _loaded(name)().capabilities.optional]
    return [name for name in default if broken_reason(name) is None]
