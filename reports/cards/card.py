"""The numbers of a card: one engine, default beside tuned, each against the truth."""

import math
from dataclasses import dataclass

from engines.interface.law import NotModelled
from engines.interface.registry import engine
from engines.interface.variant import Variant, check_installed
from reports.formatting import printed_option
from reports.reproducers.questions import QUESTIONS, Number
from reports.reproducers.script import Reproduction, checked, has_reproducer, script
from scenarios.catalogue.registry import CATALOGUE
from scenarios.catalogue.steady.figure3 import lower_edges
from scenarios.runs.evaluator import Evaluator
from scenarios.runs.result import ResultStatus
from scenarios.studies.accuracy import SIX_POINTS, accuracies
from scenarios.studies.work_precision import StepPoint, step_study
from scenarios.sweeps.edges import BandEdge
from scenarios.verdicts.steady_case import CONVERGED

PRESETS = ("default", "tuned")
"""What a card shows of each formulation: as the engine comes, and the best options that are known."""

GOAL_DB = 0.1
"""Error to the truth that costs are compared at [dB]."""

EDGE_FRICTION = 0.3
"""Friction ratio of the band edge: where the band is widest."""

DIRECTION = "direction"
"""Scenario of the bound against direction; a catalogue without it leaves the line out."""

SCALE = "1 kg"
"""The mass of which a card speaks."""

READINGS = (
    ("creep", "static-hold", "1 kg, load 0.5"),
    ("creep", "static-hold", "1 kg, load 0.99"),
    ("breakaway", "breakaway", "1 kg, 2 ms"),
    ("stopping distance", "stopping-distance", "1 kg, 4.9 m/s"),
)
"""Numbers of one block: name, scenario, case."""


@dataclass(frozen=True)
class Row:
    """One line of a card."""

    name: str
    unit: str
    value: float
    exact: float
    """The variant's, NaN where there is none, and the truth."""
    case: str
    reason: str = ""
    command: str = ""
    """Command that prints a script for the number; empty where there is none."""
    where: str = ""

    @property
    def error(self) -> float:
        """Value less truth."""
        return self.value - self.exact


@dataclass(frozen=True)
class VariantCard:
    """One formulation with one preset."""

    variant: Variant
    description: str
    largest_db: float
    median_db: float
    certified: int
    points: int
    """Errors of transmittance to the exact motion over the map of `studies.accuracy`, and at how many of its points
    there is a certified steady state; all of the points and steps that were run.
    """
    rows: tuple[Row, ...]
    """Band edge, creep, breakaway, stopping distance, direction."""
    steps: tuple[StepPoint, ...]
    options: tuple[dict[str, str], ...]
    """Those that the preset sets otherwise than the engine does: name, value, default, reach and reason."""
    law: str
    """Formula of its law, or why it has none."""
    script: str
    """The reproducer of its creep; empty where its engine has no template, or no such number."""

    @property
    def steps_to_goal(self) -> int | None:
        """Fewest steps a period with which every point errs by `GOAL_DB` at most, of those tried; ``None`` without."""
        good = (
            point.steps_per_period
            for point in self.steps
            if point.error_db <= GOAL_DB and point.certified == len(SIX_POINTS)
        )
        return next(good, None)

    @property
    def most_steps(self) -> int:
        """Most steps a period that were tried."""
        return max(point.steps_per_period for point in self.steps)

    @property
    def step_seconds(self) -> float:
        """Wall-clock time of a step of the chain [s], at the finest steps that were timed."""
        timed = [point.step_seconds for point in self.steps if not math.isnan(point.step_seconds)]
        return timed[-1] if timed else math.nan


@dataclass(frozen=True)
class Card:
    """What a maintainer would quote of one engine."""

    name: str
    title: str
    package: str
    version: str
    licence: str
    notes: str
    variants: tuple[VariantCard, ...]
    """Default beside tuned, by formulation."""


def card_variants(name: str) -> list[Variant]:
    """Give the variants of a card, before any work."""
    capabilities = engine(name).capabilities
    check_installed(name, engine(name).unavailable_reason())
    pairs = [
        (form, preset) for form, presets in capabilities.presets.items() for preset in PRESETS if preset in presets
    ]
    return [Variant(name, str(formulation), preset) for formulation, preset in pairs]


def card(name: str, evaluator: Evaluator) -> Card:
    """Collect the card of an engine; what the store lacks is computed."""
    variants = card_variants(name)
    exactness = accuracies(variants, evaluator)
    steps = step_study(variants, evaluator)
    edges = {
        edge.variant: edge for edge in lower_edges(variants, evaluator) if edge.case.friction_ratio == EDGE_FRICTION
    }
    adapter = engine(name)
    return Card(
        name=name,
        title=adapter.capabilities.title,
        package=adapter.capabilities.package,
        version=adapter.version(),
        licence=adapter.capabilities.licence,
        notes=adapter.capabilities.notes,
        variants=tuple(
            VariantCard(
                variant=variant,
                description=variant.description,
                largest_db=own.map_db,
                median_db=own.map_median_db,
                certified=own.certified,
                points=own.points,
                rows=(
                    _edge_row(edges[variant], edges[CONVERGED]),
                    *_block_rows(variant, evaluator),
                    *_direction_rows(variant, evaluator),
                ),
                steps=tuple(point for point in steps if point.variant == variant),
                options=_options(variant),
                law=_law(variant),
                script=_script(variant, evaluator),
            )
            for variant, own in zip(variants, exactness, strict=True)
        ),
    )


def _edge_row(edge: BandEdge, truth: BandEdge) -> Row:
    own, exact = edge.finding, truth.finding
    reason = "" if math.isfinite(own.value) else own.comparison.reason
    case = f"{edge.case}, to the converged reference"
    return Row("lower band edge", "η_r", own.value, exact.value, case, reason)


def _block_rows(variant: Variant, evaluator: Evaluator) -> list[Row]:
    rows = []
    for name, scenario, case in READINGS:
        question = QUESTIONS[scenario]
        number: Number = question.number(variant, case, evaluator)
        command = Reproduction(variant, question, case).command if has_reproducer(variant) else ""
        rows.append(Row(name, question.metric.unit, number.value, number.exact, case, number.reason, command))
    return rows


def _direction_rows(variant: Variant, evaluator: Evaluator) -> list[Row]:
    """Give the number that is farthest from what is expected in any direction, if the catalogue asks that."""
    if DIRECTION not in CATALOGUE or variant.formulation != "contact":
        return []
    findings = CATALOGUE[DIRECTION].run([variant], evaluator)
    known = [own for own in findings if SCALE in own.case and math.isfinite(own.comparison.difference)]
    if not known:
        return []
    worst = max(known, key=lambda finding: abs(finding.comparison.difference))
    where = worst.case.removeprefix(f"{SCALE}, ")
    return [Row("worst direction", worst.metric.unit, worst.value, worst.expected, SCALE, where=where)]


def _script(variant: Variant, evaluator: Evaluator) -> str:
    if not has_reproducer(variant):
        return ""
    shown = checked(str(variant), "static-hold")
    (result,) = evaluator.evaluate([shown.question.task(variant, shown.case)])
    return "" if result.status is ResultStatus.BLOCKED else script(shown, evaluator)


def _options(variant: Variant) -> tuple[dict[str, str], ...]:
    changed = {name: own for name, own in variant.preset.engine_options.items() if own.value != own.default}
    return tuple(
        {
            "name": name,
            "value": printed_option(own.value),
            "default": printed_option(own.default),
            "reach": variant.reach(name),
            "reason": own.reason,
        }
        for name, own in changed.items()
    )


def _law(variant: Variant) -> str:
    stated = variant.preset.stated_law()
    if stated is None:
        return "the reference's own step"
    return f"not modelled: {stated.reason}" if isinstance(stated, NotModelled) else stated.formula
