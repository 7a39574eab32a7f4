"""Systems whose motion others have published, the numbers that they print, and the same of the exact motion."""

import csv
import math
from pathlib import Path
from typing import NamedTuple

import numpy as np

from reference_lcp import EventDrivenSystem, FrictionContact, Harmonic, MassSpringSystem, Piecewise, Spring

ROOT = Path(__file__).parents[3]


class Anchor(NamedTuple):
    """A published number, and by how much it may be off as it is printed."""

    value: float
    uncertainty: float


def _anchors() -> dict[str, Anchor]:
    with (ROOT / "scenarios/catalogue/blocks/published.csv").open(encoding="utf-8") as file:
        return {row["id"]: Anchor(float(row["value"]), float(row["uncertainty"])) for row in csv.DictReader(file)}


ANCHORS = _anchors()


def rows(name: str):
    """Columns of a table of a target sheet, shape (columns, rows)."""
    return np.loadtxt(ROOT / "docs/targets" / f"{name}.csv", delimiter=",", skiprows=1).T


def sdnd100(coefficient: float = 0.1) -> MassSpringSystem:
    """A mass of 1 kg on a spring, under its own weight with g = 10 m/s²; along its axis, at 45° to y."""
    contact = FrictionContact(0, normal_force=10.0, coefficient=coefficient)
    return MassSpringSystem(masses=np.array([1.0]), springs=[Spring(0, stiffness=1e4)], friction=[contact])


def sdnd104(amplitude: float, coefficient: float = 0.1) -> MassSpringSystem:
    """A mass of 1 kg on a table with the acceleration A sin 2πt, seen from the table."""
    contact = FrictionContact(0, normal_force=10.0, coefficient=coefficient)
    inertia = Harmonic(amplitude=-amplitude, angular_frequency=2 * math.pi)
    return MassSpringSystem(masses=np.array([1.0]), friction=[contact], forces={0: inertia})


def sdnd106(static: float = 0.3) -> MassSpringSystem:
    """Two masses with a spring, of which one is pulled for 0.2 s and the other rubs."""
    contact = FrictionContact(0, normal_force=1e4, coefficient=0.2, static_coefficient=static)
    pull = Piecewise({0.0: 3e3, 0.2: 0.0})
    return MassSpringSystem(
        masses=np.array([5.0, 5.0]), springs=[Spring(0, 1, stiffness=1e4)], friction=[contact], forces={1: pull}
    )


def brake(force: float = 1.0) -> MassSpringSystem:
    """A free mass whose brake closes at 0.1 s."""
    pressed = Piecewise({0.0: 0.0, 0.1: force})
    return MassSpringSystem(
        masses=np.array([1.0]), friction=[FrictionContact(0, normal_force=pressed, coefficient=1.0)]
    )


def friction_oscillator(bound: float = 1.0) -> MassSpringSystem:
    """A mass on a spring, all of it one."""
    contact = FrictionContact(0, normal_force=bound, coefficient=1.0)
    return MassSpringSystem(masses=np.array([1.0]), springs=[Spring(0, stiffness=1.0)], friction=[contact])


CLUTCH_PEAK = 1.1
"""Static over kinetic friction of every clutch."""


def coupled_clutches(order=(0, 1, 2), peak: float = CLUTCH_PEAK, coefficient: float = 0.5) -> MassSpringSystem:
    """Four inertias in a row and three clutches, given by their normal forces in the published order."""
    forces = (
        Piecewise({0.0: Harmonic(amplitude=20.0, angular_frequency=0.4 * math.pi, phase=math.pi / 2), 1.25: 0.0}),
        Piecewise({0.0: 0.0, 0.4: 20.0}),
        Piecewise({0.0: 0.0, 0.9: 20.0}),
    )
    clutches = [
        FrictionContact(k + 1, k, normal_force=forces[pressed], coefficient=coefficient, static_coefficient=0.5 * peak)
        for k, pressed in enumerate(order)
    ]
    torque = Harmonic(amplitude=10.0, angular_frequency=10 * math.pi)
    return MassSpringSystem(masses=np.ones(4), friction=clutches, forces={0: torque})


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
