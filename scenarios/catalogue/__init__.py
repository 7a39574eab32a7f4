"""The catalogue: every scenario by its name.

`CATALOGUE` is imported on first use: commands list the scenarios by their `descriptions`.
"""

from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from scenarios.catalogue.registry import CATALOGUE

__all__ = ["CATALOGUE"]


def __getattr__(name: str) -> Any:
    """Import the scenarios on first use."""
    if name in __all__:
        from scenarios.catalogue import registry

        return getattr(registry, name)
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
