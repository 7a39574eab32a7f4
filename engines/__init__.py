"""Multibody engines that simulate the frictional chain, behind one contract."""

from engines.interface import (
    Capabilities,
    Engine,
    EngineNotInstalled,
    Formulation,
    FrictionLaw,
    NormalForce,
    Option,
    Preset,
)
from engines.registry import engine, engine_names
from engines.variant import Variant, variants_of

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
