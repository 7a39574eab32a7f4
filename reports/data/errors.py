"""How far every variant is from the truth, in one row of numbers: one ruler for all."""

import math
from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass, field
from statistics import median

from engines.interface.variant import Variant
from reports.data.findings import Extreme, worst
from scenarios.sweeps.compared import ComparedSweep
from scenarios.sweeps.sweep import Case
from scenarios.sweeps.table import Point
from scenarios.sweeps.truths import Truths, truth_errors
from scenarios.verdicts.finding import TRANSMITTANCE
from scenarios.verdicts.judge import metric_difference
from scenarios.verdicts.steady_case import REFERENCE
from scenarios.verdicts.truth_error import ErrorClass, TruthError, error_class


@dataclass(frozen=True)
class VariantErrors:
    """One variant against the truth, over all points at which this is above `FLOOR_DB`.

    Parameters
    ----------
    variant
        Which.
    known, points
        Points with a steady state that can be compared, of how many.
    worst
        The largest error [dB], with its sign and its place.
    median
        Median of the sizes of errors [dB]; NaN where none is known.
    beyond_step
        Points at which the variant is farther from the truth than the scheme is with as many steps.
    shares_scheme
        Whether it solves the equations of the reference's scheme; the converged reference does, with a finer step.
    from_scheme
        The largest difference from the reference at equal time step [dB]: agreement with the scheme, not with truth.
    error_class
        `ErrorClass`; ``None`` where no error is known.
    """

    variant: Variant
    known: int = 0
    points: int = 0
    worst: Extreme = field(default_factory=Extreme)
    median: float = math.nan
    beyond_step: int = 0
    shares_scheme: bool = False
    from_scheme: Extreme = field(default_factory=Extreme)
    error_class: ErrorClass | None = None

    @property
    def size(self) -> float:
        """Size of the largest error [dB]."""
        return abs(self.worst.difference)


def variant_errors(result: ComparedSweep, truths: Truths, points: Sequence[Point]) -> dict[Variant, VariantErrors]:
    """Compare every variant of these points with the truth, the smallest error first; those without any come last."""
    counted = Counter(point.variant for point in points if _above_floor(truths, point))
    by_variant: dict[Variant, list[tuple[Point, TruthError]]] = {point.variant: [] for point in points}
    for point, error in truth_errors(result, truths, points):
        if _above_floor(truths, point):
            by_variant[point.variant].append((point, error))
    own_steps = (point for point in result.points if point.variant == REFERENCE and point.result.converged)
    scheme = {(point.case, point.frequency_ratio): point for point in own_steps}
    every = [_errors(variant, own, counted[variant], scheme) for variant, own in by_variant.items()]
    return {own.variant: own for own in sorted(every, key=lambda own: math.inf if math.isnan(own.size) else own.size)}


def _above_floor(truths: Truths, point: Point) -> bool:
    truth = truths.get((point.case, point.frequency_ratio))
    return truth is not None and truth.above_floor


def _errors(
    variant: Variant,
    own: Sequence[tuple[Point, TruthError]],
    points: int,
    scheme: dict[tuple[Case, float], Point],
) -> VariantErrors:
    errors = [error for _, error in own]
    return VariantErrors(
        variant=variant,
        known=len(errors),
        points=points,
        worst=worst(Extreme(error.error_db, point.case, point.frequency_ratio) for point, error in own),
        median=median(abs(error.error_db) for error in errors) if errors else math.nan,
        beyond_step=sum(not error.within_step for error in errors),
        shares_scheme=variant.engine == REFERENCE.engine or variant.preset.shares_scheme,
        from_scheme=worst(_from_scheme(point, scheme) for point, _ in own),
        error_class=error_class(errors),
    )


def _from_scheme(point: Point, scheme: dict[tuple[Case, float], Point]) -> Extreme:
    """Give the difference of a point from the reference at equal step; NaN where that has no steady state."""
    other = scheme.get((point.case, point.frequency_ratio))
    if other is None:
        return Extreme()
    levels = point.result.transmittance_db, other.result.transmittance_db
    return Extreme(metric_difference(TRANSMITTANCE, *levels), point.case, point.frequency_ratio)
