"""Every file of a report: the page, its tables, its figures."""

import dataclasses
import itertools
from collections.abc import Mapping
from pathlib import Path

import xarray as xr

from multibody_xval.reports.data.points import edge_table
from multibody_xval.reports.data.report import Report
from multibody_xval.reports.export.tables import table_files
from multibody_xval.reports.page.render import FIGURES, TABLES, page, sections
from multibody_xval.scenarios.sweeps.attenuation_band import Edge
from multibody_xval.scenarios.sweeps.compared import ComparedSweep
from multibody_xval.scenarios.sweeps.dataset import sweep_dataset
from multibody_xval.scenarios.sweeps.truths import with_truth_variables
from reference_lcp.output import write_whole

TITLE = "Dry friction in multibody engines: a frictional mass-in-mass chain against its LCP reference"
PAGE = "index.html"
NETCDF = "report.nc"
FILES = (*TABLES, PAGE)

EDGE_VARIABLES = {
    "band_edge": ("frequency_ratio", {"long_name": "η_r of the edge"}),
    "band_edge_difference": (
        "difference", {"long_name": "edge less that of the baseline", "ancillary_variables": "band_edge_allowed"},
    ),
    "band_edge_allowed": ("allowed", {"long_name": "largest such difference that counts as agreement"}),
}  # fmt: skip
"""Variables of the dataset by column of an `edge_table`, and what they are."""


def files_of(report: Report) -> dict[str, bytes]:
    """Give the content of every file of a report by its path in its folder, the page last."""
    rendered = page(TITLE, sections(report))
    return {
        **{name: text.encode() for name, text in table_files(report).items()},
        **{f"{FIGURES}/{name}": content for name, content in rendered.figures.items()},
        NETCDF: bytes(report_dataset(report.result).to_netcdf(engine="h5netcdf")),
        PAGE: rendered.html.encode(),
    }


def write_all(folder: Path, contents: Mapping[str, bytes]) -> None:
    """Write files into `folder`; each appears complete or not at all."""
    for name, content in contents.items():
        file = folder / name
        file.parent.mkdir(exist_ok=True)
        write_whole(file, content)


def report_dataset(result: ComparedSweep) -> xr.Dataset:
    """Give the dataset of the sweep over the frequency ratios of all cases together, with the edges of the band.

    Beside what `multibody_xval.scenarios.sweeps.dataset.sweep_dataset` holds: ``truth_db`` with ``truth_error_db``,
    ``truth_exact`` and ``truth_proven``, along the axes; ``error_db``, of every variant from the truth;
    ``band_edge`` and ``band_edge_difference`` in η_r, along ``edge``; NaN where there is no number.
    """
    etas = tuple(sorted({point.frequency_ratio for point in result.points}))
    sweep = dataclasses.replace(result.sweep, axes={**result.sweep.axes, "frequency_ratio": etas})
    data = with_truth_variables(sweep_dataset(sweep, result.points), sweep, result)
    if not result.edges:
        return data
    every = itertools.product(sweep.variants, sweep.cases, Edge)
    rows = edge_table(result).set_index(["variant", "case", "edge"]).loc[list(every)]
    dimensions = ("variant", *sweep.case_axes, "edge")
    sizes = (len(sweep.variants), *(len(sweep.axes[name]) for name in sweep.case_axes), len(Edge))
    variables = {
        name: (dimensions, rows[column].to_numpy().reshape(sizes), {"units": "1", **attributes})
        for name, (column, attributes) in EDGE_VARIABLES.items()
    }
    edge = ("edge", [str(edge) for edge in Edge], {"long_name": "edge of the attenuation band"})
    return data.assign(variables).assign_coords(edge=edge)
