"""The reference: LCP time stepping of the frictional mass-in-mass chain after Sethi, Banerjee and Manna.

What a study of a chain needs is here, each name imported from its folder when it is first used, which spares a command
the compiled solvers that it does not need; type checkers read the imports under `TYPE_CHECKING`. The rest is in the
folders themselves.
"""

from importlib import import_module
from typing import TYPE_CHECKING, Any

from reference_lcp.environment import ensure_kernel_cache

if TYPE_CHECKING:
    from reference_lcp.chain.drives import HarmonicBase as HarmonicBase
    from reference_lcp.chain.drives import HarmonicForce as HarmonicForce
    from reference_lcp.chain.drives import StillBase as StillBase
    from reference_lcp.chain.linear_response import frictionless_transmittance as frictionless_transmittance
    from reference_lcp.chain.linear_response import stuck_transmittance as stuck_transmittance
    from reference_lcp.chain.mass_in_mass import Chain as Chain
    from reference_lcp.chain.preload import Preload as Preload
    from reference_lcp.chain.simulation import Lane as Lane
    from reference_lcp.chain.simulation import PeriodicOrbit as PeriodicOrbit
    from reference_lcp.chain.trajectory import State as State
    from reference_lcp.chain.trajectory import Trajectory as Trajectory
    from reference_lcp.chain.transient import FilteredNoise as FilteredNoise
    from reference_lcp.chain.transient import RecordedBase as RecordedBase
    from reference_lcp.chain.transient import RickerPulse as RickerPulse
    from reference_lcp.chain.transient import SweptSine as SweptSine
    from reference_lcp.deadline import NotProven as NotProven
    from reference_lcp.errors import ParameterError as ParameterError
    from reference_lcp.exact.event_driven_system import EventDrivenSystem as EventDrivenSystem
    from reference_lcp.exact.proof.exact_chain import ExactChain as ExactChain
    from reference_lcp.exact.proof.prove import ProvenSteadyState as ProvenSteadyState
    from reference_lcp.exact.proof.prove import prove as prove
    from reference_lcp.exact.proof.prove import prove_steady_state as prove_steady_state
    from reference_lcp.lcp.lemke import lemke as lemke
    from reference_lcp.lcp.systems import FrictionContact as FrictionContact
    from reference_lcp.lcp.systems import Harmonic as Harmonic
    from reference_lcp.lcp.systems import MassSpringSystem as MassSpringSystem
    from reference_lcp.lcp.systems import Piecewise as Piecewise
    from reference_lcp.lcp.systems import Spring as Spring
    from reference_lcp.lcp.systems import simulate_system as simulate_system
    from reference_lcp.lcp.time_step import FrictionalStep as FrictionalStep
    from reference_lcp.observables.stick_slip import Mode as Mode
    from reference_lcp.observables.stick_slip import dissipated_energy as dissipated_energy
    from reference_lcp.observables.stick_slip import stuck_fraction as stuck_fraction
    from reference_lcp.observables.stick_slip import transitions as transitions
    from reference_lcp.observables.transmittance import decibel as decibel
    from reference_lcp.observables.transmittance import transmittance as transmittance
    from reference_lcp.one_call import SteadyState as SteadyState
    from reference_lcp.one_call import exact_steady_state as exact_steady_state
    from reference_lcp.one_call import simulate as simulate
    from reference_lcp.one_call import steady_state as steady_state
    from reference_lcp.schemes.euler import CompiledSimulation as CompiledSimulation
    from reference_lcp.steady.orbits import periodic_orbits as periodic_orbits

_NAMES = {
    "chain.drives": ["HarmonicBase", "HarmonicForce", "StillBase"],
    "chain.linear_response": ["frictionless_transmittance", "stuck_transmittance"],
    "chain.mass_in_mass": ["Chain"],
    "chain.preload": ["Preload"],
    "chain.simulation": ["Lane", "PeriodicOrbit"],
    "chain.trajectory": ["State", "Trajectory"],
    "chain.transient": ["FilteredNoise", "RecordedBase", "RickerPulse", "SweptSine"],
    "errors": ["ParameterError"],
    "exact.event_driven_system": ["EventDrivenSystem"],
    "exact.proof.exact_chain": ["ExactChain"],
    "deadline": ["NotProven"],
    "exact.proof.prove": ["ProvenSteadyState", "prove", "prove_steady_state"],
    "lcp.lemke": ["lemke"],
    "lcp.systems": [
        "FrictionContact",
        "Harmonic",
        "MassSpringSystem",
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
