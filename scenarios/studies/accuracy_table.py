"""The accuracy of engines as a table: for the terminal, for documents, for other programs."""

import math
import platform
from collections.abc import Callable, Sequence

from engines.shared.step_cost import StepCost
from scenarios.studies.accuracy import ACCURACY_MAP_STEPS, ORDER_STEPS, Accuracy
from scenarios.tables import Column, csv_text, full_table, markdown_lines, text_table
from scenarios.tasks.versions import versions_of

AccuracyRow = tuple[Accuracy, StepCost | None]
"""A variant's accuracy, and what its step costs if that was measured."""


def _points(steps: int) -> Callable[[AccuracyRow], float]:
    return lambda row: row[0].points_db[steps]


def _cost(name: str, scale: float) -> Callable[[AccuracyRow], float]:
    return lambda row: math.nan if row[1] is None else scale * getattr(row[1], name)


ACCURACY_COLUMNS: tuple[Column[AccuracyRow], ...] = (
    Column("engine", lambda row: row[0].variant.engine),
    Column("formulation", lambda row: row[0].variant.formulation),
    Column("preset", lambda row: row[0].variant.preset_name),
    *(Column(f"points_{n}_db", _points(n), f"six points, {n} [dB]", "{:.3f}") for n in ORDER_STEPS[:2]),
    Column("map_db", lambda row: row[0].map_db, f"map, {ACCURACY_MAP_STEPS} [dB]", "{:.3f}"),
    Column("stuck_fraction_error", lambda row: row[0].stuck_fraction, "stuck fraction", "{:.3f}"),
    Column("median_transition_percent", lambda row: 100 * row[0].median_transition, "median [% T]", "{:.3f}"),
    Column("largest_transition_percent", lambda row: 100 * row[0].largest_transition, "max [% T]", "{:.2f}"),
    Column("missed", lambda row: row[0].missed),
    Column("spurious", lambda row: row[0].spurious),
    Column("transitions", lambda row: row[0].transitions, "of"),
    Column("creep", lambda row: row[0].creep, "creep [ω U0]", "{:.1e}"),
    Column("order", lambda row: row[0].order, pattern="{:.2f}"),
    Column("certified", lambda row: f"{row[0].certified}/{row[0].points}"),
    Column("advance_us", _cost("advance", 1e6), "µs a step", "{:.2f}"),
    Column("times_bare", _cost("ratio", 1), "× bare", "{:.2f}"),
)

PRINTED_COLUMNS: tuple[Column[AccuracyRow], ...] = (
    Column("variant", lambda row: str(row[0].variant), "engine:formulation:preset"),
    *ACCURACY_COLUMNS[3:],
)
"""On a terminal a variant has one column."""

ACCURACY_LEGEND = f"""\
How large are the errors of each engine, formulation and preset? An error is the largest absolute difference from the
exact, event-driven motion, over the points with a certified steady state. The columns:

- *six points*: error of the transmittance at six stick–slip points, with 400 and {ORDER_STEPS[1]} steps a period;
- *map*: the same at 4 friction ratios (0.1 … 1) × 14 frequency ratios (0.3 … 1.6), with {ACCURACY_MAP_STEPS} steps;
- *stuck fraction*: error of a contact's stuck fraction, on the map;
- *median*, *max*: error of the times of transitions between stick and slip, in percent of the period T, on the map;
- *missed*, *spurious*, *of*: transitions that the engine lacks, that only the engine has, and all of the exact motion;
- *creep*: largest velocity within a stick, over ω U0;
- *order*: order of the error in the time step, from {", ".join(map(str, ORDER_STEPS))} steps;
- *certified*: points whose steady state repeats to the engine's residual;
- *µs a step*: time of a step of seven cells on one core, without a record, in the suite's batch;
- *× bare*: that time over the time of the engine's own loop in the same run.
"""


def accuracy_document(rows: Sequence[AccuracyRow], command: str) -> str:
    """Give the table as a document, with how it was made."""
    lines = ["# Accuracy of the engines", "", ACCURACY_LEGEND, f"Made by `{command}`.", ""]
    lines += markdown_lines(text_table(ACCURACY_COLUMNS, rows))
    lines += ["", "Where the largest error on the map is, and what has no certified steady state:", ""]
    lines += [f"- {text}" for row in rows if (text := remark(row[0]))]
    lines += [
        "",
        f"Versions: {versions_of(row[0].variant.engine for row in rows)}; Python {platform.python_version()}.",
        "",
    ]
    return "\n".join(lines)


def csv_table(rows: Sequence[AccuracyRow]) -> str:
    """Give the table as CSV, with full precision."""
    return csv_text(full_table(ACCURACY_COLUMNS, rows))


def remark(accuracy: Accuracy) -> str:
    """Give the worst point, uncertified points and the reason of blocked ones, in words."""
    parts = []
    if accuracy.worst_point is not None:
        parts.append(f"worst at ({accuracy.worst_point[0]:g}, {accuracy.worst_point[1]:g})")
    if accuracy.certified < accuracy.points:
        parts.append(f"{accuracy.points - accuracy.certified} of {accuracy.points} points are not certified")
    if accuracy.blocked:
        parts.append(f"blocked: {accuracy.blocked}")
    return f"{accuracy.variant}: {'; '.join(parts)}" if parts else ""
