"""Versions of the engines that results come from."""

from collections.abc import Iterable

from engines.interface.registry import engine


def versions_of(names: Iterable[str]) -> str:
    """Give name and version of every engine of these names that is installed, each once, in order."""
    engines = [engine(name) for name in dict.fromkeys(names)]
    return ", ".join(f"{own.name} {own.version()}" for own in engines if own.unavailable_reason() is None)
