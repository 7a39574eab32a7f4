"""The reference: LCP time stepping of the frictional mass-in-mass chain after Sethi, Banerjee and Manna.

What a study needs is here, each name imported from its folder when it is first used, which spares a command the
compiled solvers that it does not need; `multibody_xval` has those that a study needs, for type checkers too.
"""

from importlib import import_module
from typing import Any

from reference_lcp.environment import ensure_kernel_cache

_NAMES = {
    "chain.drives": ["HarmonicBase", "HarmonicForce", "StillBase"],
    "chain.linear_response": ["frictionless_transmittance", "stuck_transmittance"],
    "chain.mass_in_mass": ["Chain"],
    "chain.preload": ["Preload"],
    "chain.simulation": ["Lane", "PeriodicOrbit"],
    "chain.trajectory": ["State", "Trajectory"],
    "chain.transient": ["FilteredNoise", "RecordedBase", "RickerPulse", "SweptSine"],
    "errors": ["NotProven", "ParameterError"],
    "exact.event_driven_system": ["EventDrivenSystem"],
    "exact.proof.exact_chain": ["ExactChain"],
    "exact.proof.prove": ["ProvenSteadyState", "prove", "prove_steady_state"],
    "lcp.lemke": ["lemke"],
    "lcp.systems": [
        "FrictionContact",
        "Harmonic",
        "MassSpringSystem",
        "Motion",
        "Piecewise",
        "Spring",
        "simulate_system",
    ],
    "lcp.time_step": ["FrictionalStep"],
    "observables.stick_slip": ["Mode", "dissipated_energy", "stuck_fraction", "transitions"],
    "observables.transmittance": ["decibel", "transmittance"],
    "one_call": ["SteadyState", "exact_steady_state", "simulate", "steady_state"],
    "schemes.euler": ["CompiledSimulation"],
    "steady.orbits": ["periodic_orbits"],
    "system_state": ["SystemSteadyState"],
}
_MODULES = {name: module for module, names in _NAMES.items() for name in names}

__all__ = list(_MODULES)


def __getattr__(name: str) -> Any:
    """Import a public name from its folder."""
    if name not in _MODULES:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    public = getattr(import_module(f"{__name__}.{_MODULES[name]}"), name)
    globals()[name] = public
    return public


def __dir__() -> list[str]:
    """Names for completion."""
    return sorted({*globals(), *_MODULES})


ensure_kernel_cache()
