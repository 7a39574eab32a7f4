"""Changes from one store, or configuration, to another as people and programs read them."""

import json
from collections.abc import Callable
from typing import NamedTuple

import pandas as pd

from multibody_xval.reports.document import Folded, Part, document
from multibody_xval.reports.formatting import flat, number_text, numbered, size_text
from multibody_xval.scenarios.compare.points import CHANGES, LEAST_STUCK, MISSING, NEW, REGRESSED
from multibody_xval.scenarios.compare.stores import conclusion, fails, summary
from multibody_xval.scenarios.model import value_text
from multibody_xval.scenarios.result_tables import rows_of, with_amplitude
from multibody_xval.scenarios.table_text import csv_text, json_text, records

MOST_SHOWN, MOST_FOLDED = 10, 100
"""Changed points, and as many numbers, that a comment shows and has folded beneath: GitHub takes 65,536 characters."""

_NOT_IN_FILES = ("case", "ratio_before", "ratio_now", "open_before", "open_now", "options_before", "options_now")


class Comparison(NamedTuple):
    """Changes, what they are of, and what counts."""

    changes: pd.DataFrame
    before: str
    now: str
    db: float
    strict: bool

    @property
    def fails(self) -> bool:
        """Whether anything is worse; strictly, whether anything has changed."""
        return fails(self.changes, strict=self.strict)

    @property
    def title(self) -> str:
        """What has become of the second, in a few words."""
        if not self.fails:
            return "the second is not worse"
        worse = self.changes.change.isin([REGRESSED, MISSING]).any()
        return f"the second {'is worse' if worse else 'has changed'}"

    @property
    def conclusion(self) -> str:
        """One sentence."""
        return conclusion(self.changes, self.before, self.now)


def changed_points(changes: pd.DataFrame) -> pd.DataFrame:
    """Give the points of steady states that have changed, as texts, the worst first."""
    points = changes[changes.scenario.isna()] if "scenario" in changes else changes
    own = _changed(points, points.error_percent_now - points.error_percent_before)
    texts = {
        "configuration": own.configuration,
        "point": _points(own),
        "what has changed": own.change + ": " + own.what,
        "error before [%]": own.error_percent_before.map(_number),
        "error now [%]": own.error_percent_now.map(_number),
    }
    return pd.DataFrame(texts, own.index, dtype=object)


def changed_numbers(changes: pd.DataFrame) -> pd.DataFrame:
    """Give the numbers of motions and scenes that have changed, as texts, the worst first."""
    if "scenario" not in changes:
        return pd.DataFrame({"configuration": []})
    numbers = changes[changes.scenario.notna()]
    allowed = numbers.allowed_now.fillna(numbers.allowed_before)
    own = _changed(numbers, (numbers.error_now.abs() - numbers.error_before.abs()) / allowed)
    ended, of = own.status_before != own.status_now, own.scenario + ", " + own.scenario_case
    texts = {
        "configuration": own.configuration,
        "what": [numbered(*each) for each in rows_of(own.assign(of=of), "quantity", "unit", "of")],
        "before": own.value_before.map(number_text),
        "now": own.value_now.map(number_text),
        "allowed": allowed[own.index].map(size_text),
        "result": own.change + "\n" + own.what.where(ended, own.verdict_now),
    }
    return pd.DataFrame(texts, own.index, dtype=object)


def _changed(rows: pd.DataFrame, farther: pd.Series) -> pd.DataFrame:
    """Give what has changed, the worst first: what is farther from the exact value by more."""
    order = rows.assign(place=rows.change.map(CHANGES.index), farther=farther.abs())
    own = order[(rows.what != "") & (rows.change != NEW)]
    return own.sort_values(["place", "farther"], ascending=[True, False], kind="stable")


def _points(rows: pd.DataFrame) -> list[str]:
    """Name the case of every row, and the steps where one configuration has several."""
    several = rows.groupby("configuration").steps.transform("nunique") > 1
    named = zip(rows.case, rows.steps, several, strict=True)
    titles = [(case if isinstance(case, str) else case.title, steps, more) for case, steps, more in named]
    return [f"{title}, {steps} steps" if more else title for title, steps, more in titles]


def overview(changes: pd.DataFrame) -> pd.DataFrame:
    """Give the number of points a configuration by what has become of them, as texts."""
    return summary(changes).map(lambda value: value if isinstance(value, str) else _number(value))


def _number(value: float) -> str:
    return "–" if pd.isna(value) else str(value) if isinstance(value, int) else f"{value:.3g}"


def identities(changes: pd.DataFrame) -> list[str]:
    """Name the versions of every engine before and now, and options that differ."""
    sides = changes[(changes.version_before != "") & (changes.version_now != "")]
    names = ("engine_before", "version_before", "engine_now", "version_now")
    lines = [_versions(*row) for row in sides[list(names)].drop_duplicates().itertuples(index=False)]
    same = sides[sides.engine_before == sides.engine_now]
    every = same[["configuration", "options_before", "options_now"]].drop_duplicates()
    return lines + [line for row in every.itertuples(index=False) for line in _options(*row)]


def _versions(engine: str, version: str, other: str, other_version: str) -> str:
    if engine != other:
        return f"{engine} {version} → {other} {other_version}"
    return f"{engine} {version} → {other_version}" if version != other_version else f"{engine} {version} before and now"


def _options(configuration: str, before: str, now: str) -> list[str]:
    old, new = (json.loads(text) for text in (before, now))
    names = [name for name in {**old, **new} if old.get(name) != new.get(name)]
    changes = [f"{name} {old.get(name, 'not set')} → {new.get(name, 'not set')}" for name in names]
    return [f"{configuration}: options {', '.join(changes)}"] if changes else []


def markdown(own: Comparison) -> str:
    """Give a comment for a pull request: one sentence, a table, versions, the worst points, the rest folded."""
    parts: list[Part] = [
        f"## Comparison: {own.title}",
        own.conclusion,
        overview(own.changes),
        identities(own.changes),
        *_folded(changed_points(own.changes), "points"),
        *_folded(flat(changed_numbers(own.changes)), "numbers"),
    ]
    return document([*parts, _explanation(own)])


def _folded(changed: pd.DataFrame, name: str) -> list[Part]:
    """Give a table that shows the worst and folds the rest."""
    folded = changed[MOST_SHOWN : MOST_SHOWN + MOST_FOLDED]
    left = len(changed) - MOST_SHOWN - len(folded)
    title = f"{len(folded)} more {name}" + (f", and {left} that are not shown" if left > 0 else "")
    return [changed[:MOST_SHOWN], *[Folded(title, [folded])] * (len(folded) > 0)]


def _explanation(own: Comparison) -> str:
    failing = "every change" if own.strict else "a point that has regressed, is missing, or whose change is unknown"
    return (
        "Errors are distances of the transmittance, level and phase in one, from the exact motion, in per cent of its "
        f"amplitude. A change is one of more than {own.db:g} dB of the transmittance and of what the steady states "
        f"leave open, or of more than {LEAST_STUCK:g} and two time steps of the part of the period that a contact "
        "sticks; of a number of a scenario, one of more than that part of it and of what it leaves open. It is unknown "
        "where no exact value is in the stores. Points that are new cannot fail. "
        f"The comparison fails at {failing}."
    )


def _content(own: Comparison) -> str:
    counts = {name: int((own.changes.change == name).sum()) for name in CHANGES}
    about = {"before": own.before, "now": own.now, "db": own.db, "strict": own.strict, "passes": not own.fails}
    rows = records(_plain(own.changes))
    return json_text(
        {**about, "points": len(own.changes), **counts, "identities": identities(own.changes), "changes": rows},
        indent=1,
    )


def _plain(changes: pd.DataFrame) -> pd.DataFrame:
    """Give every point with plain values."""
    table = with_amplitude(changes.drop(columns=list(_NOT_IN_FILES), errors="ignore"))
    return table.map(lambda value: value_text(value) if isinstance(value, tuple) else value)


WRITTEN: dict[str, Callable[[Comparison], str]] = {
    ".md": markdown,
    ".json": _content,
    ".csv": lambda own: csv_text(_plain(own.changes).dropna(axis="columns", how="all")),
}
"""What is written into a file, by its ending."""
