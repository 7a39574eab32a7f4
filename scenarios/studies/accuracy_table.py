"""The accuracy of engines as a table: for the terminal, for documents, for other programs."""

import csv
import io
import math
import platform
from collections.abc import Callable, Sequence
from dataclasses import dataclass

from engines.interface.registry import engine
from engines.shared.step_cost import StepCost
from scenarios.studies.accuracy import MAP_STEPS, ORDER_STEPS, Accuracy

Row = tuple[Accuracy, StepCost | None]
"""A variant's accuracy, and what its step costs if that was measured."""


@dataclass(frozen=True)
class Column:
    """One column: what it is called for people and for programs, and what stands in it."""

    heading: str
    key: str
    value: Callable[[Row], float | int | str]
    pattern: str = "{}"

    def text(self, row: Row) -> str:
        """Give the value as people read it."""
        value = self.value(row)
        if isinstance(value, float) and math.isnan(value):
            return "–"
        return self.pattern.format(value)


def _points(steps: int) -> Callable[[Row], float]:
    return lambda row: row[0].points_db[steps]


def _cost(name: str, scale: float) -> Callable[[Row], float]:
    return lambda row: math.nan if row[1] is None else scale * getattr(row[1], name)


COLUMNS = (
    Column("engine", "engine", lambda row: row[0].variant.engine),
    Column("formulation", "formulation", lambda row: row[0].variant.formulation),
    Column("preset", "preset", lambda row: row[0].variant.preset_name),
    *(Column(f"six points, {n} [dB]", f"points_{n}_db", _points(n), "{:.3f}") for n in ORDER_STEPS[:2]),
    Column(f"map, {MAP_STEPS} [dB]", "map_db", lambda row: row[0].map_db, "{:.3f}"),
    Column("stuck fraction", "stuck_fraction_error", lambda row: row[0].stuck_fraction, "{:.3f}"),
    Column("median [% T]", "median_transition_percent", lambda row: 100 * row[0].median_transition, "{:.3f}"),
    Column("max [% T]", "largest_transition_percent", lambda row: 100 * row[0].largest_transition, "{:.2f}"),
    Column("missed", "missed", lambda row: row[0].missed),
    Column("spurious", "spurious", lambda row: row[0].spurious),
    Column("of", "transitions", lambda row: row[0].transitions),
    Column("creep [ω U0]", "creep", lambda row: row[0].creep, "{:.1e}"),
    Column("order", "order", lambda row: row[0].order, "{:.2f}"),
    Column("certified", "certified", lambda row: f"{row[0].certified}/{row[0].points}"),
    Column("µs a step", "advance_us", _cost("advance", 1e6), "{:.2f}"),
    Column("× bare", "times_bare", _cost("ratio", 1), "{:.2f}"),
)

LEGEND = f"""\
Errors are worst absolute differences from the exact, event-driven motion, over the points with a certified steady
state: *six points* at 400 and {ORDER_STEPS[1]} steps a period; *map*: 4 friction ratios (0.1 … 1) × 14 frequency ratios
(0.3 … 1.6) at {MAP_STEPS}. On the map too: the error of a contact's stuck fraction; the median and the largest time
error of its transitions between stick and slip, in percent of the period; transitions that are *missed* and those
that are *spurious*, out of how many. *Creep* is the largest velocity within a stick. *Order* is that of the error in
the time step, from {", ".join(map(str, ORDER_STEPS))} steps. *Certified*: points whose steady state repeats to the
engine's residual. *µs a step*: of a chain of seven cells on one core, without a record, in the batch that the suite
runs; *× bare*: over the engine's own loop in the same run.
"""


def markdown(rows: Sequence[Row], command: str) -> str:
    """Give the table as a document, with how it was made."""
    lines = ["# Accuracy of the engines", "", LEGEND, f"Made by `{command}`.", ""]
    lines += ["| " + " | ".join(column.heading for column in COLUMNS) + " |", "|" + "---|" * len(COLUMNS)]
    lines += ["| " + " | ".join(column.text(row) for column in COLUMNS) + " |" for row in rows]
    lines += ["", "Where the largest error on the map is, and what has no certified steady state:", ""]
    lines += [f"- {note}" for row in rows if (note := remark(row[0]))]
    lines += ["", f"Versions: {versions(rows)}; Python {platform.python_version()}.", ""]
    return "\n".join(lines)


def csv_table(rows: Sequence[Row]) -> str:
    """Give the table as CSV, with full precision."""
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow(column.key for column in COLUMNS)
    writer.writerows([column.value(row) for column in COLUMNS] for row in rows)
    return text.getvalue()


def remark(found: Accuracy) -> str:
    """Say of a variant what its numbers leave out."""
    parts = []
    if found.worst_place is not None:
        parts.append(f"worst at ({found.worst_place[0]:g}, {found.worst_place[1]:g})")
    if found.certified < found.points:
        parts.append(f"{found.points - found.certified} of {found.points} points are not certified")
    if found.blocked:
        parts.append(f"blocked: {found.blocked}")
    return f"{found.variant}: {'; '.join(parts)}" if parts else ""


def versions(rows: Sequence[Row]) -> str:
    """Name every engine's version once."""
    names = dict.fromkeys(row[0].variant.engine for row in rows)
    installed = [engine(name) for name in names if engine(name).unavailable_reason() is None]
    return ", ".join(f"{one.name} {one.version()}" for one in installed)
