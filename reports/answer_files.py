"""What scenarios have answered, as files for people and programs: a comment, every number."""

import math
from collections.abc import Callable, Iterator, Sequence
from typing import Any, NamedTuple

import numpy as np
import pandas as pd

from multibody_xval.reports.answers import asked, overview, tables, why
from multibody_xval.reports.document import Folded, Part, document
from multibody_xval.reports.formatting import flat, versions
from multibody_xval.scenarios.catalogue.finding import conclusion, reasons_to_fail
from multibody_xval.scenarios.catalogue.numbers import COLUMNS
from multibody_xval.scenarios.catalogue.scenario import Scenario
from multibody_xval.scenarios.table_text import (
    csv_text,
    json_text,
    markdown_text,
    records,
)


class Answer(NamedTuple):
    """What was asked, and what has come out."""

    scenarios: Sequence[Scenario]
    rows: pd.DataFrame
    """See `multibody_xval.scenarios.catalogue.numbers`."""
    command: str
    named: bool = False
    """Whether the user has named the engines: those fail that often fail."""

    @property
    def reasons(self) -> list[str]:
        """Why the command fails."""
        return reasons_to_fail(self.rows, named=self.named)

    @property
    def outcome(self) -> str:
        """In a word or two."""
        judged = self.rows[self.rows.judged & (self.rows.verdict != "unsupported")]
        return "fail" if self.reasons else "pass" if len(judged) else "nothing judged"

    @property
    def conclusion(self) -> str:
        """One sentence."""
        return conclusion(self.rows, self.reasons)

    def of(self, scenario: Scenario) -> pd.DataFrame:
        """Give the numbers of one scenario."""
        return self.rows[self.rows.scenario == scenario.name]


def markdown(answer: Answer) -> str:
    """Give a comment for a pull request: one sentence, a table, all else folded."""
    folded = [Folded(own.name, list(_details(own, answer.of(own)))) for own in answer.scenarios]
    first: list[Part] = [
        f"## Scenarios: {answer.outcome}",
        markdown_text(answer.conclusion),
        flat(overview(answer.rows)),
    ]
    return document([*first, *folded, f"Made by `{answer.command}`. {markdown_text(versions(answer.rows))}"])


def _details(scenario: Scenario, rows: pd.DataFrame) -> Iterator[Part]:
    """Give what was asked, every number, and why some are not there."""
    yield asked(scenario, rows)
    for name, table in tables(rows, details=True):
        yield markdown_text(name)
        yield flat(table)
    yield why(rows)


def plain(rows: pd.DataFrame) -> pd.DataFrame:
    """Give numbers with plain values: of complex ones the amplitude, and the phase in columns of their own."""
    own = rows[COLUMNS]
    phases = {f"{name}_phase_deg": own[name].map(_phase) for name in ("value", "reference", "exact")}
    return own.map(lambda value: abs(value) if isinstance(value, complex) else value).assign(**phases)


def _phase(value: Any) -> float:
    return float(np.degrees(np.angle(value))) if isinstance(value, complex) else math.nan


def _content(answer: Answer) -> str:
    about = [
        {"name": own.name, "question": own.question, "source": own.source, "expected": own.expects,
         "cases": list(own.cases), "details": list(own.details)}
        for own in answer.scenarios
    ]  # fmt: skip
    return json_text(
        {
            "command": answer.command, "passes": not answer.reasons, "conclusion": answer.conclusion,
            "reasons": answer.reasons, "scenarios": about, "numbers": records(plain(answer.rows)),
        },
        indent=1,
    )  # fmt: skip


WRITTEN: dict[str, Callable[[Answer], str]] = {
    ".md": markdown,
    ".json": _content,
    ".csv": lambda answer: csv_text(plain(answer.rows)),
}
"""What is written into a file, by its ending."""
