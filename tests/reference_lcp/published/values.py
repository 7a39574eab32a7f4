"""Every published number, as the event-driven motion gives it."""

import math

import numpy as np

from reference_lcp import EventDrivenSystem, MassSpringSystem
from tests.reference_lcp.published.anchors import brake, friction_oscillator, sdnd100, sdnd104, sdnd106

SDND106_TIMES = {"sdnd106-1": (0.02, 1), "sdnd106-2": (0.15, 0), "sdnd106-3": (0.15, 1), "sdnd106-5": (0.339965, 1)}
"""When [s] which mass is where it is printed."""


def half_turns(system: MassSpringSystem):
    """Where the mass of SDND100 turns, along y [m], shape (4,)."""
    times = np.pi / 100 * np.arange(1, 5)
    motion = EventDrivenSystem(system).motion(position=[0.85e-3], velocity=[0.0], times=times)
    return motion.positions[:, 0] * math.cos(math.pi / 4)


def wear_power(system: MassSpringSystem) -> float:
    """N times the mean |ġ_T| of SDND104 from 4 s to 12 s [W]."""
    stretches = EventDrivenSystem(system).stretches(position=[0.0], velocity=[0.0], end=12.0)
    return 10.0 * float(sum(stretch.sliding_distance(4.0, 12.0)[0] for stretch in stretches)) / 8.0


def sdnd106_motion(system: MassSpringSystem, time: float):
    """Positions [m] and velocities [m/s] of the two masses of SDND106 at a time [s]."""
    motion = EventDrivenSystem(system).motion(position=[0.0, 0.0], velocity=[0.0, 0.0], times=time)
    return motion.positions[0], motion.velocities[0]


def stopped(system: MassSpringSystem) -> float:
    """Where Brake stops [m]."""
    motion = EventDrivenSystem(system).motion(position=[0.0], velocity=[1.0], times=2.0)
    assert motion.velocities[0, 0] == 0
    return float(motion.positions[0, 0])


def oscillator_end(system: MassSpringSystem) -> float:
    """Where FrictionOscillator ends."""
    motion = EventDrivenSystem(system).motion(position=[12.0], velocity=[6.0], times=100.0)
    assert motion.velocities[0, 0] == 0
    return float(motion.positions[0, 0])


def exact_values() -> dict[str, float]:
    """Every number by its name, in the order in which they are published."""
    return {
        **{f"sdnd100-{turn}": float(y) for turn, y in enumerate(half_turns(sdnd100()), 1)},
        **{f"sdnd104-{amplitude:g}": wear_power(sdnd104(amplitude)) for amplitude in (15, 1.5, 1.01, 0.99)},
        **{name: float(sdnd106_motion(sdnd106(), time)[0][mass]) for name, (time, mass) in SDND106_TIMES.items()},
        "sdnd106-4": float(sdnd106_motion(sdnd106(), 0.339965)[1][0]),
        "brake": stopped(brake()),
        "friction-oscillator": oscillator_end(friction_oscillator()),
    }
