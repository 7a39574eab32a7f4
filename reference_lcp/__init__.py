"""The reference: LCP time stepping of the frictional mass-in-mass chain after Sethi, Banerjee and Manna."""

from reference_lcp.accuracy.error_bar import ErrorBar, measured_error_bar
from reference_lcp.chain.harmonic import Drive, HarmonicBase, HarmonicForce, MovingBase, PeriodicDrive, StillBase
from reference_lcp.chain.linear_response import (
    frictionless_response,
    frictionless_transmittance,
    stuck_response,
    stuck_transmittance,
)
from reference_lcp.chain.mass_in_mass import Chain
from reference_lcp.chain.preload import Flight, Preload
from reference_lcp.chain.record import RecordedBase
from reference_lcp.chain.simulation import Lane, Simulation, steps_per_period_for
from reference_lcp.chain.trajectory import State, Trajectory
from reference_lcp.chain.transient import FilteredNoise, RickerPulse, SweptSine
from reference_lcp.exact.event_driven import EventDrivenChain, EventDrivenSimulation, EventsAccumulate
from reference_lcp.exact.exact_orbit import ExactPeriod
from reference_lcp.lcp.frictional_system import FrictionalSystem, SystemTrajectory, simulate_system
from reference_lcp.lcp.inclined_chain import InclinedChain
from reference_lcp.lcp.lemke import LemkeResult, LemkeStatus, lemke, natural_residual
from reference_lcp.lcp.time_step import (
    ContactImpulses,
    FrictionalStep,
    StepFailed,
    advanced,
    assemble,
    assemble_given_normal_force,
    solve_step,
    solve_step_given_normal_force,
)
from reference_lcp.observables.stick_slip import (
    Mode,
    Transition,
    contact_modes,
    creep_velocity,
    dissipated_energy,
    largest_gap,
    open_fraction,
    stuck_fraction,
    transitions,
)
from reference_lcp.observables.transmissibility import (
    Transmissibility,
    stationary_transmissibility,
    transient_transmissibility,
)
from reference_lcp.observables.transmittance import decibel, fundamental, rms_transmittance, transmittance
from reference_lcp.steady.orbits import OrbitStatus, PeriodicOrbit, periodic_orbits
from reference_lcp.steady_state import SOLVERS, SteadyState, exact_steady_state, simulate, steady_state
from reference_lcp.stepping.euler_compiled import CompiledSimulation
from reference_lcp.stepping.euler_lemke import LemkeSimulation, chain_step
from reference_lcp.validation import ParameterError

__all__ = [
    "SOLVERS",
    "Chain",
    "CompiledSimulation",
    "ContactImpulses",
    "Drive",
    "ErrorBar",
    "EventDrivenChain",
    "EventDrivenSimulation",
    "EventsAccumulate",
    "ExactPeriod",
    "FilteredNoise",
    "Flight",
    "FrictionalStep",
    "FrictionalSystem",
    "HarmonicBase",
    "HarmonicForce",
    "InclinedChain",
    "Lane",
    "LemkeResult",
    "LemkeSimulation",
    "LemkeStatus",
    "Mode",
    "MovingBase",
    "OrbitStatus",
    "ParameterError",
    "PeriodicDrive",
    "PeriodicOrbit",
    "Preload",
    "RecordedBase",
    "RickerPulse",
    "Simulation",
    "State",
    "SteadyState",
    "StepFailed",
    "StillBase",
    "SweptSine",
    "SystemTrajectory",
    "Trajectory",
    "Transition",
    "Transmissibility",
    "advanced",
    "assemble",
    "assemble_given_normal_force",
    "chain_step",
    "contact_modes",
    "creep_velocity",
    "decibel",
    "dissipated_energy",
    "exact_steady_state",
    "frictionless_response",
    "frictionless_transmittance",
    "fundamental",
    "largest_gap",
    "lemke",
    "measured_error_bar",
    "natural_residual",
    "open_fraction",
    "periodic_orbits",
    "rms_transmittance",
    "simulate",
    "simulate_system",
    "solve_step",
    "solve_step_given_normal_force",
    "stationary_transmissibility",
    "steady_state",
    "steps_per_period_for",
    "stuck_fraction",
    "stuck_response",
    "stuck_transmittance",
    "transient_transmissibility",
    "transitions",
    "transmittance",
]
