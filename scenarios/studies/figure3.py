"""Figure 3 of the paper: transmittance of the 7-cell chain for several friction ratios, by every engine.

Every variant answers the same grid of friction and frequency ratios; the attenuation band is then
found in its own curve, and the edges are refined by its own simulations.
"""

import math
from collections import defaultdict
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property

import numpy as np
import scipy.linalg
from numpy.typing import NDArray

from engines.interface.registry import engine
from engines.interface.variant import Variant
from reference_lcp.chain.linear_response import stuck_basis
from reference_lcp.chain.mass_in_mass import Chain
from reference_lcp.chain.simulation import FEWEST_STEPS_PER_PERIOD, MINIMUM_STEPS_PER_PERIOD
from reference_lcp.validation import FloatArray, ParameterError, checked_array, checked_count
from scenarios.execution.evaluator import Evaluator
from scenarios.studies.attenuation_band import (
    BandDefinition,
    Edge,
    edge_brackets,
    refined_crossings,
    unresolved,
)
from scenarios.tasks.parameters import ChainRatios, Excitation
from scenarios.tasks.result import Result, ResultStatus
from scenarios.tasks.task import SteadyStateTask
from scenarios.verdicts.band_edge import compare_edge
from scenarios.verdicts.pointwise import CONVERGED, GivenTolerance, PointResults, compare_point, refinements
from scenarios.verdicts.steady_case import REFERENCE, amplification, amplitude_in_db
from scenarios.verdicts.verdict import Comparison, Verdict

__all__ = [
    "CONVERGED",
    "DENSE_FREQUENCY_RATIOS",
    "EDGE_RESIDUAL",
    "FRICTION_RATIOS",
    "QUICK_FRICTION_RATIOS",
    "REFERENCE",
    "BandEdge",
    "Figure3",
    "Figure3Result",
    "Point",
    "default_frequency_ratios",
    "quick_frequency_ratios",
    "resonances",
    "run",
]

FRICTION_RATIOS = (0.0, 0.1, 0.3, 0.6, 1.0, 5.0)
QUICK_FRICTION_RATIOS = (0.0, 0.3, 1.0)

DENSE_FREQUENCY_RATIOS = tuple(float(eta) for eta in np.round(np.arange(0.1, 3.005, 0.01), 2))
"""Where the reference's curves are drawn as lines."""

EDGE_RESIDUAL = 1e-3
"""Periodicity residual up to which a motion decides on which side of an edge its frequency is.

An engine whose period map jumps (a bristle that sticks at the end of a step only) may come no closer
than some 1e-4 of the base's motion. At the edge the response is as large as that motion, and curves
fall by more than 10 dB in 0.1: what such a residual leaves open is below the resolution of the edge.
"""


def resonances(ratios: ChainRatios) -> FloatArray:
    """Natural frequencies over ω_r of the chain with free and with stuck contacts, ascending.

    Between them, the transmittance of every friction ratio is smooth; narrow peaks are at them.
    """
    chain = ratios.chain(0.0)
    stuck = _natural_frequencies(chain, stuck_basis(chain))
    return np.sort(np.concatenate([_free_natural_frequencies(chain), stuck]))


def _free_natural_frequencies(chain: Chain) -> FloatArray:
    return _natural_frequencies(chain, np.eye(2 * chain.cells))


def _natural_frequencies(chain: Chain, basis: FloatArray) -> FloatArray:
    """Natural frequencies over ω_r in the subspace of `basis`, ascending."""
    stiffness, mass = (basis.T @ matrix @ basis for matrix in (chain.stiffness_matrix, chain.mass_matrix))
    return np.sqrt(scipy.linalg.eigh(stiffness, mass, eigvals_only=True)) / chain.resonator_frequency


def default_frequency_ratios(ratios: ChainRatios) -> tuple[float, ...]:
    """0.1 to 3: every twentieth where bands begin and end, every tenth elsewhere, and all resonances."""
    uniform = np.concatenate([np.arange(0.1, 0.5, 0.1), np.arange(0.5, 1.6, 0.05), np.arange(1.6, 3.05, 0.1)])
    return _grid(uniform, resonances(ratios))


def quick_frequency_ratios(ratios: ChainRatios) -> tuple[float, ...]:
    """A few points around the band, and the resonances next to the frictionless one.

    They are the two highest of the lower branch, in which both masses of a cell move alike (the
    last one may be too weak to reach the threshold), and the lowest of the upper branch.
    """
    chain = ratios.chain(0.0)
    branches = _free_natural_frequencies(chain)
    uniform = np.array([0.3, 0.62, 0.7, 0.8, 0.9, 1.0, 1.1, 1.3, 1.6])
    return _grid(uniform, branches[max(chain.cells - 2, 0) : chain.cells + 1])


def _grid(uniform: FloatArray, peaks: FloatArray) -> tuple[float, ...]:
    inside = peaks[(peaks > uniform.min()) & (peaks < uniform.max())]
    return tuple(float(eta) for eta in np.unique(np.round(np.concatenate([uniform, inside]), 4)))


@dataclass(frozen=True, kw_only=True)
class Figure3:
    """What is asked.

    Parameters
    ----------
    variants
        Whom to compare with the reference; the reference and its converged preset always take part.
    friction_ratios, frequency_ratios
        The grid, ascending.
    ratios
        The chain but for its friction.
    steps_per_period
        Fewest steps a period.
    excitation
        What drives the chain.
    tolerance
        By which engines are judged, where it is given; without it, it is derived at every point.
    band
        Definition of the attenuation band.

    Raises
    ------
    ParameterError
        If a grid is empty, not ascending or outside its range, or an engine is unknown.
    """

    variants: tuple[Variant, ...]
    friction_ratios: tuple[float, ...] = FRICTION_RATIOS
    frequency_ratios: tuple[float, ...] = field(default_factory=lambda: default_frequency_ratios(ChainRatios()))
    ratios: ChainRatios = field(default_factory=ChainRatios)
    steps_per_period: int = MINIMUM_STEPS_PER_PERIOD
    excitation: Excitation = field(default_factory=Excitation)
    tolerance: GivenTolerance | None = None
    band: BandDefinition = field(default_factory=BandDefinition)

    def __post_init__(self) -> None:
        _check_grid("friction_ratios", self.friction_ratios, ">= 0")
        _check_grid("frequency_ratios", self.frequency_ratios, "> 0")
        checked_count("steps_per_period", self.steps_per_period, FEWEST_STEPS_PER_PERIOD)
        for variant in self.variants:
            engine(variant.engine).preset(variant.formulation, variant.preset_name)

    @property
    def all_variants(self) -> tuple[Variant, ...]:
        """The converged reference, the reference, then the others, each once."""
        return tuple(dict.fromkeys((CONVERGED, REFERENCE, *self.variants)))

    @property
    def grid(self) -> list[SteadyStateTask]:
        """Every variant at every point of the grid, and with other steps where its own error is needed."""
        return [
            self.question(variant, friction, eta, refinement)
            for variant in self.all_variants
            for refinement in (1.0, *refinements(variant, self.tolerance))
            for friction in self.friction_ratios
            for eta in self.frequency_ratios
        ]

    def question(
        self, variant: Variant, friction_ratio: float, frequency_ratio: float, refinement: float = 1.0
    ) -> SteadyStateTask:
        """Ask one variant about one point, with `refinement` times the steps a period."""
        return SteadyStateTask(
            variant=variant,
            friction_ratio=friction_ratio,
            frequency_ratio=frequency_ratio,
            ratios=self.ratios,
            steps_per_period=max(int(self.steps_per_period * refinement), 3),
            excitation=self.excitation,
        )


@dataclass(frozen=True)
class Point:
    """One point of the grid, by one variant, with what it was compared with."""

    variant: Variant
    friction_ratio: float
    frequency_ratio: float
    answer: Result
    comparison: Comparison


@dataclass(frozen=True)
class BandEdge:
    """One edge of the band of one variant; `frequency_ratio` is ``None`` where the grid does not hold it."""

    variant: Variant
    friction_ratio: float
    edge: Edge
    frequency_ratio: float | None
    comparison: Comparison


@dataclass(frozen=True)
class Figure3Result:
    """What came of it.

    Parameters
    ----------
    asked
        The question.
    points
        Every point of every variant, by variant, friction and frequency. The grid of each friction
        ratio is the one asked for, resolved where the converged reference runs close to the threshold.
    edges
        Both edges of every curve.
    dense_reference
        For each friction ratio, η_r (`DENSE_FREQUENCY_RATIOS`) and transmittance [dB] of the reference
        at the common time step, to be drawn as a line.
    """

    asked: Figure3
    points: tuple[Point, ...]
    edges: tuple[BandEdge, ...]
    dense_reference: Mapping[float, tuple[FloatArray, FloatArray]]

    def curve(self, variant: Variant, friction_ratio: float) -> list[Point]:
        """Points of one curve."""
        return self._curves.get((variant, friction_ratio), [])

    def points_of(self, variant: Variant) -> list[Point]:
        """Points of one variant, by friction and frequency."""
        return [point for friction in self.asked.friction_ratios for point in self.curve(variant, friction)]

    def edge(self, variant: Variant, friction_ratio: float, edge: Edge) -> BandEdge:
        """One edge."""
        return self._edges[variant, friction_ratio, edge]

    @cached_property
    def _curves(self) -> dict[tuple[Variant, float], list[Point]]:
        found: dict[tuple[Variant, float], list[Point]] = {}
        for point in self.points:
            found.setdefault((point.variant, point.friction_ratio), []).append(point)
        return found

    @cached_property
    def _edges(self) -> dict[tuple[Variant, float, Edge], BandEdge]:
        return {(one.variant, one.friction_ratio, one.edge): one for one in self.edges}


def run(asked: Figure3, evaluator: Evaluator) -> Figure3Result:
    """Answer every point of the grid, then refine the edges of every curve."""
    grids = {friction: _resolved_grid(asked, friction, evaluator) for friction in asked.friction_ratios}
    places = [
        (variant, friction, eta) for variant in asked.all_variants for friction in grids for eta in grids[friction]
    ]
    refined = [(place, refinement) for place in places for refinement in refinements(place[0], asked.tolerance)]
    found = evaluator.evaluate(
        [*(asked.question(*place) for place in places), *(asked.question(*place, times) for place, times in refined)]
    )
    answers = dict(zip(places, found, strict=False))
    others: dict[_OperatingPoint, list[Result]] = defaultdict(list)
    for (place, _), answer in zip(refined, found[len(places) :], strict=True):
        others[place].append(answer)
    points = tuple(Point(*place, answer, _compare(asked, place, answers, others)) for place, answer in answers.items())
    edges = tuple(_edges(asked, grids, answers, others, evaluator))
    return Figure3Result(asked, points, edges, _dense_reference(asked, evaluator))


def _resolved_grid(asked: Figure3, friction: float, evaluator: Evaluator) -> tuple[float, ...]:
    """Add points until the converged reference shows no place where a crossing could hide."""
    grid = np.array(asked.frequency_ratios)
    while True:
        answers = evaluator.evaluate([asked.question(CONVERGED, friction, eta) for eta in grid.tolist()])
        missing = unresolved(grid, np.array([_decided(answer) for answer in answers]), asked.band)
        if missing.size == 0:
            return tuple(grid.tolist())
        grid = np.union1d(grid, missing)


def _dense_reference(asked: Figure3, evaluator: Evaluator) -> dict[float, tuple[FloatArray, FloatArray]]:
    """Curves of the reference over the whole range, fine enough to be drawn as lines."""
    low, high = asked.frequency_ratios[0], asked.frequency_ratios[-1]
    eta = np.array([ratio for ratio in DENSE_FREQUENCY_RATIOS if low <= ratio <= high])
    places = [(friction, ratio) for friction in asked.friction_ratios for ratio in eta.tolist()]
    answers = evaluator.evaluate([asked.question(REFERENCE, *place) for place in places])
    curves = np.reshape([_decided(answer) for answer in answers], (len(asked.friction_ratios), eta.size))
    return {friction: (eta, curve) for friction, curve in zip(asked.friction_ratios, curves, strict=True)}


_OperatingPoint = tuple[Variant, float, float]


def _compare(
    asked: Figure3,
    place: _OperatingPoint,
    answers: Mapping[_OperatingPoint, Result],
    others: Mapping[_OperatingPoint, list[Result]],
) -> Comparison:
    """Compare a point with its baseline."""
    return compare_point(_point_results(asked, place, answers, others))


def _point_results(
    asked: Figure3,
    place: _OperatingPoint,
    answers: Mapping[_OperatingPoint, Result],
    others: Mapping[_OperatingPoint, list[Result]],
) -> PointResults:
    """Collect what is known at a point of the grid."""
    variant, friction, eta = place
    return PointResults(
        variant=variant,
        answer=answers[place],
        others=tuple(others.get(place, ())),
        reference=answers[REFERENCE, friction, eta],
        converged=answers[CONVERGED, friction, eta],
        amplified=amplification(asked.ratios, eta),
        refined=tuple(others.get((REFERENCE, friction, eta), ())),
        given=asked.tolerance,
    )


def _edges(
    asked: Figure3,
    grids: Mapping[float, tuple[float, ...]],
    answers: dict[_OperatingPoint, Result],
    others: Mapping[_OperatingPoint, list[Result]],
    evaluator: Evaluator,
) -> Iterator[BandEdge]:
    """Refine all edges of all curves together, and compare them with the converged reference's."""
    curves = [(variant, friction) for variant in asked.all_variants for friction in asked.friction_ratios]
    brackets: dict[tuple[Variant, float, Edge], tuple[float, float]] = {}
    for variant, friction in curves:
        curve = np.array([_decided(answers[variant, friction, eta]) for eta in grids[friction]])
        for edge, bracket in edge_brackets(np.array(grids[friction]), curve, asked.band).items():
            brackets[variant, friction, edge] = bracket
    owners = list(brackets)
    unanswered: set[tuple[Variant, float]] = {
        (variant, friction)
        for variant, friction in curves
        if any(answers[variant, friction, eta].status is ResultStatus.MISSING for eta in grids[friction])
    }

    open_db: dict[int, float] = defaultdict(float)

    def transmittance_db(index: NDArray[np.intp], eta: FloatArray) -> FloatArray:
        asks = [asked.question(owners[k][0], owners[k][1], float(ratio)) for k, ratio in zip(index, eta, strict=True)]
        found = evaluator.evaluate(asks)
        unanswered.update(
            owners[k][:2] for k, one in zip(index, found, strict=True) if one.status is ResultStatus.MISSING
        )
        for k, ratio, one in zip(index, eta, found, strict=True):
            if not one.converged and one.residual <= EDGE_RESIDUAL:
                amplitude = one.residual * amplification(asked.ratios, float(ratio))
                open_db[k] = max(open_db[k], amplitude_in_db(amplitude, asked.band.threshold_db))
        return np.array([_decided(answer) for answer in found])

    crossings = refined_crossings(list(brackets.values()), transmittance_db, asked.band)
    refined = {
        owner: replace(crossing, residual_db=open_db[k])
        for k, (owner, crossing) in enumerate(zip(owners, crossings, strict=True))
    }
    for variant, friction in curves:
        for edge in Edge:
            crossing = refined.get((variant, friction, edge))
            around = [
                _point_results(asked, (variant, friction, eta), answers, others)
                for eta in brackets.get((CONVERGED, friction, edge), ())
            ]
            comparison = compare_edge(crossing, refined.get((CONVERGED, friction, edge)), around)
            found = None if crossing is None else crossing.frequency_ratio
            lacking = [one for one in (variant, CONVERGED) if (one, friction) in unanswered]
            curve_answers = [answers[variant, friction, eta] for eta in grids[friction]]
            if all(answer.status is ResultStatus.BLOCKED for answer in curve_answers):
                comparison = Comparison(Verdict.BLOCKED, curve_answers[0].reason)
            elif lacking:
                found = math.nan if variant in lacking else found
                comparison = Comparison(Verdict.INCONCLUSIVE, _lacking(lacking))
            yield BandEdge(variant, friction, edge, found, comparison)


def _lacking(variants: Sequence[Variant]) -> str:
    """Say whose curve has points that nobody has answered so far."""
    return " and ".join(f"{variant.title}'s curve" for variant in variants) + ": points are not answered so far"


def _decided(answer: Result) -> float:
    """Transmittance of a steady state, or of one so close that it decides an edge; NaN where there is none."""
    return answer.transmittance_db if answer.converged or answer.residual <= EDGE_RESIDUAL else math.nan


def _check_grid(name: str, values: Sequence[float], requirement: str) -> None:
    """Refuse a grid that is empty, not ascending or outside its range."""
    array = checked_array(name, values, requirement)
    if array.size == 0 or np.any(np.diff(array) <= 0):
        raise ParameterError(f"{name} = {list(values)}; allowed: at least one value, ascending, {requirement}")
