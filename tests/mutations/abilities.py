"""Mutants whose contacts hold more at rest, have a direction, or part; and that are wrong only there."""

from dataclasses import replace
from typing import Any

import numpy as np

from reference_lcp.chain.simulation import Lane
from reference_lcp.chain.trajectory import Trajectory
from tests.mutations.altered import Built, of_lanes, of_records
from tests.mutations.errors import with_bound
from tests.mutations.mutant import Mutant


def _static_ratio(lane: Lane, size: float) -> Lane:
    return replace(lane, static_ratio=(1 + size) * lane.static_ratio) if lane.static_ratio > 1 else lane


def _kinetic_bound(lane: Lane, size: float) -> Lane:
    """Make friction in motion smaller, and that at rest as it is given."""
    if lane.static_ratio == 1:
        return lane
    return replace(with_bound(lane, 1 / (1 + size)), static_ratio=(1 + size) * lane.static_ratio)


def _pyramid(lane: Lane, size: float) -> Lane:
    """Make the cone a part of the way a pyramid, with edges between the axes."""
    edge = abs(np.cos(lane.direction)) + abs(np.sin(lane.direction)) - 1
    return with_bound(lane, 1 + size * edge) if lane.direction else lane


def _gap(run: Trajectory, size: float) -> Trajectory:
    return run if run.normal_gap is None else replace(run, normal_gap=(1 + size) * run.normal_gap)


def _flies(lane: Lane, size: float) -> Lane:
    """Press harder where contacts open: they part later, and land sooner."""
    if not lane.opens:
        return lane
    return replace(lane, chain=replace(lane.chain, normal_force=(1 + size) * lane.chain.normal_force))


def _named(name: str, error: str, build: Built, **given: Any) -> Mutant:
    return Mutant(name=name, error=error, build=build, **given)


ABILITIES = (
    _named("static-ratio", "μ_s / μ_k × (1 + s)", of_lanes(_static_ratio), static_friction=True, size=0.1),
    _named(
        "static-kinetic", "μ_k over (1 + s), μ_s as given", of_lanes(_kinetic_bound), static_friction=True, size=0.1
    ),
    _named("direction-pyramid", "a friction cone, s of the way to a pyramid", of_lanes(_pyramid), contact=True),
    _named("gap", "recorded gap × (1 + s)", of_records(_gap)),
    _named("flight-load", "normal force × (1 + s) where contacts open", of_lanes(_flies)),
)
