"""``python -m multibody_xval.scenarios.truth.record``: the problems, and their files with the exact motions.

Motions are those of `EventDrivenSystem`, without a time step; transmittances, phases and transitions of steady states
are proven in ball arithmetic. Numbers of a file are rounded to its uncertainty.
"""

import json
import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from decimal import Decimal
from pathlib import Path
from typing import Any

import numpy as np

from multibody_xval.scenarios.truth.problem import FORMAT, GROUND, Problem
from reference_lcp.chain.drives import HarmonicBase
from reference_lcp.chain.mass_in_mass import Chain
from reference_lcp.exact.event_driven_system import EventDrivenSystem
from reference_lcp.exact.exact_orbit import exact_orbit
from reference_lcp.exact.proof.exact_chain import ExactChain
from reference_lcp.exact.proof.prove import ProvenSteadyState, prove
from reference_lcp.lcp.systems import simulate_system
from reference_lcp.validation import FloatArray

FOLDER = Path(__file__).parent

UNCERTAINTY = 1e-11
"""Of a motion from event to event, over its largest number: ten times what another order of its sums changes."""

SMALLEST = 1e-13
"""Uncertainty of what hardly moves [m] or [m/s]: motions here are millimetres to metres."""

MARGIN = 2.0
"""What a scheme of first order may be off, over the error of the symplectic Euler scheme: constants differ."""

SINGLE = float(np.finfo(np.float32).eps)
"""Rounding of engines in single precision: what stands still may creep by that of a step, and no more."""

GRAVITY = 9.81
"""[m/s²]."""

STEP = 1e-3
"""Time step of blocks [s]."""

STEPS_PER_PERIOD = 400
"""Time steps of chains."""

OPERATING_POINTS = ((0.1, 0.6), (0.3, 0.9), (0.6, 0.7), (1.0, 1.2))
"""Friction and frequency ratios of the seven-cell chain: a pass band, and three places of the attenuation band."""

STEADY_PERIODS, PERIODS_FROM_REST = 4, 30
"""Periods for which chains are followed, from a steady state and from rest."""

ROWS = 12
"""Times of a motion, or of the last period of it."""

Data = dict[str, Any]


@dataclass
class Draft:
    """What a problem consists of before its motion is known, its names those of `Problem`."""

    name: str
    title: str
    build: str
    data: Data
    time_step: float
    steps: Sequence[int]
    """Number of steps after which the motion is compared."""
    observables: dict[str, tuple[str, str, str]] = field(default_factory=dict)
    transitions: list[Data] = field(default_factory=list)


def blocks(masses: Sequence[float], forces: Sequence[float], normal: Sequence[float], kinetic: Sequence[float]) -> Data:
    """Give blocks on the ground, each with its own contact and constant force."""
    zeros, every = [0.0] * len(masses), list(range(len(masses)))
    return {
        "masses": list(masses),
        "angular_frequency": 0.0,
        "contact_first": every,
        "contact_second": [GROUND] * len(masses),
        "contact_normal_force": list(normal),
        "contact_normal_amplitude": zeros,
        "contact_kinetic": list(kinetic),
        "contact_static": list(kinetic),
        "force_body": every,
        "force_mean": list(forces),
        "force_amplitude": zeros,
        "start_position": zeros,
        "start_velocity": zeros,
    }


def chain_data(chain: Chain, drive: HarmonicBase, start: FloatArray) -> Data:
    """Give a chain, outer masses first, then inner ones; `start` holds positions and velocities, shape (2, 2n)."""
    n = chain.cells
    outer, inner = list(range(n)), list(range(n, 2 * n))
    return {
        "masses": [*chain.outer_mass.tolist(), *chain.inner_mass.tolist()],
        "angular_frequency": drive.angular_frequency,
        "base_amplitude": drive.amplitude,
        "spring_first": [*outer, *inner],
        "spring_second": [GROUND, *outer[:-1], *outer],
        "spring_stiffness": [*chain.chain_stiffness.tolist(), *chain.inner_stiffness.tolist()],
        "spring_damping": [*chain.chain_damping.tolist(), *chain.inner_damping.tolist()],
        "contact_first": inner,
        "contact_second": outer,
        "contact_normal_force": chain.normal_force.tolist(),
        "contact_normal_amplitude": [0.0] * n,
        "contact_kinetic": chain.friction_coefficient.tolist(),
        "contact_static": chain.friction_coefficient.tolist(),
        "start_position": start[0].tolist(),
        "start_velocity": start[1].tolist(),
    }


def known(value: float, unit: str, radius: float = 1e-14) -> tuple[str, str, str]:
    """Give an observable of closed form, to round-off."""
    return repr(value), repr(radius * abs(value)), unit


TENTHS = range(100, 1001, 100)
"""Steps of blocks after which a motion is compared: tenths of a second."""


def block_problems() -> Iterator[Draft]:
    """Give blocks on a plane."""
    plane = "A block of 2 kg on a level plane, or on a rail with a dry friction of 3 N in its joint"
    one = blocks([2.0], [1.5], [6.0], [0.5])
    yield Draft("block-held", "A block is held", f"{plane}; half of that pulls, and it stays.", one, STEP, TENTHS)
    sine = one | {"force_mean": [0.0], "force_amplitude": [6.0], "angular_frequency": math.pi}
    begin = {"breakaway_time": known(math.asin(0.5) / math.pi, "s")}
    yield Draft("block-breaks-away", "A block breaks away", f"{plane}; 6 N sin πt pull.", sine, STEP, TENTHS, begin)
    thrown = one | {"force_mean": [0.0], "start_velocity": [1.0]}
    end = {"stopping_time": known(2 / 3, "s"), "stopping_distance": known(1 / 3, "m")}
    yield Draft("block-stops", "A block comes to rest", f"{plane}; it starts with 1 m/s.", thrown, STEP, TENTHS, end)
    static = sine | {
        "contact_kinetic": [0.5],
        "contact_static": [0.75],
        "spring_first": [0],
        "spring_second": [GROUND],
        "spring_stiffness": [50.0],
        "spring_damping": [0.0],
    }
    yield Draft(
        "static-above-kinetic",
        "Static friction above kinetic friction",
        "A block of 2 kg on a plane, pressed by 6 N, μ_s 0.75 and μ_k 0.5, held by a spring; 6 N sin πt pull.",
        static,
        STEP,
        TENTHS,
    )


REPOSE = {0.2: (5, 11, 12, 20), 0.5: (15, 26, 27, 40), 0.8: (30, 38, 39, 45)}
"""Angles [°] by coefficient of friction: two below and two above each angle of repose, 11.31°, 26.57°, 38.66°."""


def slope_problems() -> Iterator[Draft]:
    """Give boxes on slopes and planes, pressed by gravity."""
    slopes = [(mu, angle) for mu, angles in REPOSE.items() for angle in angles]
    angles = [math.radians(angle) for _, angle in slopes]
    pulls = [2 * GRAVITY * math.sin(angle) for angle in angles]
    presses = [2 * GRAVITY * math.cos(angle) for angle in angles]
    boxes = ", ".join(f"μ {mu:g} on {angle}°" for mu, angle in slopes)
    grid = blocks([2.0] * len(angles), pulls, presses, [mu for mu, _ in slopes])
    yield Draft(
        "slope-grid",
        "Boxes on slopes",
        f"Twelve boxes of 2 kg, each on a slope of its own, 9.81 m/s²: {boxes}. Positions are down the slope.",
        grid,
        STEP,
        TENTHS,
    )
    thrown = blocks([2.0], [0.0], [2 * GRAVITY], [0.5]) | {"start_velocity": [2.0]}
    end = {"stopping_time": known(2 / (0.5 * GRAVITY), "s"), "stopping_distance": known(2 / (0.5 * GRAVITY), "m")}
    yield Draft(
        "launched-box",
        "A launched box comes to rest",
        "A box of 2 kg on a level plane, μ 0.5, 9.81 m/s², starts with 2 m/s.",
        thrown,
        STEP,
        TENTHS,
        end,
    )
    angle, push = math.radians(15), 30.0
    pushed = blocks([2.0], [-2 * GRAVITY * math.sin(angle)], [2 * GRAVITY * math.cos(angle)], [0.3])
    pushed |= {
        "angular_frequency": 2 * math.pi,
        "force_amplitude": [push * math.cos(angle)],
        "contact_normal_amplitude": [push * math.sin(angle)],
    }
    yield Draft(
        "pushed-up-a-slope",
        "A level force pushes a box up a slope",
        "A box of 2 kg on a slope of 15°, μ 0.3, 9.81 m/s²; 30 N sin 2πt push it level, into the slope and up: the "
        "force also presses. Positions are up the slope.",
        pushed,
        STEP,
        TENTHS,
    )


def free_decay() -> Draft:
    """Give the two masses of one cell that are let go."""
    chain = Chain.from_ratios(friction_ratio=0.1, cells=1)
    start = np.array([[0.01, -0.01], [0.0, 0.0]])
    data = chain_data(chain, HarmonicBase(1.0, 1.0), start) | {"base_amplitude": 0.0, "angular_frequency": 0.0}
    step = 2 * math.pi / chain.resonator_frequency / STEPS_PER_PERIOD
    return Draft(
        "cell-let-go",
        "Free decay of a mass in a mass",
        "A mass of 1 kg on a spring and dashpot to the ground; in it slides another one on a spring, with a dry "
        "friction of 1 N. Both are let go 10 mm from where springs are without force, to opposite sides.",
        data,
        step,
        range(100, 2001, 100),
    )


CHAIN = (
    "Seven masses in a row, 1 kg, on springs of 1000 N/m and dashpots, the first one's to a base that moves as 10 mm "
    "sin ωt; in each slides another mass of 1 kg on a spring of 1000 N/m, with dry friction. Bodies 0 to 6 are the "
    "outer masses, 7 to 13 the inner ones."
)


def chain_problems() -> Iterator[Draft]:
    """Give the chain at its operating points, in its steady state and from rest, and its two linear limits."""
    for friction, frequency in OPERATING_POINTS:
        proven = proven_state(friction, frequency)
        place = f"{friction:g}-{frequency:g}"
        yield steady(f"chain-steady-{place}", "A chain in its steady state", friction, frequency, proven)
        yield from_rest(f"chain-from-rest-{place}", friction, frequency)
    yield steady("chain-frictionless", "A chain without friction", 0.0, 0.9, proven_state(0.0, 0.9))
    yield steady("chain-locked", "A chain whose contacts never slip", 100.0, 0.5, proven_state(100.0, 0.5))


def proven_state(friction: float, frequency: float) -> ProvenSteadyState:
    """Prove a steady state of the seven cells."""
    return prove(ExactChain.from_ratios(friction_ratio=str(friction), frequency_ratio=str(frequency)))


def steady(name: str, title: str, friction: float, frequency: float, proven: ProvenSteadyState) -> Draft:
    """Give the chain that starts in its steady state."""
    chain = Chain.from_ratios(friction_ratio=friction)
    drive = HarmonicBase.from_ratio(chain, frequency)
    orbit, _ = exact_orbit(chain, drive)
    end = orbit.trajectory.end
    observables = {
        "transmittance": (*_texts(proven.transmittance_db), "dB"),
        "phase": (*_texts(proven.phase), "rad"),
    }
    transitions = [
        {"contact": change.cell - 1, "kind": str(change.kind), "time": _enclosed(*_texts(change.time), "1")}
        for change in proven.transitions
    ]
    last = STEPS_PER_PERIOD * (STEADY_PERIODS - 1)
    return Draft(
        name,
        title,
        f"{CHAIN} {ratios_text(friction, frequency)} It starts in its steady state.",
        chain_data(chain, drive, np.stack([end.positions[0], end.velocities[0]])),
        drive.period / STEPS_PER_PERIOD,
        [last + STEPS_PER_PERIOD * row // ROWS for row in range(1, ROWS + 1)],
        observables,
        transitions,
    )


def from_rest(name: str, friction: float, frequency: float) -> Draft:
    """Give the chain that starts from rest."""
    chain = Chain.from_ratios(friction_ratio=friction)
    drive = HarmonicBase.from_ratio(chain, frequency)
    return Draft(
        name,
        "A chain from rest",
        f"{CHAIN} {ratios_text(friction, frequency)} All start from rest, the base with its own velocity.",
        chain_data(chain, drive, np.zeros((2, 14))),
        drive.period / STEPS_PER_PERIOD,
        [STEPS_PER_PERIOD * period for period in range(1, PERIODS_FROM_REST + 1)],
    )


def ratios_text(friction: float, frequency: float) -> str:
    """Say which operating point it is."""
    return f"Friction is {friction:g} of k U0, ω {frequency:g} of the resonance of the inner masses."


def _texts(number: Any) -> tuple[str, str]:
    return str(number.value), str(number.radius)


def _enclosed(value: str, radius: str, unit: str) -> Data:
    return {"value": value, "radius": radius, "unit": unit}


def completed(draft: Draft) -> Problem:
    """Give the problem with its exact motion, and what a step may be off."""
    empty: Data = {"base_amplitude": 0.0} | {
        name: [] for name in Problem.model_fields if name.startswith(("spring_", "force_"))
    }
    times = [draft.time_step * count for count in draft.steps]
    unknown: Data = {"positions": [], "velocities": [], "position_error": [], "velocity_error": []}
    words = {"format": FORMAT, "name": draft.name, "title": draft.title, "build": draft.build}
    problem = Problem.model_validate(
        words
        | empty
        | draft.data
        | unknown
        | {"time_step": draft.time_step, "times": times, "transitions": draft.transitions}
        | {"position_uncertainty": 1.0, "velocity_uncertainty": 1.0}
        | {"observables": {name: _enclosed(*each) for name, each in draft.observables.items()}}
    )
    return problem.model_copy(update=_motion(problem, draft.steps))


def _motion(problem: Problem, steps: Sequence[int]) -> Data:
    """Give the exact motion at the times of a problem, its uncertainty, and the errors of a scheme of first order."""
    system, h = problem.system, problem.time_step
    state: Data = {"position": problem.start_position, "velocity": problem.start_velocity}
    every = h * np.arange(1, max(steps) + 2)
    exact = EventDrivenSystem(system).motion(**state, times=every)
    scheme = simulate_system(system, **state, time_step=h, steps=max(steps))
    rows, speed = np.array(steps) - 1, _rounding(problem)
    at_rest = {"velocity": speed, "position": speed * float(every[rows[-1]])}
    data: Data = {}
    for name in ("position", "velocity"):
        many = "positions" if name == "position" else "velocities"
        values, own = getattr(exact, many), getattr(scheme, many)
        uncertainty = _rounded_up(max(UNCERTAINTY * float(np.max(np.abs(values))), SMALLEST))
        late = np.max(np.abs(values[rows + 1] - values[rows]), axis=0)
        error = MARGIN * np.maximum(np.max(np.abs(own[rows] - values[rows]), axis=0), late)
        digits = 1 - math.floor(math.log10(uncertainty))
        data[many] = [[_rounded(value, digits) for value in row] for row in values[rows].tolist()]
        data[f"{name}_uncertainty"] = uncertainty
        data[f"{name}_error"] = [_rounded_up(each) for each in np.maximum(error, at_rest[name]).tolist()]
    return data


def _rounding(problem: Problem) -> FloatArray:
    """Give the velocity [m/s] with which what is at rest moves by the rounding of single precision, body by body."""
    largest = np.zeros(len(problem.masses) + 1)
    for first, second, normal, static in zip(
        problem.contact_first, problem.contact_second, problem.contact_normal_force, problem.contact_static, strict=True
    ):
        largest[[first, second]] = np.maximum(largest[[first, second]], static * normal)
    return MARGIN * SINGLE * problem.time_step * largest[:-1] / np.array(problem.masses)


def _rounded(value: float, digits: int) -> float:
    """Round to so many decimals, without a negative zero."""
    return round(value, digits) + 0.0


def _rounded_up(value: float) -> float:
    """Round up to two digits."""
    if value == 0:
        return 0.0
    exponent = math.floor(math.log10(value)) - 1
    return float(Decimal(math.ceil(value / 10.0**exponent)).scaleb(exponent))


def drafts() -> Iterator[Draft]:
    """Give all problems."""
    yield from block_problems()
    yield from slope_problems()
    yield free_decay()
    yield from chain_problems()


def text_of(problem: Problem) -> str:
    """Give the file of a problem: a name a line, and a row of the motion a line."""
    lines = [f' "{name}": {_value(value)}' for name, value in problem.model_dump().items()]
    return "{\n" + ",\n".join(lines) + "\n}\n"


def _value(value: Any) -> str:
    if isinstance(value, list) and value and isinstance(value[0], (list, dict)):
        return "[\n  " + ",\n  ".join(json.dumps(row, ensure_ascii=False) for row in value) + "\n ]"
    return json.dumps(value, ensure_ascii=False)


def main() -> None:
    """Write all files."""
    for draft in drafts():
        problem = completed(draft)
        (FOLDER / "problems" / f"{problem.name}.json").write_text(text_of(problem), encoding="utf-8")
    schema = json.dumps(Problem.model_json_schema(), indent=1, ensure_ascii=False)
    (FOLDER / "problem.schema.json").write_text(schema + "\n", encoding="utf-8")


if __name__ == "__main__":
    main()
