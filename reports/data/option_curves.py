"""What one option of an engine decides: errors of variants that differ in its value alone."""

import math
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from typing import Any

from engines.interface.variant import Variant
from reports.data.errors import VariantErrors
from scenarios.sweeps.table import Point

FEWEST_VALUES = 3
"""Values from which on there is a curve; two variants stand beside each other in the table."""


@dataclass(frozen=True)
class OptionValue:
    """A variant of a curve.

    Parameters
    ----------
    value
        Of the option.
    errors
        How far the variant is from the truth.
    creep
        Largest slip velocity within a stick, over ω U0, at all points with a steady state; NaN where nothing sticks.
    """

    value: float
    errors: VariantErrors
    creep: float


@dataclass(frozen=True)
class OptionCurve:
    """Variants of one engine and formulation that differ in one option.

    Parameters
    ----------
    option
        Its name.
    points
        By value, ascending.
    """

    option: str
    points: tuple[OptionValue, ...]

    @property
    def title(self) -> str:
        """The engine, and its formulation where that is not the joint."""
        return self.points[0].errors.variant.tuned.title


def option_curves(errors: Mapping[Variant, VariantErrors], points: Iterable[Point]) -> list[OptionCurve]:
    """Give a curve an option with a number in which at least `FEWEST_VALUES` variants differ, and in nothing else."""
    creeps = _largest_creeps(points)
    families: dict[tuple[Any, ...], dict[float, VariantErrors]] = {}
    for group in _by_formulation(errors).values():
        options = _values(own.variant for own in group)
        for own in group:
            for name, value in options[own.variant].items():
                if isinstance(value, int | float) and not isinstance(value, bool):
                    rest = tuple(sorted((key, repr(v)) for key, v in options[own.variant].items() if key != name))
                    families.setdefault((own.variant.engine, own.variant.formulation, name, rest), {})[value] = own
    return [
        OptionCurve(name, tuple(OptionValue(v, own[v], creeps.get(own[v].variant, math.nan)) for v in sorted(own)))
        for (_, _, name, _), own in families.items()
        if len(own) >= FEWEST_VALUES
    ]


def _by_formulation(errors: Mapping[Variant, VariantErrors]) -> dict[tuple[str, str], list[VariantErrors]]:
    """Give the variants with an error, by engine and formulation."""
    groups: dict[tuple[str, str], list[VariantErrors]] = {}
    for variant, own in errors.items():
        if own.known:
            groups.setdefault((variant.engine, variant.formulation), []).append(own)
    return groups


def _values(variants: Iterable[Variant]) -> dict[Variant, dict[str, Any]]:
    """Give the value of every option that any of the variants sets, in each: where it is not set, the engine's own."""
    presets = {variant: variant.preset.options for variant in variants}
    defaults = {name: option.default for options in presets.values() for name, option in options.items()}
    return {
        variant: defaults | {name: option.value for name, option in options.items()}
        for variant, options in presets.items()
    }


def _largest_creeps(points: Iterable[Point]) -> dict[Variant, float]:
    largest: dict[Variant, float] = {}
    for point in points:
        known = [creep for creep in point.result.creep if not math.isnan(creep)] if point.result.converged else []
        if known:
            largest[point.variant] = max(*known, largest.get(point.variant, 0.0))
    return largest
