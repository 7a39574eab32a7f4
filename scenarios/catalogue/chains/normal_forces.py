"""A normal force that swings with the drive: friction that follows it, and contacts that open and land.

An actuator presses the masses of every cell together with N(t) = N0 (1 + a sin Ωt), Ω a multiple of the drive's ω.
Across the row nothing else acts, so that λ_N(t) does not depend on the motion along it: friction stays monotone, and
the steady state is unique. For a < 1 contacts stay closed, and every formulation with a variable bound can follow.
For a > 1 they open: the inner mass flies, lands without rebound, and its impact rubs. There numbers are measured, and
not judged.
"""

import math

from multibody_xval.scenarios.catalogue.scenario import STICK_SLIP, TRANSMITTANCE, Quantity, Scenario
from multibody_xval.scenarios.model import Case, Run
from multibody_xval.scenarios.result_tables import CLOSED
from reference_lcp.chain.preload import Flight

STEPS = 800
"""Per period: an impact falls anywhere in a step."""

FRICTION_RATIO = 0.3
"""Of the mean normal force: where contacts of figure 3 stick and slip most."""

CASES = {
    f"a = {modulation:g}, Ω = {multiple} ω, η_r = {eta:g}": Case(
        friction_ratio=FRICTION_RATIO, frequency_ratio=eta, modulation=modulation, modulation_multiple=multiple
    )
    for modulation in (0.5, 1.5)
    for multiple in (1, 2)
    for eta in (0.5, 0.7)
}
"""Below and above lift-off, at the drive's frequency and at twice it; in the pass band, where the error bar is small.

At (1.5, 2 ω, 0.9), deep in the stop band, responses cancel to −37 dB, and 800 steps leave an error bar of 8 dB.
"""


def flight(case: Case) -> Flight:
    """Give the exact flight, which is that of every cell."""
    preload = case.lane(STEPS).preload
    assert preload is not None, "the normal force swings"
    return Flight.of(preload)


def length(case: Case) -> float:
    """Give N0 / (m ω²) over U0: what the mean normal force makes of an inner mass."""
    chain, drive = case.setting
    force = float(chain.normal_force[0] / chain.inner_mass[0])
    return force / drive.angular_frequency**2 / drive.displacement_scale(chain)


def highest(case: Case) -> float:
    """Give the largest gap of the flight, over U0."""
    return flight(case).highest * length(case) / case.modulation_multiple**2


def edges(run: Run) -> float:
    """Give what is open of the time in the air: lift-off and landing are met to a step, in every cycle."""
    return 2 * run.of(Case).modulation_multiple / run.steps


def fall(run: Run) -> float:
    """Give what is open of a gap: how far the mean normal force moves an inner mass in a step, over U0."""
    return length(run.of(Case)) * (2 * math.pi / run.steps) ** 2


def furthest(values: tuple[float, ...], exact: float) -> float:
    """Give the value of the cell that is furthest off."""
    return max(values, key=lambda own: abs(own - exact), default=math.nan)


def in_the_air(case: Case) -> float:
    """Give the part of the period that a contact is open."""
    return flight(case).open_fraction


FLIGHTS = (
    Quantity(
        name="time in the air", unit="", exact=in_the_air, resolution=edges, of=lambda case: case.modulation > CLOSED,
        read=lambda result, run: furthest(result.open_fraction, in_the_air(run.of(Case))),
        meaning="Part of the period that a contact is open, of the cell that is furthest off.",
    ),
    Quantity(
        name="largest gap", unit="U0", exact=highest, resolution=fall, of=lambda case: case.modulation > CLOSED,
        read=lambda result, run: furthest(result.largest_gap, highest(run.of(Case))),
        meaning="Highest point of an inner mass's flight, of the cell that is furthest off.",
    ),
)  # fmt: skip

MODULATED_NORMAL_FORCE = Scenario(
    name="modulated-normal-force",
    question="Does friction follow a normal force that changes in time, until contacts open and land?",
    expects="the proven steady state, or the reference at finer steps; for flights the closed form; of presets that "
    "share the scheme, while contacts stay closed, the reference at equal steps",
    source="equation (7) with a given preload, Sethi, Banerjee and Manna; the flight in closed form",
    cases=CASES,
    quantities=(TRANSMITTANCE, *STICK_SLIP, *FLIGHTS),
    steps=lambda _config, case: {"": case.steps(STEPS)},
)
"""The paper's chain under a normal force that swings by a half, and by one and a half, of its mean."""

SCENARIOS = (MODULATED_NORMAL_FORCE,)
