"""Every engine by name: those that are registered, and what is wrong with those that are broken."""

from collections.abc import Callable, Iterator, Mapping
from dataclasses import is_dataclass
from functools import cache
from importlib.metadata import EntryPoint, entry_points
from typing import Any

from multibody_xval.engines.interface.engine import Engine
from multibody_xval.engines.interface.presets import Capabilities, Option, Preset
from multibody_xval.engines.interface.texts import text_of, visible
from reference_lcp.errors import ParameterError, checked_choice, shown

ENTRY_POINT_GROUP = "multibody_xval.engines"
"""Group under which a distribution registers its engines; nothing in the suite is edited for a new one."""


@cache
def _entry_points() -> dict[str, EntryPoint]:
    return {entry.name: entry for entry in entry_points(group=ENTRY_POINT_GROUP)}


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
        return visible(" ".join(f"{type(problem).__name__}: {text_of(problem)}".split()))
    return None


def _check_engine(registered: Any) -> None:
    """Raise unless this is an engine with capabilities."""
    if not isinstance(registered, Engine):
        raise TypeError(f"it is a {type(registered).__name__}; allowed: a subclass of multibody_xval.Engine")
    if not isinstance(registered.capabilities, Capabilities):
        raise TypeError(f"its capabilities are a {type(registered.capabilities).__name__}; allowed: Capabilities")
    for formulation, presets in registered.capabilities.presets.items():
        for name, preset in presets.items():
            _check_preset(f"preset {formulation}:{name}", preset)
    for text in _texts(registered.capabilities):
        text.encode()  # results are stored under some, and reports print all


def _check_preset(name: str, preset: Any) -> None:
    """Raise unless this is a preset, and each of its options an option."""
    if not isinstance(preset, Preset):
        raise TypeError(f"its {name} is a {type(preset).__name__}; allowed: Preset")
    options: Mapping[str, Any] = preset.options
    for option, own in options.items():
        if not isinstance(own, Option):
            what = f"option {option} of its {name} is a {type(own).__name__}"
            raise TypeError(f"{what}; allowed: Option(value, default, reason) or Option.own(value, meaning)")


def _texts(value: object) -> Iterator[str]:
    """Give every text of data."""
    if isinstance(value, str):
        yield value
    elif isinstance(value, Mapping | tuple | list):
        for each in value.items() if isinstance(value, Mapping) else value:
            yield from _texts(each)
    elif is_dataclass(value):
        yield from _texts(vars(value))


def _check_versions(registered: Engine) -> None:
    """Raise unless an engine says why it is not installed, or its versions."""
    stated = {"unavailable_reason": registered.unavailable_reason()}
    if stated["unavailable_reason"] is None:
        stated = {"version": registered.version(), "python": registered.python()}
    for name, text in stated.items():
        if not isinstance(text, str):
            raise TypeError(f"its {name}() gives a {type(text).__name__}; allowed: a text")
        text.encode()


def engine(name: str) -> Engine:
    """Give the engine of this name; its own package is imported when it builds something.

    Raises
    ------
    ParameterError
        If no engine of this name is registered, or the one that is registered is broken.
    """
    if name not in _entry_points():
        _check_without_version(name)
        checked_choice("engine", name, registered_names())
    reason = broken_reason(name)
    if reason is not None:
        raise ParameterError(f"engine = {name!r} cannot be used: {reason}")
    return _loaded(name)()


def _check_without_version(name: str) -> None:
    """Refuse a name with a version, such as ``mujoco@3.3.7`` or ``mujoco==3.3.7``."""
    for mark in ("@", "=="):
        known, _, version = name.partition(mark)
        if version and known in _entry_points():
            raise ParameterError(
                f"engine = {shown(name)} has a version; allowed: {known}, as it is installed (each version needs its "
                "own virtual environment: docs/how_to/compare_versions.md)"
            )


def installed_engine_names() -> list[str]:
    """Names of the engines that can be used here."""
    return [name for name in engine_names() if engine(name).unavailable_reason() is None]


def default_engine_names() -> list[str]:
    """Names of the engines that take part by default: all but broken ones, and those of an extra or the system."""
    loaded = [name for name in registered_names() if _not_loaded_reason(name) is None]
    default = [name for name in loaded if not _loaded(name)().capabilities.optional]
    return [name for name in default if broken_reason(name) is None]
