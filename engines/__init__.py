"""Multibody engines that simulate the frictional chain, behind one contract."""

from engines.interface import (
    Capabilities,
    Engine,
    EngineNotInstalled,
    Formulation,
    FrictionLaw,
    Option,
    Preset,
)
from engines.registry import engine, engine_names

__all__ = [
    "Capabilities",
    "Engine",
    "EngineNotInstalled",
    "Formulation",
    "FrictionLaw",
    "Option",
    "Preset",
    "engine",
    "engine_names",
]
