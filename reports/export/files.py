"""Every file of a report: the page, its tables, its figures."""

import itertools
import math
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr

from reports.data.provenance import provenance
from reports.data.report import Report
from reports.export.tables import band_edge_table, report_json, transition_table, transmittance_table
from reports.page.render import page, sections
from reports.page.sections.stick_slip import stick_slip_rows
from scenarios.studies.attenuation_band import Edge
from scenarios.studies.figure3 import Figure3Result
from scenarios.tables import csv_text
from scenarios.verdicts.verdict import Verdict

TITLE = "Dry friction in multibody engines: a frictional mass-in-mass chain against its LCP reference"
PAGE = "index.html"
NETCDF = "report.nc"
FIGURES = "figures"
"""Folder of the figures, in the report's."""

FILES = ("band_edges.csv", "transmittance.csv", "transitions.csv", "report.json", NETCDF, PAGE)


def files_of(report: Report) -> dict[str, bytes]:
    """Give the content of every file of a report by its path in the report's folder, the page last."""
    result = report.result
    rendered = page(TITLE, sections(report))
    stick_slip, origin = stick_slip_rows(result), provenance(result, report.command)
    texts = {
        "band_edges.csv": csv_text(band_edge_table(result)),
        "transmittance.csv": csv_text(transmittance_table(result)),
        "transitions.csv": csv_text(transition_table(result)),
        "report.json": report_json(result, stick_slip, origin),
    }
    return {
        **{name: text.encode() for name, text in texts.items()},
        **{f"{FIGURES}/{name}": content for name, content in rendered.figures.items()},
        NETCDF: bytes(dataset(result).to_netcdf(engine="h5netcdf")),
        PAGE: rendered.html.encode(),
    }


def write_all(folder: Path, contents: Mapping[str, bytes]) -> None:
    """Write files into `folder`; each appears complete or not at all."""
    for name, content in contents.items():
        file = folder / name
        file.parent.mkdir(exist_ok=True)
        part = file.with_name(f".{file.name}.part")
        try:
            part.write_bytes(content)
            part.replace(file)
        finally:
            part.unlink(missing_ok=True)


def dataset(result: Figure3Result) -> xr.Dataset:
    """Give the numbers with their labels.

    Returns
    -------
    xarray.Dataset
        Dimensions ``variant``, ``friction_ratio``, ``frequency_ratio`` (of all grids together) and ``edge``;
        ``transmittance`` [dB], ``difference`` [dB] from what the variant is compared with, ``residual`` and
        ``verdict`` (a number, see its attributes; −1 where nobody was asked), ``band_edge`` and
        ``band_edge_difference`` in η_r. NaN where there is no number. Attributes: what drives the chain, and its
        amplitude [m] or [N].
    """
    asked = result.asked
    etas = sorted({point.frequency_ratio for point in result.points})
    place = {
        key: k
        for k, key in enumerate(itertools.product(asked.all_variants, asked.friction_ratios, etas))
    }  # fmt: skip
    columns = {name: np.full(len(place), np.nan) for name in ("transmittance", "difference", "residual")}
    verdict = np.full(len(place), -1, dtype=np.int8)
    verdicts = list(Verdict)
    for point in result.points:
        k = place[point.variant, point.friction_ratio, point.frequency_ratio]
        columns["transmittance"][k] = point.answer.transmittance_db
        columns["difference"][k] = point.comparison.difference
        columns["residual"][k] = point.answer.residual
        verdict[k] = verdicts.index(point.comparison.verdict)
    sizes = (len(asked.all_variants), len(asked.friction_ratios), len(etas))
    grid = ("variant", "friction_ratio", "frequency_ratio")
    units = {"transmittance": "dB", "difference": "dB", "residual": "1"}
    meaning = {"flag_values": list(range(len(verdicts))), "flag_meanings": " ".join(verdicts)}
    variables: dict[str, Any] = {
        name: (grid, values.reshape(sizes), {"units": units[name]}) for name, values in columns.items()
    }
    variables["verdict"] = (grid, verdict.reshape(sizes), meaning)
    coordinates = {
        "variant": [str(variant) for variant in asked.all_variants],
        "friction_ratio": list(asked.friction_ratios),
        "frequency_ratio": etas,
        "edge": [str(edge) for edge in Edge],
    }
    drive = {"drive_kind": asked.excitation.kind, "drive_amplitude": asked.excitation.amplitude}
    return xr.Dataset(variables | _edges(result), coords=coordinates, attrs=drive)


def _edges(result: Figure3Result) -> dict[str, Any]:
    """Give the edges of all bands, and their differences."""
    asked = result.asked
    found = [
        result.edge(variant, friction, edge)
        for variant in asked.all_variants
        for friction in asked.friction_ratios
        for edge in Edge
    ]
    sizes = (len(asked.all_variants), len(asked.friction_ratios), len(Edge))
    dimensions = ("variant", "friction_ratio", "edge")
    places = [math.nan if one.frequency_ratio is None else one.frequency_ratio for one in found]
    differences = [one.comparison.difference for one in found]
    return {
        "band_edge": (dimensions, np.reshape(places, sizes), {"units": "1", "long_name": "η_r of the edge"}),
        "band_edge_difference": (dimensions, np.reshape(differences, sizes), {"units": "1"}),
    }
