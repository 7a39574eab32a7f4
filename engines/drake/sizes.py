"""Lengths and speeds that Drake's contacts have beside the chain's, in SI units."""

from engines.shared.units import power_of_two
from reference_lcp.chain.simulation import Lane


def contact_scale(lane: Lane) -> float:
    """Give the power of two near the displacement scale [m]: depths are then exact."""
    return power_of_two(lane.drive.displacement_scale(lane.chain))


def sphere_depth(lane: Lane, depth: float) -> float:
    """Give the depth of a sphere at rest [m], from one over the displacement scale."""
    return depth * contact_scale(lane)


def stiction_speed(lane: Lane, stiction: float) -> float:
    """Give the velocity at which friction is near its bound [m/s], from one over s ω_r."""
    return stiction * lane.drive.displacement_scale(lane.chain) * lane.chain.resonator_frequency
