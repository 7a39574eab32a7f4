"""Write the page and its data: from results that are there, nothing is run."""

import importlib.metadata
import platform
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple

import pandas as pd

from multibody_xval.reports.figures import levels, panels
from multibody_xval.reports.figures.svg import Panel, svg
from multibody_xval.reports.formatting import environment
from multibody_xval.reports.page import tables
from multibody_xval.reports.page.drift import creep, drift_table, pasted
from multibody_xval.reports.page.files import PAGE, TABLES, write_files
from multibody_xval.reports.page.finding import finding, reasons_to_fail
from multibody_xval.scenarios.edges import judged_edges
from multibody_xval.scenarios.model import EXACT, REFERENCE, Case
from multibody_xval.scenarios.result_tables import file_columns, points, transitions
from multibody_xval.scenarios.ruler.judge import judged
from multibody_xval.scenarios.store import Stored
from multibody_xval.scenarios.studies.claims import of_paper

if TYPE_CHECKING:
    import xarray as xr

SECTIONS = {
    "transmittance": "Transmittance", "edges": "Band edges", "errors": "Errors",
    "stick_slip": "Stick and slip", "details": "Details",
}  # fmt: skip
"""Sections below the first screen, by their templates; those without a table or figure are left out."""

FIGURE3 = "Figure 3: transmittance"
"""What the first of them is called where it shows the paper's chain."""

PACKAGES = ("multibody-xval", "numpy", "scipy", "numba")

SCALES = {"base": "that of the base", "force": "P0 / k_c, the force's over the stiffness of a spring"}
"""What amplitudes are divided by, by the drive."""

Named = Callable[[pd.DataFrame], pd.Series]


class Written(NamedTuple):
    """The page, what has come out, and why the command fails, if it does."""

    page: Path
    finding: str
    failures: list[str]


def write_page(
    stored: Sequence[Stored],
    folder: Path,
    command: str,
    *,
    left_out: str = "",
    named: Named | None = None,
    judge: Callable[[pd.DataFrame], pd.DataFrame] = judged,
) -> Written:
    """Write the page of stored results, with figures as PDF and tables as CSV.

    Parameters
    ----------
    stored
        Results of engines and of the ruler.
    folder
        Where the page is written; made if it is missing.
    command
        What makes the page again.
    left_out
        What has not been measured, and how it is.
    named
        Tells which rows are of configurations that were asked for by name: these may not fail.
    judge
        Judges the table of points.
    """
    stored = sorted(stored, key=lambda row: (row.run.text, row.version))
    every = points(stored)
    rows = tables.labelled(judge(every))
    found = judged_edges(every)
    edges = tables.edge_table(found)
    shown = tables.planned(every, rows)
    case = tables.shown_case(shown)
    phases = pd.DataFrame() if case is None else _labelled_phases(tables.mode_table(stored, case), case)
    ruled = set(zip(shown.config, shown.case, shown.steps, strict=True))
    own = [row for row in stored if (row.run.config, row.run.case, row.run.steps) in ruled]
    data = {
        "edges": edges, "claims": tables.claim_table(every, found), "transitions": file_columns(transitions(own)),
        "phases": phases, "drift": drift_table(stored),
        "engines": tables.engines((run.config, version) for run, version, _ in stored),
    }  # fmt: skip
    return _written(folder, rows, shown, data, command, left_out, named, case)


def write_dataset_page(data: "xr.Dataset", folder: Path, command: str) -> Written:
    """Write the page of the dataset of a sweep: nothing is computed, so that there are no band edges."""
    from multibody_xval.scenarios.sweeps.dataset import by_tolerance, judged_table, sweep_in

    rows = tables.labelled(by_tolerance(judged_table(data), sweep_in(data).tolerance_db))
    versions = {(config, version) for config, version in zip(rows.config, rows.version, strict=True)}
    line = "A dataset has neither band edges nor the times of stick and slip: report --sweep FILE has them."
    given = {"engines": tables.engines(versions), "drift": pd.DataFrame()}
    return _written(folder, rows, rows, given, command, line, None, None)


def _labelled_phases(table: pd.DataFrame, case: Case) -> pd.DataFrame:
    """Keep the exact motion, and default and tuned joints at their finest steps; the reference where there is none."""
    if table.empty:
        return table
    cases = pd.Series([case] * len(table), table.index, dtype=object)
    own = table.assign(case=cases, preset=[config.preset_name for config in table.config])
    last = "exact" if EXACT in set(own.config) else REFERENCE.preset_name
    kept = own.config.map(
        lambda config: (
            config.formulation == "joint"
            and config.preset_name in ((last,) if config.engine == REFERENCE.engine else ("default", "tuned"))
        )
    )
    finest = own.groupby("configuration").steps.transform("max" if last != "exact" else "min")
    chosen = tables.labelled(own[kept & (own.steps == finest)])
    order = chosen.config.map(lambda config: (config.engine != REFERENCE.engine, str(config)))
    return chosen.assign(order=order).sort_values("order", kind="stable").drop(columns=["case", "config", "order"])


def _written(
    folder: Path, rows: pd.DataFrame, shown: pd.DataFrame, data: dict[str, pd.DataFrame], command: str,
    left_out: str, named: Named | None, case: Case | None,
) -> Written:  # fmt: skip
    """Make the tables and figures of `shown`, the planned points of all `rows`, and write them."""
    engines = tables.engines_only(shown)
    at_headline = tables.at_headline(engines)
    first = tables.worst_first(tables.largest_errors(engines if at_headline.empty else at_headline))
    grid = tables.on_grid(shown)
    edges = data.get("edges", pd.DataFrame())
    own_edges = edges[~edges.configuration.str.startswith(f"{REFERENCE.engine}:")] if len(edges) else edges
    data = data | {
        "points": file_columns(rows), "errors": tables.largest_errors(engines), "headline": tables.headline(first),
        "verdicts": tables.verdict_counts(engines),
    }  # fmt: skip
    size = own_edges.assign(size=own_edges.error.abs()) if len(own_edges) else pd.DataFrame(columns=["size", "title"])
    drawn = {
        "headline": panels.dots(first, "largest_db", panels.LEAST_DB, "Largest error of the vibration amplitude", "dB"),
        "transmittance": levels.transmittance(grid),
        "errors": panels.errors(grid),
        "edges": panels.dots(size, "size", panels.LEAST_EDGE, "Errors of band edges", "frequency ratio"),
        "stick_slip": panels.modes(data["phases"]) if len(data.get("phases", ())) else [],
    }
    failing = reasons_to_fail(engines, own_edges, named)
    result = Written(folder / PAGE, finding(engines), failing)
    text = _page(
        data, drawn, result, command=command, left_out=left_out, case=case, at_headline=not at_headline.empty,
        scale=_scale(shown), recipes=pasted(engines.config) if len(data["drift"]) else {},
        least_percent=panels.LEAST_PERCENT,
        paper=not of_paper(grid).empty, counts=_counts(engines),
        grid_steps=sorted(set(grid.steps)), looks=_looks(first), grid_looks=_looks(grid),
    )  # fmt: skip
    write_files(folder, data, drawn, text)
    return result


def _looks(rows: pd.DataFrame) -> dict[str, str]:
    """Give the colours of the presets that a table has."""
    own = dict.fromkeys(tables.engines_only(rows).options if "engine" in rows else rows.options)
    order = [*(name for name in panels.COLOURS if name in own), *(name for name in own if name not in panels.COLOURS)]
    return {name: panels.look(name)[0] for name in order}


def _scale(rows: pd.DataFrame) -> str:
    """Say what amplitudes of the last mass are divided by."""
    return " or ".join(SCALES[drive] for drive in rows.drive.unique())


def _counts(engines: pd.DataFrame) -> dict[str, int]:
    """Count what was compared."""
    return {
        "engines": engines.engine.nunique(), "configurations": engines.configuration.nunique(), "points": len(engines),
        "cases": engines.case.nunique(),
    }  # fmt: skip


def _page(
    data: dict[str, pd.DataFrame], drawn: dict[str, list[Panel]], result: Written, *, paper: bool, **values: object
) -> str:
    """Give the page of tables and figures; `paper` says whether they show the paper's chain."""
    parts = {name: [svg(panel, f"{name}-{number}") for number, panel in enumerate(own)] for name, own in drawn.items()}
    there = {name for name, table in data.items() if len(table)} | {name for name, own in drawn.items() if own}
    sections = {name: title for name, title in SECTIONS.items() if name in there or name == "details"}
    paper = paper and "transmittance" in sections
    if paper:
        sections["transmittance"] = FIGURE3
    modes = set(data["phases"]["mode"]) if "phases" in there else set()
    drawn_modes = {name: colour for name, colour in panels.MODES.items() if name in modes}
    template = environment("multibody_xval.reports.page").get_template("page.html")
    return template.render(
        tables=data, figures=parts, sections=sections, paper=paper, creep=creep(data["drift"]),
        finding=result.finding, failures=result.failures,
        versions=_versions(), modes=drawn_modes, files=[name for name in TABLES if name in there],
        **values,
    )  # fmt: skip


def _versions() -> str:
    """Name the versions of this environment that numbers may depend on."""
    own = [f"{name} {importlib.metadata.version(name)}" for name in PACKAGES]
    return ", ".join([*own, f"Python {platform.python_version()}", platform.platform(terse=True)])
