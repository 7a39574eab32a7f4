"""The one door of the suite: every name that a study, a notebook or an engine's adapter needs.

Each name is imported on first use. In a checkout the packages within, `engines`, `scenarios` and `reports`, are links
to the folders of these names.
"""

import importlib
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from multibody_xval.engines import (
        Capabilities,
        Engine,
        Formulation,
        FrictionLaw,
        Option,
        Preset,
        Variant,
        engine,
        engine_names,
    )
    from multibody_xval.reports import band_edges, plot, report
    from multibody_xval.scenarios import check, sweep
    from multibody_xval.scenarios.compare.stores import compare
    from reference_lcp import (
        Chain,
        HarmonicBase,
        HarmonicForce,
        Lane,
        NotProven,
        ParameterError,
        PeriodicOrbit,
        ProvenSteadyState,
        State,
        SteadyState,
        Trajectory,
        exact_steady_state,
        prove_steady_state,
        simulate,
        steady_state,
    )
    from reference_lcp.schemes.sequential import LaneModel, SequentialSimulation

_NAMES = {
    "multibody_xval.reports": ("band_edges", "plot", "report"),
    "multibody_xval.scenarios": ("check", "sweep"),
    "multibody_xval.scenarios.compare.stores": ("compare",),
    "multibody_xval.engines": (
        "Capabilities", "Engine", "Formulation", "FrictionLaw", "Option", "Preset", "Variant", "engine", "engine_names",
    ),
    "reference_lcp": (
        "Chain", "HarmonicBase", "HarmonicForce", "Lane", "NotProven", "ParameterError", "PeriodicOrbit",
        "ProvenSteadyState", "State", "SteadyState", "Trajectory", "exact_steady_state", "prove_steady_state",
        "simulate", "steady_state",
    ),
    "reference_lcp.schemes.sequential": ("LaneModel", "SequentialSimulation"),
}  # fmt: skip

__all__ = [
    "Capabilities",
    "Chain",
    "Engine",
    "Formulation",
    "FrictionLaw",
    "HarmonicBase",
    "HarmonicForce",
    "Lane",
    "LaneModel",
    "NotProven",
    "Option",
    "ParameterError",
    "PeriodicOrbit",
    "Preset",
    "ProvenSteadyState",
    "SequentialSimulation",
    "State",
    "SteadyState",
    "Trajectory",
    "Variant",
    "band_edges",
    "check",
    "compare",
    "engine",
    "engine_names",
    "exact_steady_state",
    "plot",
    "prove_steady_state",
    "report",
    "simulate",
    "steady_state",
    "sweep",
]


def __getattr__(name: str) -> Any:
    """Import a name on first use."""
    for package, names in _NAMES.items():
        if name in names:
            return getattr(importlib.import_module(package), name)
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")


def __dir__() -> list[str]:
    """Names for completion."""
    return __all__
