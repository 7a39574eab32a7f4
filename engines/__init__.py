"""Multibody engines that simulate the frictional chain, behind one contract."""

from engines.interface.engine import Engine, EngineNotInstalled
from engines.interface.presets import Capabilities, Formulation, FrictionLaw, NormalForce, Option, Preset
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
    "Preset",
    "Variant",
    "engine",
    "engine_names",
    "variants_of",
]
