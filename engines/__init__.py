"""Multibody engines that simulate the frictional chain, behind one contract.

Each name is imported on first use, so that a command heeds Ctrl-C before anything is imported.
"""

from importlib import import_module
from typing import TYPE_CHECKING, Any

# A checkout has the folder of this name too: nothing is to be imported twice.
if __name__ != "multibody_xval.engines":
    raise ImportError("engines is a folder of the suite, and no package; allowed: multibody_xval.engines")

if TYPE_CHECKING:
    from multibody_xval.engines.interface.engine import Engine, EngineNotInstalled
    from multibody_xval.engines.interface.presets import (
        Capabilities,
        Formulation,
        FrictionLaw,
        NormalForce,
        Option,
        Preparation,
        Preset,
    )
    from multibody_xval.engines.interface.registry import engine, engine_names
    from multibody_xval.engines.interface.variant import Variant, variants_of

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
            return getattr(import_module(f"multibody_xval.engines.interface.{module}"), name)
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
