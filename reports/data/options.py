"""What options decide: engines as installed and tuned, defaults with one tuned option each, curves over an option."""

import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import pandas as pd

from engines.interface.variant import Variant
from reports.data.points import NAMES, names_of
from reports.data.variants import VariantErrors
from scenarios.studies.few_points import tuned_options, with_single_options

FEWEST_VALUES = 3
"""Values from which on there is a curve; two variants stand beside each other in the table."""


@dataclass(frozen=True)
class SingleOption:
    """A default preset with one option of the tuned one: errors of all three, at the same points."""

    default: VariantErrors
    tuned: VariantErrors
    option: str
    value: str
    """That the tuned preset gives the option, as commands take it."""
    errors: VariantErrors

    @property
    def halves(self) -> bool:
        """Whether the option alone takes off more than half of the largest error."""
        return self.errors.known == self.default.known and self.errors.size < self.default.size / 2


def single_options(errors: Mapping[Variant, VariantErrors]) -> list[SingleOption]:
    """Give the single options of every default whose errors are known, by engine and formulation, smallest first."""
    every = []
    for default in errors.values():
        own = default.variant
        tuned = errors.get(own.tuned)
        if own.preset_name == "default" and tuned is not None:
            for changed in (errors[variant] for variant in with_single_options(own) if variant in errors):
                name, _, value = changed.variant.preset.settings[0].partition("=")
                every += [SingleOption(default, tuned, name, value, changed)] if changed.known else []
    return sorted(every, key=lambda single: (str(single.default.variant), single.errors.size))


@dataclass(frozen=True)
class Installed:
    """Both presets of one formulation of an engine."""

    default: VariantErrors
    tuned: VariantErrors
    options: Mapping[str, Any]
    """What the tuned preset sets otherwise than the default one, by name."""
    decisive: SingleOption | None = None
    """The one of them that alone leaves the least of the default's error, if that is less than half and known."""


def installed(errors: Mapping[Variant, VariantErrors], singles: Sequence[SingleOption] = ()) -> list[Installed]:
    """Give every formulation of which both presets have an error, the largest default error first."""
    best = {single.default.variant: single for single in reversed(singles) if single.halves}
    pairs = []
    for own, default in errors.items():
        tuned = errors.get(own.tuned) if own.preset_name == "default" else None
        if tuned is not None and tuned.known and default.known:
            pairs.append(Installed(default, tuned, tuned_options(own.engine, own.formulation), best.get(own)))
    return sorted(pairs, key=lambda pair: -pair.default.size)


def by_engine(pairs: Iterable[Installed]) -> dict[str, list[Installed]]:
    """Give the formulations of each engine, joints first, by the title of the engine."""
    engines: dict[str, list[Installed]] = {}
    for pair in sorted(pairs, key=lambda pair: pair.tuned.variant.formulation != "joint"):
        engines.setdefault(pair.tuned.variant.capabilities.title, []).append(pair)
    return engines


@dataclass(frozen=True)
class OptionCurve:
    """Variants of one engine and formulation that differ in one option: their errors by its value, ascending."""

    option: str
    errors: Mapping[float, VariantErrors]
    creep: Sequence[float]
    """Largest slip velocity within a stick of each, over ω U0, at all points with a steady state; NaN without any."""

    @property
    def title(self) -> str:
        """The engine, and its formulation where that is not the joint."""
        return next(iter(self.errors.values())).variant.tuned.title


def option_curves(errors: Mapping[Variant, VariantErrors], points: pd.DataFrame) -> list[OptionCurve]:
    """Give a curve an option with a number in which at least `FEWEST_VALUES` variants differ, and in nothing else."""
    creeps = points.groupby("variant", sort=False)["creep"].max().to_dict()
    families: dict[tuple[Any, ...], dict[float, VariantErrors]] = {}
    for group in _by_formulation(errors).values():
        options = _values(own.variant for own in group)
        for own in group:
            for name, value in options[own.variant].items():
                if isinstance(value, int | float) and not isinstance(value, bool):
                    rest = tuple(sorted((key, repr(v)) for key, v in options[own.variant].items() if key != name))
                    families.setdefault((own.variant.engine, own.variant.formulation, name, rest), {})[value] = own
    return [
        OptionCurve(name, dict(sorted(own.items())), [creeps.get(own[v].variant, math.nan) for v in sorted(own)])
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


def option_table(curves: Iterable[OptionCurve], singles: Iterable[SingleOption] = ()) -> pd.DataFrame:
    """Give every variant of every curve over one option, and every default with one option of the tuned preset."""
    shown: list[tuple[str, Any, VariantErrors, float]] = [
        (curve.option, value, own, creep)
        for curve in curves
        for (value, own), creep in zip(curve.errors.items(), curve.creep, strict=True)
    ]
    shown += [(own.option, own.value, own.errors, math.nan) for own in singles]
    rows = [
        (*names_of(own.variant).values(), option, value, own.size, own.median_db, creep)
        for option, value, own, creep in shown
    ]
    columns = ("option", "value", "largest_error_db", "median_error_db", "largest_creep")
    return pd.DataFrame(rows, columns=[*NAMES, *columns])
