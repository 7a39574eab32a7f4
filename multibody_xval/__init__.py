"""The one door of the suite: every name that a study, a notebook or an engine's adapter needs.

``import multibody_xval`` also works beside files of the user's that are called ``engines.py`` or ``reports.py``, which
``from scenarios import sweep`` takes for packages of the suite: the suite's own are imported here, from where this
package lies. Each name is imported on first use.
"""

import importlib
import sys
from pathlib import Path
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from engines import Capabilities, Engine, Formulation, FrictionLaw, Option, Preset, Variant, engine, engine_names
    from engines.interface.law import NotModelled
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
    from reports import band_edges, plot, report
    from scenarios import check, sweep
    from scenarios.verdicts.regression import compare_stores as compare

_NAMES = {
    "reports": ("band_edges", "plot", "report"),
    "scenarios": ("check", "sweep"),
    "scenarios.verdicts.regression": ("compare",),
    "engines": (
        "Capabilities", "Engine", "Formulation", "FrictionLaw", "Option", "Preset", "Variant", "engine", "engine_names",
    ),
    "engines.interface.law": ("NotModelled",),
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
    "NotModelled",
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

_PACKAGES = ("reference_lcp", "engines", "scenarios", "reports")
_ROOT = Path(__file__).resolve().parents[1]


def __getattr__(name: str) -> Any:
    """Import a name on first use."""
    for package, names in _NAMES.items():
        if name in names:
            return getattr(importlib.import_module(package), "compare_stores" if name == "compare" else name)
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")


def __dir__() -> list[str]:
    """Names for completion."""
    return __all__


def _import_packages() -> None:
    """Import the packages of the suite, whatever has their names in the working folder.

    Raises
    ------
    ImportError
        If something else has been imported under one of their names before.
    """
    sys.path.insert(0, str(_ROOT))
    try:
        for name in _PACKAGES:
            own = str(_ROOT / name / "__init__.py")
            file = importlib.import_module(name).__file__
            if file != own:
                problem = f"{name} has been imported from {file}, which is not the suite's {own}"
                raise ImportError(f"{problem}; allowed: import multibody_xval first")
    finally:
        sys.path.remove(str(_ROOT))


_import_packages()
