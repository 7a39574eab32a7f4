"""Every file of a report: the page, its tables, its figures."""

import dataclasses
import math
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr

from reference_lcp.output import write_whole
from reports.data.report import Report
from reports.drawing.printing import DrawnFigures
from reports.export.tables import table_files
from reports.page.render import FIGURES, page, sections
from scenarios.sweeps.attenuation_band import Edge
from scenarios.sweeps.compared import ComparedSweep
from scenarios.sweeps.dataset import sweep_dataset
from scenarios.sweeps.truths import with_truth_variables

TITLE = "Dry friction in multibody engines: a frictional mass-in-mass chain against its LCP reference"
PAGE = "index.html"
NETCDF = "report.nc"
CARD = "card-"
"""What the names of an engine's card begin with."""
FILES = (
    "errors.csv",
    "band_edges.csv",
    "transmittance.csv",
    "transitions.csv",
    "work_precision.csv",
    "options.csv",
    "catalogue.csv",
    "report.json",
    NETCDF,
    PAGE,
)


def files_of(
    report: Report, drawn: DrawnFigures | None = None, cards: Mapping[str, str] | None = None
) -> dict[str, bytes]:
    """Give the content of every file of a report by its path in its folder, the page last.

    Figures that are `drawn` already are not drawn again; `cards` of engines, by their names, are linked.
    """
    rendered = page(TITLE, sections(report), drawn, cards)
    return {
        **{name: text.encode() for name, text in table_files(report).items()},
        **{f"{FIGURES}/{name}": content for name, content in rendered.figures.items()},
        NETCDF: bytes(report_dataset(report.result).to_netcdf(engine="h5netcdf")),
        PAGE: rendered.html.encode(),
    }


def cards_beside(folder: Path) -> dict[str, str]:
    """Give the pages of the cards in a folder, by name of the engine."""
    return {file.stem.removeprefix(CARD): file.name for file in sorted(folder.glob(f"{CARD}*.html"))}


def write_all(folder: Path, contents: Mapping[str, bytes]) -> None:
    """Write files into `folder`; each appears complete or not at all."""
    for name, content in contents.items():
        file = folder / name
        file.parent.mkdir(exist_ok=True)
        write_whole(file, content)


def report_dataset(result: ComparedSweep) -> xr.Dataset:
    """Give the dataset of the sweep over the frequency ratios of all cases together, with the edges of the band.

    Beside what `scenarios.sweeps.dataset.sweep_dataset` holds: ``truth_db`` with ``truth_error_db`` and
    ``truth_exact``, along the axes; ``error_db``, of every variant from the truth; ``band_edge`` and
    ``band_edge_difference`` in η_r, along ``edge``; NaN where there is no number.
    """
    etas = tuple(sorted({point.frequency_ratio for point in result.points}))
    sweep = dataclasses.replace(result.sweep, axes={**result.sweep.axes, "frequency_ratio": etas})
    data = with_truth_variables(sweep_dataset(sweep, result.points), sweep, result)
    if not result.edges:
        return data
    edge = ("edge", [str(edge) for edge in Edge], {"long_name": "edge of the attenuation band"})
    return data.assign(_edges(result)).assign_coords(edge=edge)


def _edges(result: ComparedSweep) -> dict[str, Any]:
    sweep = result.sweep
    edges = [result.edge(variant, case, edge) for variant in sweep.variants for case in sweep.cases for edge in Edge]
    dimensions = ("variant", *sweep.case_axes, "edge")
    sizes = (len(sweep.variants), *(len(sweep.axes[name]) for name in sweep.case_axes), len(Edge))
    etas = [math.nan if edge.frequency_ratio is None else edge.frequency_ratio for edge in edges]
    differences = [edge.comparison.difference for edge in edges]
    return {
        "band_edge": (dimensions, np.reshape(etas, sizes), {"units": "1", "long_name": "η_r of the edge"}),
        "band_edge_difference": (
            dimensions,
            np.reshape(differences, sizes),
            {"units": "1", "long_name": "edge less that of the baseline", "ancillary_variables": "band_edge_allowed"},
        ),
        "band_edge_allowed": (
            dimensions,
            np.reshape([edge.comparison.tolerance for edge in edges], sizes),
            {"units": "1", "long_name": "largest such difference that counts as agreement"},
        ),
    }
