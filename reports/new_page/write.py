"""Write the page and its data: from stored results alone, nothing is run."""

from collections.abc import Sequence
from pathlib import Path

import pandas as pd
from markupsafe import Markup
from matplotlib.figure import Figure

from multibody_xval.reports.formatting import environment
from multibody_xval.reports.new_page import figures, tables
from multibody_xval.scenarios.edges import judged_edges
from multibody_xval.scenarios.judge import conclusion, failures, judged
from multibody_xval.scenarios.model import Case
from multibody_xval.scenarios.report_plan import HEADLINE_STEPS
from multibody_xval.scenarios.result_tables import file_columns, points, transitions
from multibody_xval.scenarios.store import Stored
from reference_lcp.output import write_whole

STICK_SLIP = Case(friction_ratio=0.1, frequency_ratio=1.5)
"""The point whose stick and slip is shown."""

SECTIONS = ("headline", "transmittance", "edges", "verdicts", "stick_slip", "provenance")


def write_page(stored: Sequence[Stored], folder: Path, command: str, left_out: str = "") -> str:
    """Write ``index.html``, figures as PDF and tables as CSV; gives the finding."""
    every = points(stored)
    rows, found = judged(every), tables.edge_table(judged_edges(every))
    worst = tables.largest_errors(tables.at_headline(rows))
    shown = [own for own in stored if own.run.case == STICK_SLIP and own.run.steps == HEADLINE_STEPS]
    drawn = {
        "transmittance": ("Transmittance over the frequency ratio, by engine", figures.transmittance(rows)),
        "errors": ("Largest error at the headline's points", figures.errors(worst)),
        "error_map": ("Largest error by friction and frequency ratio", figures.error_map(tables.error_map(rows))),
        "stick_slip": ("Stick and slip over a period", figures.stick_slip(transitions(shown))),
    }
    data = {
        "points": file_columns(rows), "edges": found, "errors": worst, "headline": tables.headline(rows),
        "verdicts": tables.verdict_counts(rows), "error_map": tables.error_map(rows),
        "engines": tables.engines(stored), "stick_slip": transitions(shown),
    }  # fmt: skip
    folder.mkdir(parents=True, exist_ok=True)
    _write_data(folder, data, {name: figure for name, (_, figure) in drawn.items()})
    text = environment("multibody_xval.reports.new_page").get_template("page.html")
    page = text.render(
        finding=conclusion(rows), failures=failures(rows), left_out=left_out, command=command, sections=SECTIONS,
        tables=data, figures={name: Markup(figures.svg(figure, title)) for name, (title, figure) in drawn.items()},
    )  # fmt: skip
    write_whole(folder / "index.html", page)
    return conclusion(rows)


def _write_data(folder: Path, data: dict[str, pd.DataFrame], drawn: dict[str, Figure]) -> None:
    for name, table in data.items():
        write_whole(folder / f"{name}.csv", table.to_csv(index=False))
    for name, figure in drawn.items():
        figure.savefig(folder / f"{name}.pdf")
