"""What the problems are, before their motion is known: blocks on planes and slopes, a cell that is let go, chains."""

import math
from collections.abc import Iterator, Sequence
from typing import Any, NamedTuple

import numpy as np

from multibody_xval.engines.interface.scene import GRAVITY
from multibody_xval.scenarios.catalogue.proofs import exact_chain
from multibody_xval.scenarios.catalogue.scenes.sliding_boxes import deceleration, launch_speed, launched, way_to_stop
from multibody_xval.scenarios.model import Case
from multibody_xval.scenarios.truth.problem import GROUND
from reference_lcp.chain.drives import HarmonicBase
from reference_lcp.chain.mass_in_mass import Chain
from reference_lcp.exact.exact_orbit import exact_orbit
from reference_lcp.exact.proof.prove import prove
from reference_lcp.validation import FloatArray

STEP = 1e-3
"""Time step of blocks [s]."""

TENTHS = range(100, 1001, 100)
"""Steps of blocks after which a motion is compared: tenths of a second."""

STEPS_PER_PERIOD = 400
"""Time steps of chains."""

OPERATING_POINTS = tuple(
    Case(friction_ratio=friction, frequency_ratio=frequency)
    for friction, frequency in ((0.1, 0.6), (0.3, 0.9), (0.6, 0.7), (1.0, 1.2))
)
"""Of the seven-cell chain: a pass band, and three places of the attenuation band."""

FRICTIONLESS = Case(friction_ratio=0.0, frequency_ratio=0.9)
LOCKED = Case(friction_ratio=100.0, frequency_ratio=0.5)

STEADY_PERIODS, PERIODS_FROM_REST = 4, 30
"""Periods for which chains are followed, from a steady state and from rest."""

ROWS = 12
"""Times of the last period of a steady state."""

REPOSE = {0.2: (5, 11, 12, 20), 0.5: (15, 26, 27, 40), 0.8: (30, 38, 39, 45)}
"""Angles [°] by coefficient of friction: two below and two above each angle of repose, 11.31°, 26.57°, 38.66°."""

CHAIN = (
    "Seven masses in a row, 1 kg, on springs of 1000 N/m and dashpots, the first one's to a base that moves as 10 mm "
    "sin ωt; in each slides another mass of 1 kg on a spring of 1000 N/m, with dry friction. Bodies 0 to 6 are the "
    "outer masses, 7 to 13 the inner ones."
)

PLANE = "A block of 2 kg on a level plane, or on a rail with a dry friction of 3 N in its joint"

Data = dict[str, Any]
"""Values by the names of `Problem`."""


class Draft(NamedTuple):
    """A problem before its motion is known."""

    data: Data
    steps: Sequence[int]
    """Number of steps after which the motion is compared."""

    @property
    def name(self) -> str:
        """Its name."""
        return str(self.data["name"])


def drafts() -> Iterator[Draft]:
    """Give all problems."""
    for name, title, build, data in (*blocks(), *slopes()):
        yield Draft({"name": name, "title": title, "build": build, "time_step": STEP, **data}, TENTHS)
    yield free_decay()
    for case in OPERATING_POINTS:
        place = f"{case.friction_ratio:g}-{case.frequency_ratio:g}"
        yield steady(f"chain-steady-{place}", "A chain in its steady state", case)
        yield from_rest(f"chain-from-rest-{place}", case)
    yield steady("chain-frictionless", "A chain without friction", FRICTIONLESS)
    yield steady("chain-locked", "A chain whose contacts never slip", LOCKED)


def on_ground(forces: Sequence[float], normal: Sequence[float], friction: Sequence[float]) -> Data:
    """Give blocks of 2 kg on the ground, each with its own contact and constant force."""
    zeros, every = [0.0] * len(forces), list(range(len(forces)))
    return {
        "masses": [2.0] * len(forces), "angular_frequency": 0.0,
        "contact_first": every, "contact_second": [GROUND] * len(forces), "contact_normal_force": list(normal),
        "contact_normal_amplitude": zeros, "contact_kinetic": list(friction), "contact_static": list(friction),
        "force_body": every, "force_mean": list(forces), "force_amplitude": zeros,
        "start_position": zeros, "start_velocity": zeros,
    }  # fmt: skip


def known(value: float, unit: str) -> dict[str, str]:
    """Give an observable of closed form, to round-off."""
    return enclosed(repr(value), repr(1e-14 * abs(value)), unit)


def enclosed(value: object, radius: object, unit: str) -> dict[str, str]:
    """Give a number with its radius."""
    return {"value": str(value), "radius": str(radius), "unit": unit}


def blocks() -> Iterator[tuple[str, str, str, Data]]:
    """Give blocks on a plane: name, title, how they are built, and what they are."""
    held = on_ground([1.5], [6.0], [0.5])
    yield "block-held", "A block is held", f"{PLANE}; half of that pulls, and it stays.", held
    sine = held | {"force_mean": [0.0], "force_amplitude": [6.0], "angular_frequency": math.pi}
    begin = {"breakaway_time": known(math.asin(0.5) / math.pi, "s")}
    pulled = sine | {"observables": begin}
    yield "block-breaks-away", "A block breaks away", f"{PLANE}; 6 N sin πt pull.", pulled
    end = {"stopping_time": known(2 / 3, "s"), "stopping_distance": known(1 / 3, "m")}
    thrown = held | {"force_mean": [0.0], "start_velocity": [1.0], "observables": end}
    yield "block-stops", "A block comes to rest", f"{PLANE}; it starts with 1 m/s.", thrown
    spring: Data = {"spring_first": [0], "spring_second": [GROUND], "spring_stiffness": [50.0], "spring_damping": [0.0]}
    title = "Static friction above kinetic friction"
    build = "A block of 2 kg on a plane, pressed by 6 N, μ_s 0.75 and μ_k 0.5, held by a spring; 6 N sin πt pull."
    yield "static-above-kinetic", title, build, sine | {"contact_static": [0.75]} | spring


def slopes() -> Iterator[tuple[str, str, str, Data]]:
    """Give boxes on slopes and planes, pressed by gravity."""
    places = [(mu, angle) for mu, angles in REPOSE.items() for angle in angles]
    angles = [math.radians(angle) for _, angle in places]
    weights = [2 * GRAVITY * math.sin(angle) for angle in angles], [2 * GRAVITY * math.cos(angle) for angle in angles]
    boxes = ", ".join(f"μ {mu:g} on {angle}°" for mu, angle in places)
    build = f"Twelve boxes of 2 kg, each on a slope of its own, 9.81 m/s²: {boxes}. Positions are down the slope."
    yield "slope-grid", "Boxes on slopes", build, on_ground(*weights, [mu for mu, _ in places])
    scene = launched(2.0)
    time, way = launch_speed(scene) / deceleration(scene), way_to_stop(scene)
    end = {"stopping_time": known(time, "s"), "stopping_distance": known(way, "m")}
    box = on_ground([0.0], [2 * GRAVITY], [0.5]) | {"start_velocity": [2.0], "observables": end}
    build = "A box of 2 kg on a level plane, μ 0.5, 9.81 m/s², starts with 2 m/s."
    yield "launched-box", "A launched box comes to rest", build, box
    angle, push = math.radians(15), 30.0
    pushed = on_ground([-2 * GRAVITY * math.sin(angle)], [2 * GRAVITY * math.cos(angle)], [0.3]) | {
        "angular_frequency": 2 * math.pi,
        "force_amplitude": [push * math.cos(angle)],
        "contact_normal_amplitude": [push * math.sin(angle)],
    }
    build = (
        "A box of 2 kg on a slope of 15°, μ 0.3, 9.81 m/s²; 30 N sin 2πt push it level, into the slope and up: the "
        "force also presses. Positions are up the slope."
    )
    yield "pushed-up-a-slope", "A level force pushes a box up a slope", build, pushed


def chain_data(chain: Chain, drive: HarmonicBase, start: FloatArray) -> Data:
    """Give a chain, outer masses first, then inner ones; `start` holds positions and velocities, shape (2, 2n)."""
    n, coefficient = chain.cells, chain.friction_coefficient.tolist()
    outer, inner = list(range(n)), list(range(n, 2 * n))
    return {
        "masses": [*chain.outer_mass.tolist(), *chain.inner_mass.tolist()],
        "angular_frequency": drive.angular_frequency, "base_amplitude": drive.amplitude,
        "spring_first": [*outer, *inner], "spring_second": [GROUND, *outer[:-1], *outer],
        "spring_stiffness": [*chain.chain_stiffness.tolist(), *chain.inner_stiffness.tolist()],
        "spring_damping": [*chain.chain_damping.tolist(), *chain.inner_damping.tolist()],
        "contact_first": inner, "contact_second": outer, "contact_normal_force": chain.normal_force.tolist(),
        "contact_normal_amplitude": [0.0] * n, "contact_kinetic": coefficient, "contact_static": coefficient,
        "start_position": start[0].tolist(), "start_velocity": start[1].tolist(),
    }  # fmt: skip


def free_decay() -> Draft:
    """Give the two masses of one cell that are let go."""
    chain = Chain.from_ratios(friction_ratio=0.1, cells=1)
    start = np.array([[0.01, -0.01], [0.0, 0.0]])
    words = {
        "name": "cell-let-go",
        "title": "Free decay of a mass in a mass",
        "build": "A mass of 1 kg on a spring and dashpot to the ground; in it slides another one on a spring, with a "
        "dry friction of 1 N. Both are let go 10 mm from where springs are without force, to opposite sides.",
        "time_step": 2 * math.pi / chain.resonator_frequency / STEPS_PER_PERIOD,
    }
    still = {"base_amplitude": 0.0, "angular_frequency": 0.0}
    return Draft(words | chain_data(chain, HarmonicBase(1.0, 1.0), start) | still, range(100, 2001, 100))


def steady(name: str, title: str, case: Case) -> Draft:
    """Give the chain that starts in its steady state, with what is proven of that."""
    chain, drive = _setting(case)
    orbit, _ = exact_orbit(chain, drive)
    end, proven = orbit.trajectory.end, prove(exact_chain(case))
    numbers = {"transmittance": (proven.transmittance_db, "dB"), "phase": (proven.phase, "rad")}
    data = _chain_words(name, title, case, "It starts in its steady state.")
    data |= chain_data(chain, drive, np.stack([end.positions[0], end.velocities[0]]))
    data["observables"] = {key: enclosed(own.value, own.radius, unit) for key, (own, unit) in numbers.items()}
    data["transitions"] = [
        {"contact": own.cell - 1, "kind": str(own.kind), "time": enclosed(own.time.value, own.time.radius, "1")}
        for own in proven.transitions
    ]
    last = STEPS_PER_PERIOD * (STEADY_PERIODS - 1)
    return Draft(data, [last + STEPS_PER_PERIOD * row // ROWS for row in range(1, ROWS + 1)])


def from_rest(name: str, case: Case) -> Draft:
    """Give the chain that starts from rest."""
    chain, drive = _setting(case)
    data = _chain_words(name, "A chain from rest", case, "All start from rest, the base with its own velocity.")
    data |= chain_data(chain, drive, np.zeros((2, 14)))
    return Draft(data, [STEPS_PER_PERIOD * period for period in range(1, PERIODS_FROM_REST + 1)])


def _setting(case: Case) -> tuple[Chain, HarmonicBase]:
    chain, drive = case.setting
    assert isinstance(drive, HarmonicBase), "a base that moves"
    return chain, drive


def _chain_words(name: str, title: str, case: Case, start: str) -> Data:
    friction, frequency = case.friction_ratio, case.frequency_ratio
    place = f"Friction is {friction:g} of k U0, ω {frequency:g} of the resonance of the inner masses."
    step = _setting(case)[1].period / STEPS_PER_PERIOD
    return {"name": name, "title": title, "build": f"{CHAIN} {place} {start}", "time_step": step}
