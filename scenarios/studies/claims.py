"""The paper's claims about its figure 3, answered with numbers for the reference and for every engine.

A claim is decided by the bands of the paper's friction ratios: both edges as `refined_edges` gives them, and the stuck
fraction at the resonator's frequency. With friction the band has no upper edge up to η_r = 3. Its width is therefore
the share of a stated range that it covers, which is always finite.
"""

import itertools
import math
from collections.abc import Collection, Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from enum import StrEnum
from statistics import mean

from multibody_xval.engines.interface.presets import FrictionLaw
from multibody_xval.engines.interface.variant import Variant
from multibody_xval.scenarios.runs.result import Result, ResultStatus
from multibody_xval.scenarios.studies.figure3 import FRICTION_RATIOS, claim_frequency_ratios
from multibody_xval.scenarios.sweeps.attenuation_band import EDGE_RESOLUTION, BandDefinition, Crossing, Edge
from multibody_xval.scenarios.sweeps.compared import ComparedSweep
from multibody_xval.scenarios.sweeps.edges import refined_edges
from multibody_xval.scenarios.sweeps.point import GivesResults
from multibody_xval.scenarios.sweeps.refinement import Results, decided_db, for_the_band, refined
from multibody_xval.scenarios.sweeps.sweep import Case, GridPoint, Sweep
from multibody_xval.scenarios.tables import Column
from multibody_xval.scenarios.verdicts.steady_case import CONVERGED, REFERENCE

UP_TO = (0.1, 0.3, 0.6)
"""Friction ratios at which the paper's band is wider than without friction."""

BEYOND = (1.0, 5.0)
"""Friction ratios beyond these."""

WIDEST = 0.3
"""Friction ratio of the paper's widest band."""

RANGE = (0.3, 1.6)
"""Frequency ratios of which the band covers a share: those over which errors are stated too."""

RESONATOR = 1.0
"""Frequency ratio at which locking is read: there, an inner mass that is free moves most."""

LOCKED = 0.9
"""Stuck fraction from which a cell counts as one mass: the reference's is 0.52 at a friction ratio of 0.6, and 0.99 at
1."""

MOVED = 1e-3
"""Change of an edge in η_r that counts: twenty times what a step of 400 a period moves edges."""


@dataclass(frozen=True)
class Band:
    """What a claim needs of one curve."""

    lower: float
    """Lower edge [η_r]; -inf below the grid, inf without any deep attenuation."""
    upper: float
    """Upper edge [η_r]; inf where the grid has none."""
    last: float
    """Last η_r of the grid."""
    stuck: float = math.nan
    """Stuck fraction at `RESONATOR`, mean of the cells; NaN where it is not known."""

    @property
    def share(self) -> float:
        """Part of `RANGE` that the band covers, 0 to 1."""
        first, last = RANGE
        return max(min(self.upper, last) - max(self.lower, first), 0.0) / (last - first)


class Answer(StrEnum):
    """What the numbers say of a claim."""

    HOLDS = "holds"
    READING = "holds as read here"
    FAILS = "does not hold"
    OPEN = "not decided"


@dataclass(frozen=True)
class Claim:
    """One claim of the paper, answered."""

    name: str
    answer: Answer
    numbers: str
    """What decides it; of a claim that is open, what is missing."""
    concluded: str
    """What one would conclude, after "one would conclude that"; empty where it is open."""


Bands = Mapping[float, Band]
"""Bands by friction ratio; those that are not known are left out."""

STATED = {
    "a": "the band is wider than without friction for friction ratios up to 0.6",
    "b": "beyond, each cell behaves like one mass, and the first cut-off moves up",
    "c": "the band is widest at a friction ratio of 0.3",
}
"""What the paper claims, by the name of the claim."""

CLAIMS = tuple(STATED)


@dataclass(frozen=True)
class Conclusions:
    """The claims as one variant answers them."""

    variant: Variant
    bands: Bands
    claims: tuple[Claim, ...]
    """In the order of `CLAIMS`."""


def answers(bands: Bands) -> tuple[Claim, ...]:
    """Answer every claim, in the order of `CLAIMS`."""
    return _wider(bands), _locked(bands), _widest(bands)


def _wider(bands: Bands) -> Claim:
    needed = (0.0, *UP_TO)
    lacking = _lacking(bands, needed)
    if lacking:
        return Claim(CLAIMS[0], Answer.OPEN, lacking, "")
    free = bands[0.0]
    low = [f for f in UP_TO if bands[f].lower < free.lower - MOVED]
    wide = [f for f in UP_TO if bands[f].share > free.share + _share(MOVED)]
    numbers = f"lower edge {_listed(bands, needed)}; {_uppers(bands, needed)}; {_shares(bands, needed)}"
    return _by_both(
        CLAIMS[0], low == [*UP_TO], wide == [*UP_TO], numbers,
        "the band is wider than without friction up to a friction ratio of 0.6",
        f"the band is not wider than without friction at {_numbers(f for f in UP_TO if f not in wide)}",
    )  # fmt: skip


def _locked(bands: Bands) -> Claim:
    needed = (UP_TO[-1], *BEYOND)
    lacking = _lacking(bands, needed, stuck=BEYOND)
    if lacking:
        return Claim(CLAIMS[1], Answer.OPEN, lacking, "")
    edges = [bands[f].lower for f in needed]
    rises = all(after > before + MOVED for before, after in itertools.pairwise(edges))
    slides = [f for f in BEYOND if bands[f].stuck < LOCKED]
    stuck = ", ".join(f"{bands[f].stuck:.2f} at {f:g}" for f in BEYOND)
    numbers = f"stuck fraction at η_r = {RESONATOR:g}: {stuck}; lower edge {_listed(bands, needed)}"
    if rises and not slides:
        text = "beyond, each cell behaves like one mass while the first cut-off moves up"
        return Claim(CLAIMS[1], Answer.READING, numbers, text)
    wrong = [f"cells do not lock at {_numbers(slides)}"] if slides else []
    wrong += [] if rises else ["the first cut-off does not move up beyond 0.6"]
    return Claim(CLAIMS[1], Answer.FAILS, numbers, " and ".join(wrong))


def _widest(bands: Bands) -> Claim:
    lacking = _lacking(bands, FRICTION_RATIOS)
    if lacking:
        return Claim(CLAIMS[2], Answer.OPEN, lacking, "")
    others = [own for f, own in bands.items() if f in FRICTION_RATIOS and f != WIDEST]
    lowest = all(bands[WIDEST].lower < own.lower - MOVED for own in others)
    largest = all(bands[WIDEST].share > own.share + _share(MOVED) for own in others)
    numbers = f"lower edge {_listed(bands, FRICTION_RATIOS)}; {_shares(bands, FRICTION_RATIOS)}"
    best = max(FRICTION_RATIOS, key=lambda f: bands[f].share)
    where = f"widest at {best:g}" if best != WIDEST else f"no wider at {WIDEST:g} than elsewhere"
    return _by_both(CLAIMS[2], lowest, largest, numbers, "the band is widest at 0.3", f"the band is {where}")


def _by_both(name: str, by_edge: bool, by_share: bool, numbers: str, holds: str, fails: str) -> Claim:
    """Answer a claim that may be read by the lower edge or by the share."""
    if by_edge and by_share:
        return Claim(name, Answer.HOLDS, numbers, holds)
    if by_edge or by_share:
        reading = "by the lower edge alone" if by_edge else "by the covered share alone"
        return Claim(name, Answer.READING, f"{reading}: {numbers}", f"{holds} ({reading})")
    return Claim(name, Answer.FAILS, numbers, fails)


def _share(width: float) -> float:
    return width / (RANGE[1] - RANGE[0])


def _lacking(bands: Bands, needed: Sequence[float], stuck: Sequence[float] = ()) -> str:
    """Say which points are missing; empty where none is."""
    curves = [f for f in needed if f not in bands]
    points = [f for f in stuck if f in bands and math.isnan(bands[f].stuck)]
    parts = [f"the band at friction ratio {_numbers(curves)}"] if curves else []
    parts += [f"the steady state at η_r = {RESONATOR:g} at friction ratio {_numbers(points)}"] if points else []
    return f"missing: {'; '.join(parts)}" if parts else ""


def _numbers(values: Iterable[float]) -> str:
    return ", ".join(f"{value:g}" for value in values)


def edge_text(eta: float) -> str:
    """Give an edge as people read it."""
    if math.isinf(eta):
        return "none" if eta > 0 else "below the grid"
    return f"{eta:.4f}"


def _listed(bands: Bands, needed: Sequence[float]) -> str:
    return ", ".join(f"{edge_text(bands[f].lower)} at {f:g}" for f in needed)


def _uppers(bands: Bands, needed: Sequence[float]) -> str:
    """Give the upper edges, and up to where the other bands have none."""
    edges = [f"{edge_text(bands[f].upper)} at {f:g}" for f in needed if math.isfinite(bands[f].upper)]
    without = [f for f in needed if math.isinf(bands[f].upper)]
    if without:
        edges.append(f"none up to {min(bands[f].last for f in without):g} at {_numbers(without)}")
    return f"upper edge {', '.join(edges)}"


def _shares(bands: Bands, needed: Sequence[float]) -> str:
    shares = ", ".join(f"{bands[f].share:.0%} at {f:g}" for f in needed).replace("%", " %")
    return f"share of η_r {RANGE[0]:g} to {RANGE[1]:g}: {shares}"


EdgeRatios = Mapping[tuple[Variant, Case, Edge], float | None]


def conclusions(
    variants: Sequence[Variant], results: Results, edges: EdgeRatios, definition: BandDefinition
) -> list[Conclusions]:
    """Answer the claims by what is known of a sweep over friction and frequency ratio.

    `results` are those of its grid, `edges` the refined ones [η_r]: none where the grid has none, NaN where it is not
    known.
    """
    curves: dict[tuple[Variant, Case], dict[float, Result]] = {}
    for (variant, case, eta), result in results.items():
        curves.setdefault((variant, case), {})[eta] = result
    found: dict[Variant, dict[float, Band]] = {variant: {} for variant in variants}
    for (variant, case), curve in curves.items():
        lower, upper = (edges.get((variant, case, edge)) for edge in Edge)
        band = _band(curve, lower, upper, definition)
        if variant in found and band is not None:
            found[variant][case.friction_ratio] = band
    return [Conclusions(variant, bands, answers(bands)) for variant, bands in found.items()]


def _band(
    curve: Mapping[float, Result], lower: float | None, upper: float | None, definition: BandDefinition
) -> Band | None:
    """Give the band of a curve; ``None`` where points that it needs are missing."""
    unknown = any(result.status in (ResultStatus.MISSING, ResultStatus.BLOCKED) for result in curve.values())
    ends = min(curve) > RANGE[0] or max(curve) < RANGE[1]
    if unknown or ends or any(eta is not None and math.isnan(eta) for eta in (lower, upper)):
        return None
    levels = [decided_db(result) for result in curve.values()]
    deep = any(level < definition.depth_db for level in levels)
    if not deep and any(map(math.isnan, levels)):
        return None
    at = next((result for eta, result in curve.items() if math.isclose(eta, RESONATOR)), None)
    stuck = mean(at.stuck_fraction) if at is not None and at.converged and at.stuck_fraction else math.nan
    if not deep:
        return Band(math.inf, math.inf, max(curve), stuck)
    return Band(-math.inf if lower is None else lower, math.inf if upper is None else upper, max(curve), stuck)


def compared_conclusions(result: ComparedSweep) -> list[Conclusions]:
    """Answer the claims by a compared sweep, for the reference and then every variant."""
    variants = [variant for variant in result.sweep.variants if variant != CONVERGED]
    results = {point.place: point.result for point in result.points}
    edges = {(own.variant, own.case, own.edge): own.frequency_ratio for own in result.edges}
    return conclusions(variants, results, edges, result.sweep.band)


def claims_sweep(sweep: Sweep, variants: Sequence[Variant]) -> Sweep:
    """Give the sweep that answers the claims, of some 200 steady states a variant, the reference's among them.

    Chain, drive, steps and band are those of `sweep`.
    """
    axes = {"friction_ratio": FRICTION_RATIOS, "frequency_ratio": claim_frequency_ratios(sweep.ratios)}
    asked = dict.fromkeys((REFERENCE, *(variant for variant in variants if variant != CONVERGED)))
    return replace(sweep, variants=tuple(asked), axes=axes, frequencies=None, tolerance=None)


def leading_laws(sweep: Sweep, variants: Sequence[Variant]) -> dict[Variant, Variant]:
    """Give the laws that lead: of variants whose curves the sweep does not hold; of no bristle: some never settle.

    The reference leads those that share its scheme.
    """
    planned = claims_sweep(sweep, ())
    held = all(set(values) <= set(sweep.axes[name]) for name, values in planned.axes.items())
    known = {REFERENCE, *(sweep.variants if held else ())}
    return {
        variant: law
        for variant in variants
        if (law := REFERENCE if variant.preset.shares_scheme else variant.law) is not None
        and variant not in known
        and variant.capabilities.friction_law is not FrictionLaw.BRISTLE
    }


def led_claims_sweep(sweep: Sweep, variants: Sequence[Variant]) -> Sweep:
    """Give `claims_sweep` with laws in the place of the variants that they lead."""
    laws = leading_laws(sweep, variants)
    return claims_sweep(sweep, [laws.get(variant, variant) for variant in variants])


def evaluated_conclusions(sweep: Sweep, variants: Sequence[Variant], evaluator: GivesResults) -> list[Conclusions]:
    """Evaluate what the claims need, see `claims_sweep`, for the reference and then the variants.

    Variants that are led by their laws are evaluated themselves at `RESONATOR` and on both sides of every edge only;
    where one does not cross the threshold between them, on the whole grid.
    """
    asked, laws = claims_sweep(sweep, variants).variants, leading_laws(sweep, variants)
    results, edges = _curves(led_claims_sweep(sweep, asked), evaluator)
    led = _confirmed(sweep, laws, edges, evaluator)
    for variant, at_resonator in led.items():
        results |= {(variant, *place[1:]): own for place, own in results.items() if place[0] == laws[variant]}
        results |= at_resonator
        edges |= {(variant, *key[1:]): own for key, own in edges.items() if key[0] == laws[variant]}
    rest = [variant for variant in laws if variant not in led]
    if rest:
        more = _curves(claims_sweep(sweep, rest), evaluator)
        results, edges = results | more[0], edges | more[1]
    ratios = {key: crossing.frequency_ratio for key, crossing in edges.items()}
    return conclusions(asked, results, ratios, sweep.band)


Crossings = dict[tuple[Variant, Case, Edge], Crossing]


def _curves(planned: Sweep, evaluator: GivesResults) -> tuple[dict[GridPoint, Result], Crossings]:
    """Evaluate the curves of a sweep and their edges; the lower one of a curve that lacks a result is NaN."""
    results = refined(planned, list(planned.grid_points()), for_the_band(planned), evaluator)
    found = refined_edges(planned, results, evaluator)
    return results, {**found.crossings, **{(*key, Edge.LOWER): Crossing(math.nan) for key in found.incomplete}}


def _confirmed(
    sweep: Sweep, laws: Mapping[Variant, Variant], edges: Crossings, evaluator: GivesResults
) -> dict[Variant, dict[GridPoint, Result]]:
    """Give the results at `RESONATOR` of the variants that cross the threshold where their laws do, at every case."""
    cases = claims_sweep(sweep, ()).cases
    sides = {variant: own for variant, law in laws.items() if (own := _sides(variant, law, edges, cases))}
    at_resonator = {variant: [(variant, case, RESONATOR) for case in cases] for variant in sides}
    points = [point for variant, own in sides.items() for point in (*own, *at_resonator[variant])]
    known = dict(zip(points, evaluator.evaluate([sweep.task(*point) for point in points]), strict=True))
    return {
        variant: {point: known[point] for point in at_resonator[variant]}
        for variant, own in sides.items()
        if all((decided_db(known[point]) - sweep.band.threshold_db) * sign > 0 for point, sign in own.items())
    }


def _sides(variant: Variant, law: Variant, edges: Crossings, cases: Collection[Case]) -> dict[GridPoint, float]:
    """Give points on both sides of every edge of a variant's law, and a number with the sign of the level there [dB].

    None where its law lacks a lower edge, or an edge is not known.
    """
    own = {key[1:]: crossing for key, crossing in edges.items() if key[0] == law}
    if any((case, Edge.LOWER) not in own for case in cases) or any(math.isnan(edge.slope) for edge in own.values()):
        return {}
    return {
        (variant, case, crossing.frequency_ratio + side * EDGE_RESOLUTION): side * crossing.slope
        for (case, _), crossing in own.items()
        for side in (-1, 1)
    }


PRESETS = {"default": "as installed", "recommended": "as recommended", "tuned": "tuned"}
"""Presets in words."""


def called(variant: Variant) -> str:
    """Name a variant in a sentence."""
    name, *settings = variant.preset_name.split(":")
    if variant.engine == REFERENCE.engine:
        return "the reference"
    title = replace(variant, preset_name=":".join(["tuned", *settings])).title
    return f"{title} {PRESETS.get(name, name)}"


def sentence(own: Conclusions, reference: Conclusions) -> str:
    """Say what one would conclude with a variant, and how far that is from what the reference says."""
    start = f"With {called(own.variant)} one would conclude"
    pairs = list(zip(own.claims, reference.claims, strict=True))
    decided = [pair for pair in pairs if Answer.OPEN not in {claim.answer for claim in pair}]
    if not decided:
        return f"With {called(own.variant)} nothing can be concluded: {own.claims[0].numbers or 'points are missing'}."
    if own.variant == reference.variant:
        text = f"{start} that {_joined([mine.concluded for mine, _ in decided])}"
    elif other := [mine.concluded for mine, right in decided if mine.answer != right.answer]:
        text = f"{start}, otherwise than with the reference, that {_joined(other)}{_farthest(own, reference)}"
    else:
        text = f"{start} the same as with the reference{_farthest(own, reference)}"
    still_open = [
        f"Claim {mine.name} is not decided; {mine.numbers}" for mine, _ in pairs if mine.answer is Answer.OPEN
    ]
    return ". ".join([text, *still_open]) + "."


def _joined(parts: Sequence[str]) -> str:
    *first, last = parts
    return f"{', that '.join(first)}, and that {last}" if first else last


def _edge_errors(own: Conclusions, reference: Conclusions) -> dict[float, float]:
    """Give by friction ratio how far each lower edge is above the reference's [η_r], where both have one."""
    common = [f for f in own.bands if f in reference.bands]
    return {f: own.bands[f].lower - reference.bands[f].lower for f in common if math.isfinite(own.bands[f].lower)}


def farthest_edge(own: Conclusions, reference: Conclusions) -> float:
    """Give how far a lower edge is off at most [η_r]; 0 where none is known."""
    return max(map(abs, _edge_errors(own, reference).values()), default=0.0)


def _farthest(own: Conclusions, reference: Conclusions) -> str:
    """Say how far the lower edge is off at most; nothing where it is by less than `MOVED`."""
    if not farthest_edge(own, reference) >= MOVED:
        return ""
    off = _edge_errors(own, reference)
    worst = max(off, key=lambda f: abs(off[f]))
    size = f"{own.bands[worst].lower:.4f} instead of {edge_text(reference.bands[worst].lower)}"
    return f"; its lower edge is off by up to {abs(off[worst]):.2g} (friction ratio {worst:g}: {size})"


def _edge(friction: float) -> Column[Conclusions]:
    def value(row: Conclusions) -> str | None:
        return edge_text(row.bands[friction].lower) if friction in row.bands else None

    return Column(f"lower edge at {friction:g}", value, f"{friction:g}")


def _answer(number: int) -> Column[Conclusions]:
    return Column(CLAIMS[number], lambda row: str(row.claims[number].answer))


CLAIM_COLUMNS: tuple[Column[Conclusions], ...] = (
    Column("variant", lambda row: str(row.variant)),
    *(_answer(number) for number in range(len(CLAIMS))),
    *(_edge(friction) for friction in FRICTION_RATIOS),
)
"""A row a variant: the answers, and its lower edges by friction ratio."""
