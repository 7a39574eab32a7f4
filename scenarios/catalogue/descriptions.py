"""What every scenario asks, and what its results are compared with; commands list them before anything is loaded."""

from collections.abc import Mapping
from types import MappingProxyType
from typing import NamedTuple

ALL_SCENARIOS = "all"
"""Name of all scenarios together."""

REFERENCE_REFINEMENT = 16
"""The reference takes so many times as many steps as the engines, and has a sixteenth of its error there."""

TRANSIENT_EXPECTS = (
    f"the reference with {REFERENCE_REFINEMENT} times as many steps; allowed: its error from three step sizes, and "
    "the engine's own from three, or the reference's at the same ones if that is larger; a variant that disagrees "
    "by little, and has no law for it, is simulated again with twice as many steps"
)

NO_MOTION = "Coulomb's law: below the bound of friction nothing moves"

EULER = "what a step of semi-implicit Euler moves a body"


class Description(NamedTuple):
    """A scenario in two sentences."""

    question: str
    """The physical question, in one sentence."""
    expects: str
    """What results are compared with: closed form, event-driven solution, reference with its error bar."""


DESCRIPTIONS: Mapping[str, Description] = MappingProxyType(
    {
        "unit-cell": Description(
            "When does the contact of one cell stick and slip?",
            "the event-driven solver, exact to round-off",
        ),
        "figure3": Description(
            "How much of the base's motion reaches the end of seven cells, and where does attenuation begin?",
            "the event-driven solver, exact to round-off",
        ),
        "den-hartog": Description(
            "How does a mass slide with dry friction under a harmonic force, and when does it turn back?",
            "the closed form; its error bar is the motion of the heavy outer mass",
        ),
        "frictionless-limit": Description(
            "Without friction, does the chain move as linear theory says?",
            "closed form",
        ),
        "locked-limit": Description(
            "Does a contact with a very high friction bound hold?",
            "closed form",
        ),
        "free-decay": Description(
            "When and where does a stretched chain come to rest, and how does it lose its energy?",
            "the event-driven motion, exact to round-off; energy balance and growth: zero; loss a cycle: 4 F / k; "
            "allowed: "
            "the engine's error from three step sizes, or the reference's from the same ones if that is larger",
        ),
        "static-hold": Description(
            "Does a contact hold a load below its bound, or does it creep?",
            "no slip; allowed: round-off, and the creep that the options of the preset state",
        ),
        "ratchet": Description(
            "Does a contact hold a load that swings below its bound, or does it creep with every swing?",
            "no slip; allowed: round-off, and the creep that the options of the preset state",
        ),
        "breakaway": Description(
            "Under a load that grows slowly, at which part of its bound does a contact begin to slip?",
            f"the reference with {REFERENCE_REFINEMENT} times as many steps; allowed: two steps",
        ),
        "stopping-distance": Description(
            "Where and when does a sliding block come to rest, and does it stay there?",
            "the event-driven motion, exact to round-off: v² / (2 μ λ_N / m); no drift; allowed: the engine's error "
            "from three step sizes, or the reference's from the same ones if that is larger",
        ),
        "static-above-kinetic": Description(
            "Does a contact hold more at rest than in motion, and how far does the block jump when it slips?",
            "the event-driven motion, exact to round-off: μ_s λ_N, then 2 (μ_s − μ_k) λ_N / k and what the load grows; "
            "allowed: two steps of a breakaway; the engine's error of a jump from three step sizes, or the reference's "
            "from the same ones if that is larger",
        ),
        "direction": Description(
            "Does the bound of friction depend on the direction in which a block slides over its contact?",
            "the event-driven motion, exact to round-off, the same in all directions; allowed: the engine's error from "
            "three step sizes, round-off, and the creep that the options of the preset state",
        ),
        "published": Description(
            "Do turning points, wear and stopping times agree with published numbers?",
            "the published number, to its printed digits; allowed: the engine's error from three step sizes, or the "
            "reference's from the same ones if that is larger",
        ),
        "ricker-pulse": Description(
            "How much of a Ricker pulse of the base, with its peak at ω_r, arrives at the end of the chain?",
            TRANSIENT_EXPECTS,
        ),
        "swept-sine": Description(
            "How much of a logarithmic sine sweep of the base, from 0.2 to 2.4 ω_r, arrives at the end of the chain?",
            TRANSIENT_EXPECTS,
        ),
        "filtered-noise": Description(
            "How much of noise of the base, flat from 0.2 to 2.4 ω_r, arrives at the end of the chain?",
            TRANSIENT_EXPECTS,
        ),
        "record": Description(
            "How much of a recorded motion of the base (CSV) arrives at the end of the chain?",
            TRANSIENT_EXPECTS,
        ),
        "disordered-chain": Description(
            "With other parameters in each cell, when does each contact stick and slip?",
            "the event-driven solver, exact to round-off",
        ),
        "graded-chain": Description(
            "Where along a graded chain do the contacts stick?",
            "the event-driven solver, exact to round-off",
        ),
        "long-chain": Description(
            "Is an engine as accurate with fifty cells as with seven?",
            "the reference with 32 times the steps, and its error bar",
        ),
        "modulated-normal-force": Description(
            "Does friction follow a normal force that changes in time, until contacts open and land?",
            "the reference at the same step with its error bar; for flights the closed form",
        ),
        "wide-range": Description(
            "Is an engine right for other friction coefficients, dashpots, frequencies and steps than figure 3 has?",
            "the event-driven solver, exact to round-off",
        ),
        "long-run": Description(
            "Does a chain move after 60,000 steps, and 200 runs, as it did before?",
            "the event-driven motion, exact to round-off; at equal steps the reference; allowed: the engine's error "
            "from three step sizes, or the reference's from the same ones if that is larger",
        ),
        "slope-hold": Description(
            "Does a box stay where it is on a slope below the critical one, as the engine's users build it?", NO_MOTION
        ),
        "slope-slide": Description(
            "How much friction does a box meet that slides down a slope?", "closed form: a = g (sin θ − μ cos θ)"
        ),
        "slide-to-stop": Description(
            "How far does a box slide on the flat, straight and without hopping, and does it stay where it stops?",
            f"closed form: v²/(2 μ g); allowed: {EULER}",
        ),
        "stack-hold": Description("Does a stack of boxes stay where it is on a slope?", NO_MOTION),
        "heavy-on-light": Description("Does a heavy box stay where it is on a light one, on a slope?", NO_MOTION),
        "grip": Description("Do two fingers hold a box that they press?", NO_MOTION),
        "held-while-shaken": Description(
            "Does a box stay where it is while its load swings below the bound?", NO_MOTION
        ),
        "conveyor": Description(
            "When does a box that is put on a belt move with it?", f"closed form: v/(μ g); allowed: {EULER}"
        ),
        "joint-hold": Description("Does a joint with dry friction stay where it is under a load?", NO_MOTION),
        "spin": Description(
            "Does a box that is spun on the flat stop on its place, by a torque that friction can have?",
            f"limits: from that of a uniform pressure to μ m g s/√2, that of the corners; allowed: {EULER}",
        ),
        "arm-hold": Description("Does an arm whose hinges rub stay stretched out under gravity?", NO_MOTION),
    }
)
"""Descriptions by the names of the scenarios, in the order in which they are listed and run."""
