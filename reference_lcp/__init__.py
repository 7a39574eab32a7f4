"""The reference: LCP time stepping of the frictional mass-in-mass chain after Sethi, Banerjee and Manna.

What a study of a chain needs is here, each name imported from its folder when it is first used; the rest is in the
folders themselves.
"""

from importlib import import_module
from typing import Any

_MODULES = {
    "Chain": "chain.mass_in_mass",
    "CompiledSimulation": "stepping.euler_compiled",
    "FilteredNoise": "chain.transient",
    "FrictionalStep": "lcp.time_step",
    "FrictionalSystem": "lcp.frictional_system",
    "HarmonicBase": "chain.harmonic",
    "HarmonicForce": "chain.harmonic",
    "Lane": "chain.simulation",
    "Mode": "observables.stick_slip",
    "ParameterError": "validation",
    "PeriodicOrbit": "steady.orbits",
    "Preload": "chain.preload",
    "RecordedBase": "chain.record",
    "RickerPulse": "chain.transient",
    "State": "chain.trajectory",
    "SteadyState": "one_call",
    "StillBase": "chain.harmonic",
    "SweptSine": "chain.transient",
    "Trajectory": "chain.trajectory",
    "decibel": "observables.transmittance",
    "dissipated_energy": "observables.stick_slip",
    "exact_steady_state": "one_call",
    "frictionless_transmittance": "chain.linear_response",
    "lemke": "lcp.lemke",
    "periodic_orbits": "steady.orbits",
    "simulate": "one_call",
    "simulate_system": "lcp.frictional_system",
    "steady_state": "one_call",
    "stuck_fraction": "observables.stick_slip",
    "stuck_transmittance": "chain.linear_response",
    "transitions": "observables.stick_slip",
    "transmittance": "observables.transmittance",
}

__all__ = list(_MODULES)


def __getattr__(name: str) -> Any:
    """Import a public name from its folder."""
    if name not in _MODULES:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    found = getattr(import_module(f"{__name__}.{_MODULES[name]}"), name)
    globals()[name] = found
    return found


def __dir__() -> list[str]:
    """Names for completion."""
    return sorted({*globals(), *_MODULES})
