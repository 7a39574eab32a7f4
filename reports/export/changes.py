"""What changed from one store to another, as text, Markdown, JSON and CSV."""

import math
from collections import Counter
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from typing import Any

import pandas as pd

from multibody_xval.scenarios.runs.result import ResultStatus
from multibody_xval.scenarios.tables import (
    Column,
    csv_text,
    full_table,
    json_text,
    markdown_lines,
    markdown_list,
    records,
    text_table,
)
from multibody_xval.scenarios.verdicts.regression import NOT_COMPARED, Change, StoreComparison, TruthDirection
from multibody_xval.scenarios.verdicts.stored import StoredResult
from multibody_xval.scenarios.verdicts.thresholds import Thresholds

MOST_SHOWN = 10
"""Points that a summary shows; the others follow, folded."""

NONE = "–"
"""In place of a number that there is none of."""

MOST_FOLDED = 200
"""Points that are folded; with as many the document has a third of the 65,536 characters of a comment on GitHub."""

POINT_NAMES = {
    "friction_ratio": "μ", "frequency_ratio": "η_r", "steps_per_period": "steps",
    "kind": "base:", "mass": "m [kg]", "normal_force": "λ_N [N]", "slip": "slip [m]", "slip_velocity": "ġ [m/s]",
    "carrier_velocity": "u̇ [m/s]", "time_step": "dt [s]",
}  # fmt: skip
"""What names a point within its variant: of a steady state, and of a motion."""


def point_text(change: Change) -> str:
    """Name the point of a change within its variant."""
    task = change.first.task
    values = {**task, **task.get("base", {}), **task.get("block", {})}
    known = [f"{short} {_short(values[name])}" for name, short in POINT_NAMES.items() if values.get(name) is not None]
    return ", ".join(known)


def _short(value: Any) -> str:
    if isinstance(value, str):
        return value
    return f"{value:g}" if isinstance(value, int | float) else f"({', '.join(f'{number:g}' for number in value)})"


def _difference(name: str) -> Callable[[Change], float]:
    return lambda change: change.differences.get(name, math.nan)


def _of_task(name: str) -> Column[Change]:
    return Column(name, lambda change: change.first.task.get(name))


def _both_sides(name: str, value: Callable[[StoredResult], Any]) -> tuple[Column[Change], Column[Change]]:
    return (
        Column(f"{name}_before", lambda change: value(change.first)),
        Column(f"{name}_now", lambda change: value(change.second)),
    )


VARIANT_COLUMN = Column[Change]("variant", lambda change: change.variant, "engine:formulation:preset")
BEYOND_COLUMN = Column[Change]("beyond", lambda change: "; ".join(change.beyond), "what changed")
ERROR_COLUMNS = (
    Column[Change]("error_db_before", lambda change: change.error_db(change.first), "before [dB]", "{:.3g}"),
    Column[Change]("error_db_now", lambda change: change.error_db(change.second), "now [dB]", "{:.3g}"),
)

PRINTED_COLUMNS = (Column[Change]("point", point_text, "point"), *ERROR_COLUMNS, BEYOND_COLUMN)
"""Of a point of a variant, for a terminal."""

CHANGE_COLUMNS: tuple[Column[Change], ...] = (
    VARIANT_COLUMN,
    *map(_of_task, ("friction_ratio", "frequency_ratio", "steps_per_period")),
    *_both_sides("version", lambda side: side.version),
    *_both_sides("status", lambda side: side.result.status),
    *_both_sides("reason", lambda side: side.result.reason),
    *_both_sides("transmittance_db", lambda side: side.result.transmittance_db),
    Column("transmittance_db_change", lambda change: change.transmittance_db),
    Column("stuck_fraction_change", _difference("stuck fraction")),
    Column("transition_change", _difference("transition")),
    Column("unmatched_transitions", _difference("unmatched")),
    Column("motion_change", _difference("motion")),
    *ERROR_COLUMNS,
    Column("truth", lambda change: None if change.truth is None else change.truth.source),
    Column("direction", lambda change: change.direction or ""),
    BEYOND_COLUMN,
)
"""Everything about a point, for programs."""


@dataclass(frozen=True)
class Regression:
    """A comparison of stores, and how it is judged."""

    comparison: StoreComparison
    before: str
    now: str
    thresholds: Thresholds
    strict: bool = False
    """Whether every change is a failure, and not only one for the worse."""

    @property
    def failing(self) -> list[Change]:
        """Points that are failures, the largest difference of transmittance first."""
        return self.comparison.failing(strict=self.strict)

    @property
    def summary(self) -> str:
        """One sentence: how many points were compared, and where the changed ones went."""
        return f"{counted(self.comparison.changes)}; {len(self.failing)} fail"


WORDS = {
    TruthDirection.MISSING: "missing",
    TruthDirection.REGRESSED: "regressed",
    TruthDirection.UNKNOWN: "changed with the truth unknown",
    TruthDirection.UNCHANGED: "changed, as far from the truth",
    TruthDirection.IMPROVED: "improved",
}
"""Directions in sentences, the worst first."""


def counted(changes: Sequence[Change]) -> str:
    """Say how many points there are, and where the changed ones went."""
    count = Counter(change.direction for change in changes)
    changed = ", ".join(f"{count[direction]} {WORDS[direction]}" for direction in WORDS if count[direction])
    return f"{len(changes)} points: {changed or 'none changed'}"


def counted_by_variant(comparison: StoreComparison) -> list[str]:
    """Say so of each variant, with its largest changes."""
    lines = []
    for variant, changes in _by_variant(comparison.changes).items():
        sizes = {"by {} dB at most": _largest(changes, "transmittance"), "motions by {}": _largest(changes, "motion")}
        known = [text.format(size) for text, size in sizes.items() if size != NONE]
        lines.append(f"{variant}: {', '.join([counted(changes), *known])}")
    return lines


def overview(comparison: StoreComparison) -> pd.DataFrame:
    """Give a row for each variant: its points by the directions that occur."""
    rows = []
    occurring = {change.direction for change in comparison.changes}
    for variant, changes in _by_variant(comparison.changes).items():
        count = Counter(change.direction for change in changes)
        row = {"engine:formulation:preset": variant, "points": str(len(changes))}
        row |= {str(direction): str(count[direction]) for direction in WORDS if direction in occurring}
        sizes = {"max dB": _largest(changes, "transmittance"), "max motion": _largest(changes, "motion")}
        rows.append({**row, **sizes})
    table = pd.DataFrame(rows)
    return table.loc[:, (table != NONE).any()]


def _largest(changes: Sequence[Change], measure: str) -> str:
    """Give the largest change by the name of a `Measure`; a dash where there is none."""
    sizes = [abs(change.differences.get(measure, math.nan)) for change in changes]
    known = [size for size in sizes if not math.isnan(size)]
    return f"{max(known):.3g}" if known else NONE


def identities(comparison: StoreComparison) -> list[str]:
    """Name every change of a version, of an option, and of the points that are there, once a variant."""
    lines = [
        f"{variant}: {line}" for variant, own in _by_variant(comparison.changes).items() for line in _identities(own)
    ]
    return lines + [
        f"{variant}: {count} points in the store now only" for variant, count in comparison.only_second.items()
    ]


def _identities(changes: Sequence[Change]) -> list[str]:
    sides = [(change.first, change.second) for change in changes]
    named = {("engine", old.engine, new.engine) for old, new in sides}
    named |= {("version", str(old.version), str(new.version)) for old, new in sides}
    named |= {("sources of the suite", old.sources or "unknown", new.sources or "unknown") for old, new in sides}
    lines = [f"{what} {old} → {new}" for what, old, new in sorted(named) if old != new]
    options = {
        (name, old.options.get(name, "not set"), new.options.get(name, "not set"))
        for old, new in sides
        for name in {*old.options, *new.options}
    }
    lines += [f"option {name} {old} → {new}" for name, old, new in sorted(options) if old != new]
    before, now = (sum(own.result.status is ResultStatus.BLOCKED for own in side) for side in zip(*sides, strict=True))
    if before or now:
        lines.append(f"{before} points blocked before, {now} blocked now")
    uncertified = sum(change.uncertified for change in changes)
    if uncertified:
        lines.append(f"{uncertified} points without a certified steady state before and now: not compared")
    return lines


def _by_variant(changes: Iterable[Change]) -> dict[str, list[Change]]:
    groups: dict[str, list[Change]] = {}
    for change in changes:
        groups.setdefault(change.variant, []).append(change)
    return groups


def changes_markdown(regression: Regression) -> str:
    """Give a document for a comment on a pull request: the summary, the `MOST_SHOWN` worst points, the rest folded."""
    comparison = regression.comparison
    verdict = "fails" if regression.failing else "passes"
    lines = [f"## Engine regression: {verdict}", "", f"{regression.summary}.", ""]
    lines += markdown_lines(overview(comparison))
    named = identities(comparison)
    if named:
        lines += ["", *markdown_list(named)]
    beyond = comparison.beyond
    if beyond:
        lines += ["", *_points(beyond[:MOST_SHOWN])]
    if len(beyond) > MOST_SHOWN:
        folded = beyond[MOST_SHOWN : MOST_SHOWN + MOST_FOLDED]
        left = len(beyond) - MOST_SHOWN - len(folded)
        title = f"{len(folded)} more points" + (f", and {left} that are not shown" if left else "")
        lines += ["", f"<details><summary>{title}</summary>", "", *_points(folded), "", "</details>"]
    return "\n".join([*lines, "", *_explanation(regression), ""])


def _points(changes: Sequence[Change]) -> list[str]:
    return markdown_lines(text_table((VARIANT_COLUMN, *PRINTED_COLUMNS), changes))


def _explanation(regression: Regression) -> list[str]:
    limits = regression.thresholds
    fails = (
        "every change" if regression.strict else "a point that regressed, is missing, or changed with the truth unknown"
    )
    return [
        f"From `{regression.before}` to `{regression.now}`; *before* and *now* are errors of the transmittance to the "
        f"exact motion, or to the converged reference. A change is one of more than {limits.transmittance_db:g} dB, of "
        f"{limits.stuck_fraction:g} of a contact's stuck fraction, of {limits.transition:g} periods in the time of a "
        f"transition, a transition without a partner, or {limits.motion:.2g} of the displacement scale in a transient "
        f"motion; other numbers by the same thresholds. Not compared: {', '.join(NOT_COMPARED).replace('_', ' ')}. "
        f"What fails: {fails}."
    ]


def _content(regression: Regression) -> dict[str, Any]:
    comparison = regression.comparison
    count = Counter(change.direction for change in comparison.changes)
    return {
        "before": regression.before,
        "now": regression.now,
        "strict": regression.strict,
        "thresholds": vars(regression.thresholds),
        "passes": not regression.failing,
        "points": len(comparison.changes),
        "failing": len(regression.failing),
        **{direction.replace(" ", "_"): count[direction] for direction in WORDS},
        "only_now": dict(comparison.only_second),
        "identities": identities(comparison),
        "changes": [
            row | {"fails": change.fails(strict=regression.strict)}
            for row, change in zip(
                records(full_table(CHANGE_COLUMNS, comparison.beyond)), comparison.beyond, strict=True
            )
        ],
    }


CHANGE_FORMATS: dict[str, Callable[[Regression], str]] = {
    ".md": changes_markdown,
    ".json": lambda regression: json_text(_content(regression), indent=1),
    ".csv": lambda regression: csv_text(full_table(CHANGE_COLUMNS, regression.comparison.changes)),
}
"""What is written into a file, by its ending."""
