"""Multibody engines that simulate the frictional chain, behind one contract.

Each name is imported on first use, so that a command heeds Ctrl-C before anything is imported.
"""

from importlib import import_module
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from engines.interface.engine import Engine, EngineNotInstalled
    from engines.interface.presets import (
        Capabilities,
        Formulation,
        FrictionLaw,
        NormalForce,
        Option,
        Preparation,
        Preset,
    )
    from engines.interface.registry import engine, engine_names
    from engines.interface.variant import Variant, variants_of

__all__ = [
    "Capabilities",
    "Engine",
    "EngineNotInstalled",
    "Formulation",
    "FrictionLaw",
    "NormalForce",
    "Option",
    "Preparation",
    "Preset",
    "Variant",
    "engine",
    "engine_names",
    "variants_of",
]

_MODULES = {
    "engine": ("Engine", "EngineNotInstalled"),
    "presets": ("Capabilities", "Formulation", "FrictionLaw", "NormalForce", "Option", "Preparation", "Preset"),
    "registry": ("engine", "engine_names"),
    "variant": ("Variant", "variants_of"),
}


def __getattr__(name: str) -> Any:
    """Import a name on first use."""
    for module, names in _MODULES.items():
        if name in names:
            return getattr(import_module(f"engines.interface.{module}"), name)
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
