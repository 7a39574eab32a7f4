"""How far every engine is from the truth, as installed and tuned: a line from one to the other, by powers of ten."""

from collections.abc import Mapping, Sequence

from engines.interface.variant import Variant
from reports.data.errors import VariantErrors
from reports.drawing.figure import Axis, Figure, Mark, Panel, Rule, Series
from reports.drawing.style import DASHED, Style
from scenarios.verdicts.steady_case import REFERENCE
from scenarios.verdicts.truth_error import WRONG_DB

JOINING = Style("#9aa4ae", width=2.0)
DEFAULT = Style("#D55E00", "circle", 7.0)
TUNED = Style("#0072B2", "dot", 6.5)
OTHER = Style("#8c8c8c", "diamond", 5.0)
LIMIT = Style("#666666", dash=DASHED, width=0.7)

Row = dict[str, VariantErrors]
"""Errors of one formulation of an engine by preset."""


def installed_figure(errors: Mapping[Variant, VariantErrors]) -> Figure | None:
    """Draw a row an engine and formulation, the largest error on top; ``None`` where nothing but the reference has any.

    Parameters
    ----------
    errors
        Of every variant; those without an error, and the reference, have no row.
    """
    rows: dict[str, Row] = {}
    for variant, own in errors.items():
        if variant.engine != REFERENCE.engine and own.size > 0:
            rows.setdefault(variant.tuned.title, {})[variant.preset_name] = own
    if not rows:
        return None
    names = sorted(rows, key=lambda name: -max(own.size for own in rows[name].values()))
    count = len(names)
    ends = [own.size for row in rows.values() for own in row.values()]
    panel = Panel(
        Axis("largest error [dB]", (min(0.5 * min(ends), 0.01), 2 * max(*ends, WRONG_DB)), "log"),
        Axis(range=(count - 0.5, -0.5), ticks={float(k): name for k, name in enumerate(names)}, grid=False),
        [Rule("x", WRONG_DB, LIMIT), *_marks([rows[name] for name in names])],
    )
    return Figure(
        "installed",
        "Largest error of transmittance to the exact motion: engines as installed and with tuned options; dashed: "
        f"{WRONG_DB:g} dB, from which on a variant is wrong",
        [panel],
        height=0.9 + 0.27 * count,
        pixels=70 + 34 * count,
        legend_columns=3,
    )


def _marks(rows: list[Row]) -> list[Mark]:
    """Give the lines from the smallest to the largest error of each row, and the presets above them."""
    joining = [
        Series([min(sizes), max(sizes)], [k, k], JOINING)
        for k, row in enumerate(rows)
        if len(sizes := [own.size for own in row.values()]) > 1
    ]
    other = [name for row in rows for name in row if name not in ("default", "tuned")]
    presets = [("as installed", ("default",), DEFAULT), ("tuned", ("tuned",), TUNED), ("other presets", other, OTHER)]
    return [*joining, *(_preset(rows, title, names, style) for title, names, style in presets if _any(rows, names))]


def _any(rows: list[Row], names: Sequence[str]) -> bool:
    return any(name in row for row in rows for name in names)


def _preset(rows: list[Row], title: str, names: Sequence[str], style: Style) -> Series:
    every = [(k, own) for k, row in enumerate(rows) for name, own in row.items() if name in names]
    return Series(
        [own.size for _, own in every], [float(k) for k, _ in every], style, title, "markers", "%{text}\n%{x:.4g} dB",
        [f"{own.variant.title}, at ({_place(own)})" for _, own in every],
    )  # fmt: skip


def _place(own: VariantErrors) -> str:
    case = own.worst.case
    return f"{'' if case is None else case.numbers}, {own.worst.frequency_ratio:.6g}"
