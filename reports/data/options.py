"""What options decide: engines as installed and tuned, defaults with one tuned option each, curves over an option."""

import math
from collections.abc import Iterable, Mapping, Sequence
from typing import Any, NamedTuple

import pandas as pd

from engines.interface.variant import Variant
from reports.data.points import NAMES, names_of
from reports.data.variants import Errors
from reports.formatting import MISSING, printed_option, significant
from scenarios.studies.one_option import tuned_options, with_single_options
from scenarios.verdicts.steady_case import REFERENCE

FEWEST_VALUES = 3
"""Values from which on there is a curve; two variants stand beside each other in the table."""


class SingleOption(NamedTuple):
    """A default preset with one option of the tuned one: errors of all three, at the same points."""

    default: Any
    tuned: Any
    option: str
    value: str
    """That the tuned preset gives the option, as the engine takes it."""
    errors: Any
    creep: float
    creep_without: float
    """Of a block that friction holds, with the option and without any [µm/s]; NaN where it is not known."""

    @property
    def reach(self) -> str:
        """Where the option may be copied to."""
        return str(self.tuned.variant.reach(self.option))

    @property
    def halves(self) -> bool:
        """Whether the option alone takes off more than half of the largest error."""
        return self.errors.points_known == self.default.points_known and self.errors.size < self.default.size / 2


def single_options(errors: Errors, creeps: Mapping[Variant, float] | None = None) -> list[SingleOption]:
    """Give the single options of every default whose errors are known, by engine and formulation, smallest first."""
    held = creeps or {}
    every = [
        SingleOption(
            default,
            errors[own.tuned],
            *_setting(changed),
            errors[changed],
            held.get(changed, math.nan),
            held.get(own, math.nan),
        )
        for own, default in errors.items()
        if own.preset_name == "default" and own.tuned in errors
        for changed in with_single_options(own)
        if changed in errors and errors[changed].points_known
    ]
    return sorted(every, key=lambda single: (str(single.default.variant), single.errors.size))


def _setting(changed: Variant) -> tuple[str, str]:
    """Give the option of a variant with a single one, and its value."""
    name = changed.preset.settings[0].partition("=")[0]
    return name, printed_option(changed.preset[name])


TITLES = {"default": "as installed", "recommended": "recommended", "tuned": "tuned"}
"""Presets that README, page and terminal compare, and what they are called there."""

UNSTEADY = "unsteady"
"""Stands for an error where fewer than a third of the points have a steady state."""


def is_unsteady(row: Any) -> bool:
    """Whether there are too few steady states for an error."""
    return bool(3 * row.points_known < row.points)


def error_text(row: Any | None) -> str:
    """Give the largest error of a row of `Errors` in two digits [dB]; with a star where points are not known."""
    if row is None or (not row.points_known and row.blocked):
        return MISSING
    if is_unsteady(row):
        return UNSTEADY
    return significant(row.size) + ("*" if row.points_known < row.points else "")


class Headline(NamedTuple):
    """One engine and formulation: its errors to the truth by preset."""

    variant: Variant
    """The tuned one."""
    rows: Mapping[str, Any]
    """Rows of `Errors` by name of the preset, of those in `TITLES`."""
    decides: str
    """The one option that takes off most of the error as installed, or how many options are tuned."""

    @property
    def texts(self) -> list[str]:
        """Largest errors [dB] in the order of `TITLES`."""
        return [error_text(self.rows.get(name)) for name in TITLES]

    def size(self, name: str) -> float:
        """Give the largest error with a preset [dB]; NaN where it is not known, or unsteady."""
        row = self.rows.get(name)
        return math.nan if row is None or is_unsteady(row) else float(row.size)

    @property
    def farthest(self) -> float:
        """The largest of them; −1 without any."""
        return max((size for name in TITLES if not math.isnan(size := self.size(name))), default=-1.0)


def headlines(errors: Errors, singles: Sequence[SingleOption] = ()) -> list[Headline]:
    """Give a row an engine and formulation but for the reference, the largest error as installed first."""
    rows: dict[Variant, dict[str, Any]] = {}
    for variant, own in errors.items():
        if variant.engine != REFERENCE.engine and variant.preset_name in TITLES:
            rows.setdefault(variant.tuned, {})[variant.preset_name] = own
    decisive = {single.tuned.variant: single for single in reversed(singles) if single.halves}
    shown = [Headline(variant, own, _decides(variant, decisive.get(variant))) for variant, own in rows.items()]
    return sorted(shown, key=lambda row: (math.isnan(row.size("default")), -row.farthest))


def by_engine(rows: Sequence[Headline]) -> dict[str, list[Headline]]:
    """Group rows by the title of their engine, joints first."""
    groups: dict[str, list[Headline]] = {}
    for row in rows:
        groups.setdefault(row.variant.capabilities.title, []).append(row)
    return {title: sorted(own, key=lambda row: row.variant.formulation != "joint") for title, own in groups.items()}


def _decides(variant: Variant, single: SingleOption | None) -> str:
    if single is not None:
        return f"{single.option} = {single.value}"
    count = len(list(tuned_options(variant.engine, variant.formulation)))
    return "1 option" if count == 1 else f"{count} options together" if count else "no option"


def option_curves(errors: Errors, points: pd.DataFrame) -> list[pd.DataFrame]:
    """Give a table an option with a number in which at least `FEWEST_VALUES` variants differ, and in nothing else.

    A row is a variant of one engine and formulation, the ``curve``: value of its ``option``, ascending, largest
    and median error, and largest slip velocity within a stick over ω U0; NaN without a steady state.
    """
    creeps = points.groupby("variant", sort=False)["creep"].max().to_dict()
    families: dict[tuple[Any, ...], dict[float, dict[str, Any]]] = {}
    for variant, values in _values([own.variant for own in errors.values() if own.points_known]).items():
        for name, value in values.items():
            if isinstance(value, int | float) and not isinstance(value, bool):
                rest = tuple(sorted((key, repr(v)) for key, v in values.items() if key != name))
                row = _row(name, value, errors[variant], creeps.get(variant, math.nan))
                families.setdefault((variant.engine, variant.formulation, name, rest), {})[value] = row
    return [
        pd.DataFrame([own[value] for value in sorted(own)]) for own in families.values() if len(own) >= FEWEST_VALUES
    ]


def _values(variants: Iterable[Variant]) -> dict[Variant, dict[str, Any]]:
    """Give the value of every option that any variant of a formulation sets, in each; the engine's own by default."""
    presets: dict[tuple[str, str], dict[Variant, Mapping[str, Any]]] = {}
    for variant in variants:
        presets.setdefault((variant.engine, variant.formulation), {})[variant] = variant.preset.options
    values = {}
    for own in presets.values():
        defaults = {name: option.default for options in own.values() for name, option in options.items()}
        for variant, options in own.items():
            values[variant] = defaults | {name: option.value for name, option in options.items()}
    return values


def _row(option: str, value: Any, own: Any, creep: float) -> dict[str, Any]:
    return {
        "curve": own.variant.tuned.title,
        "variant": own.variant.title,
        **names_of(own.variant),
        "option": option,
        "value": value,
        "largest_error_db": own.size,
        "median_error_db": own.median_error_db,
        "largest_creep": creep,
    }


def option_table(curves: Iterable[pd.DataFrame], singles: Iterable[SingleOption] = ()) -> pd.DataFrame:
    """Give every variant of every curve over one option, and every default with one option of the tuned preset."""
    rows: list[Any] = [row for curve in curves for row in curve.to_dict("records")]
    rows += [{**_row(own.option, own.value, own.errors, math.nan), "creep_um_s": own.creep} for own in singles]
    columns = ("option", "value", "largest_error_db", "median_error_db", "largest_creep", "creep_um_s")
    return pd.DataFrame(rows, columns=[*NAMES, *columns])
