"""The files of a page: checked before any work, and written."""

from collections.abc import Mapping, Sequence
from pathlib import Path

import pandas as pd

from multibody_xval.reports.figures.svg import Panel, pdf
from multibody_xval.scenarios.output_files import checked_output_file, checked_output_folder, write_whole
from multibody_xval.scenarios.store import Stored
from multibody_xval.scenarios.table_text import csv_text
from reference_lcp.errors import ParameterError

PAGE, FIGURES = "index.html", "figures"

TABLES = ("points", "edges", "transitions", "phases", "errors", "headline", "drift", "verdicts", "engines", "claims")
"""Files that stand beside the page, each with the ending ``.csv``, as far as there is something in them."""


def write_files(
    folder: Path, data: Mapping[str, pd.DataFrame], drawn: Mapping[str, Sequence[Panel]], page: str
) -> None:
    """Write tables and figures that are there, then the page."""
    checked_output_folder("figures", folder / FIGURES)
    for name, table in data.items():
        if len(table):
            write_whole(folder / f"{name}.csv", csv_text(table, missing=""))
    for name, own in drawn.items():
        if own:
            write_whole(folder / FIGURES / f"{name}.pdf", pdf(own))
    write_whole(folder / PAGE, page)


def check_folder(folder: Path, inputs: Sequence[Path | None]) -> None:
    """Refuse a folder into which not all files can be written, or over one of `inputs`; it is made."""
    checked_output_folder("--out", folder)
    for name in (PAGE, *(f"{name}.csv" for name in TABLES)):
        checked_output_file("output file", folder / name, inputs)
    for used in inputs:
        if used is not None and used.resolve().parent == (folder / FIGURES).resolve():
            raise ParameterError(f"{used} lies among the figures that are written; allowed: a file outside {FIGURES}")
    checked_output_folder("figures", folder / FIGURES)


def check_loses_nothing(folder: Path, stored: Sequence[Stored]) -> None:
    """Refuse to overwrite a page of more results of a configuration than these."""
    file = folder / "points.csv"
    if not file.is_file():
        return
    names = ["engine", "formulation", "preset"]
    earlier = pd.read_csv(file, usecols=lambda name: name in names)
    if list(earlier) != names:
        return
    own = pd.Series([tuple(map(str, _names(row))) for row in stored], dtype=object).value_counts()
    for *found, count in earlier.value_counts().reset_index().itertuples(index=False, name=None):
        if count > (held := own.get(tuple(found), 0)):
            problem = f"{folder / PAGE} shows more than the stores hold: of {':'.join(map(str, found))} {count} points"
            raise ParameterError(f"{problem} for {held}; allowed: another --out, or without --no-run")


def _names(row: Stored) -> tuple[str, str, str]:
    config = row.run.config
    return config.engine, config.formulation, config.preset_name
