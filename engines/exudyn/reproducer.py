"""Options of Exudyn's presets as its settings and the parameters of its connectors, in SI units."""

from collections.abc import Mapping
from typing import Any

import numpy as np

from multibody_xval.engines.exudyn.contact import INERTIA, contact_springs
from multibody_xval.engines.exudyn.joint import bristles, bristles_at, static_decays, zone_widths
from multibody_xval.engines.interface.presets import Preset
from multibody_xval.engines.shared.script_units import SI
from multibody_xval.engines.shared.units import Units
from reference_lcp.chain.simulation import Lane
from reference_lcp.chain.trajectory import State
from reference_lcp.validation import FloatArray


def zone_numbers(lane: Lane, preset: Preset, _start: State) -> Mapping[str, Any]:
    """Give the width of the zone, and the settings of the solver."""
    zone = zone_widths(lane, preset)
    return {**_solver(lane, preset), **_static(lane, zone), "zone": zone, "bristles": False}


def bristle_numbers(lane: Lane, preset: Preset, start: State) -> Mapping[str, Any]:
    """Give the bristles, each with the load that it meets at first, and the settings of the solver."""
    stiffness, damping = bristles(lane, preset, SI)
    slip, deflection = bristles_at(start, lane, float(lane.loads(0, 1)[0]), stiffness, damping)
    outer, inner = np.split(start.positions[0], 2)
    return {
        **_solver(lane, preset),
        **_static(lane, static_decays(lane, preset, SI)),
        "bristles": True,
        "slip": slip,
        "foot": inner - outer - deflection,
        "sticking_stiffness": stiffness,
        "sticking_damping": damping,
    }


def disc_numbers(lane: Lane, preset: Preset, start: State) -> Mapping[str, Any]:
    """Give stiffness and depth of the discs, the width of the zone, and the settings of the solver."""
    units = Units.in_steps(preset["units"], lane)
    stiffness, damping = contact_springs(lane.chain, lane.time_step, preset["substeps"])
    return {
        **_solver(lane, preset),
        "zone": zone_widths(lane, preset),
        "linear": ", useLinearProportionalZone=True" if preset["useLinearProportionalZone"] else "",
        "stiffness": stiffness,
        "damping": damping,
        "depth": lane.chain.normal_force / stiffness,
        "slip": -np.diff(start.velocities.reshape(2, -1), axis=0)[0],
        "radius": units.length,
        "inertia": INERTIA * units.mass * units.length**2,
    }


def _static(lane: Lane, decay: FloatArray) -> Mapping[str, Any]:
    """Give what static friction is above kinetic friction, if it is, and the slip velocity at which that decays."""
    return {
        "offset": (lane.static_ratio - 1) * lane.chain.friction_bound if lane.static_ratio > 1 else None,
        "decay": decay,
    }


def _solver(lane: Lane, preset: Preset) -> Mapping[str, Any]:
    """Give the settings that differ from Exudyn's own; forces of the units of a lane are some of newtons."""
    force = Units.in_steps(preset["units"], lane).force
    settings = {
        "newton.relativeTolerance": ("relative_tolerance", 1.0),
        "newton.absoluteTolerance": ("absolute_tolerance", force),
        "discontinuous.maxIterations": ("discontinuous_iterations", 1),
        "discontinuous.iterationTolerance": ("discontinuous_tolerance", force),
    }
    changed = {
        name: preset[option] * factor
        for name, (option, factor) in settings.items()
        if option in preset.options and preset[option] != preset.options[option].default
    }
    if preset["solver"] == "Newmark":
        changed["generalizedAlpha.useNewmark"] = True
    substeps = f"{preset['substeps']} * " if preset["substeps"] > 1 else ""
    return {"solver": changed, "substeps": substeps, "smallest": preset["smallest_step"]}
