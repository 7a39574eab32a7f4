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
    from reference_lcp.chain.drives import HarmonicBase, HarmonicForce, StillBase
    from reference_lcp.chain.mass_in_mass import Chain
    from reference_lcp.chain.preload import Preload
    from reference_lcp.chain.simulation import Lane, PeriodicOrbit
    from reference_lcp.chain.trajectory import State, Trajectory
    from reference_lcp.chain.transient import FilteredNoise, RecordedBase, RickerPulse, SweptSine
    from reference_lcp.errors import NotProven, ParameterError
    from reference_lcp.exact.event_driven_system import EventDrivenSystem
    from reference_lcp.exact.proof.prove import ProvenSteadyState, prove_steady_state
    from reference_lcp.lcp.systems import (
        FrictionContact,
        Harmonic,
        MassSpringSystem,
        Motion,
        Piecewise,
        Spring,
        simulate_system,
    )
    from reference_lcp.observables.stick_slip import Mode, stuck_fraction, transitions
    from reference_lcp.one_call import SteadyState, exact_steady_state, simulate, steady_state
    from reference_lcp.schemes.sequential import LaneModel, SequentialSimulation
    from reference_lcp.system_state import SystemSteadyState

_NAMES = {
    "multibody_xval.reports": ("band_edges", "plot", "report"),
    "multibody_xval.scenarios": ("check", "sweep"),
    "multibody_xval.scenarios.compare.stores": ("compare",),
    "multibody_xval.engines": (
        "Capabilities", "Engine", "Formulation", "FrictionLaw", "Option", "Preset", "Variant", "engine", "engine_names",
    ),
    "reference_lcp": (
        "Chain", "EventDrivenSystem", "FilteredNoise", "FrictionContact", "Harmonic", "HarmonicBase", "HarmonicForce",
        "Lane", "MassSpringSystem", "Mode", "Motion", "NotProven", "ParameterError", "PeriodicOrbit", "Piecewise",
        "Preload", "ProvenSteadyState", "RecordedBase", "RickerPulse", "Spring", "State", "SteadyState", "StillBase",
        "SweptSine", "SystemSteadyState", "Trajectory", "exact_steady_state", "prove_steady_state", "simulate",
        "simulate_system", "steady_state", "stuck_fraction", "transitions",
    ),
    "reference_lcp.schemes.sequential": ("LaneModel", "SequentialSimulation"),
}  # fmt: skip

__all__ = [
    "Capabilities",
    "Chain",
    "Engine",
    "EventDrivenSystem",
    "FilteredNoise",
    "Formulation",
    "FrictionContact",
    "FrictionLaw",
    "Harmonic",
    "HarmonicBase",
    "HarmonicForce",
    "Lane",
    "LaneModel",
    "MassSpringSystem",
    "Mode",
    "Motion",
    "NotProven",
    "Option",
    "ParameterError",
    "PeriodicOrbit",
    "Piecewise",
    "Preload",
    "Preset",
    "ProvenSteadyState",
    "RecordedBase",
    "RickerPulse",
    "SequentialSimulation",
    "Spring",
    "State",
    "SteadyState",
    "StillBase",
    "SweptSine",
    "SystemSteadyState",
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
    "simulate_system",
    "steady_state",
    "stuck_fraction",
    "sweep",
    "transitions",
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
