"""What is asked of the dataset of a sweep: the edges of its attenuation bands, and its curves as a figure."""

from collections.abc import Iterable
from pathlib import Path

import matplotlib as mpl
import numpy as np
import pandas as pd
import xarray as xr
from matplotlib.figure import Figure as Canvas

from multibody_xval.engines.interface.registry import engine
from multibody_xval.engines.interface.variant import Variant
from multibody_xval.reports.data.points import edge_table, written
from multibody_xval.reports.figures.drawing import legend, mathtext
from multibody_xval.reports.figures.style import COLUMN, PAGE_WIDTH, PRINT_STYLE, RULE, curve_style
from multibody_xval.reports.figures.transmittance import FREQUENCY_LABEL, LEVEL_LABEL, LOWEST_DB
from multibody_xval.scenarios.runs import TIME_LIMIT
from multibody_xval.scenarios.runs.dask_cluster import executor_for
from multibody_xval.scenarios.runs.evaluator import Evaluator
from multibody_xval.scenarios.runs.progress import ProgressBars
from multibody_xval.scenarios.runs.result import ResultStatus
from multibody_xval.scenarios.runs.store import opened_store
from multibody_xval.scenarios.sweeps.compared import compare_sweep
from multibody_xval.scenarios.sweeps.dataset import STATUSES
from multibody_xval.scenarios.sweeps.dataset_reader import DatasetResults, recorded_variants, sweep_of
from multibody_xval.scenarios.sweeps.sweep import Sweep
from multibody_xval.scenarios.verdicts.steady_case import CONVERGED, REFERENCE
from reference_lcp.errors import ParameterError, checked_path
from reference_lcp.output import checked_output_file, replacing, shown_in_notebooks
from reference_lcp.studies.plot import checked_picture_format

EDGE_COLUMNS = ("edge", "frequency_ratio", "absent", "difference", "allowed", "verdict", "outcome", "reason")

MOST_PANELS = 24
"""Cases that one figure shows."""

PANEL_HEIGHT = 2.0
"""Of one row of panels in print [inch]."""


def edges_of(data: xr.Dataset, store: str | Path | None, workers: int | None, time_limit: float | None) -> pd.DataFrame:
    """Refine both edges of every curve of a dataset; see `multibody_xval.band_edges`."""
    known = DatasetResults(data)
    _check_versions(data, known.sweep)
    sweep = known.sweep.with_reference()
    with (
        opened_store(None if store is None else checked_path("store", store)) as stored,
        ProgressBars(sweep.variants) as bars,
        Evaluator(stored, executor_for(workers, time_limit or TIME_LIMIT), bars) as evaluator,
    ):
        evaluator.know(known.results.items())
        evaluator.stage("band edges")
        result = compare_sweep(sweep, evaluator)
    return written(edge_table(result), result, EDGE_COLUMNS)


def _check_versions(data: xr.Dataset, sweep: Sweep) -> None:
    """Refuse to refine the curve of one version of an engine with another one."""
    recorded = recorded_variants(data)
    for variant in sweep.variants:
        of, noted = engine(variant.engine), recorded.get(str(variant), {}).get("version")
        installed = of.version() if of.unavailable_reason() is None else None
        if noted != installed:
            problem = f"the data are of {variant.engine} {noted}, and {installed or 'none'} is installed"
            raise ParameterError(f"{problem}; allowed: the same version, or data.sel(...) without {variant}")


def figure_of(data: xr.Dataset, file: str | Path | None) -> Canvas:
    """Draw the transmittance of a dataset; see `multibody_xval.plot`."""
    picture = None if file is None else checked_picture_format(checked_output_file("file", checked_path("file", file)))
    with mpl.rc_context(PRINT_STYLE):
        canvas = _drawn(data)
        if picture is not None:
            with replacing(picture) as part:
                canvas.savefig(part)
    return shown_in_notebooks(canvas)


def _drawn(data: xr.Dataset) -> Canvas:
    """Draw a panel a case with every variant, or one panel with a curve a case."""
    sweep = sweep_of(data)
    if len(sweep.cases) > MOST_PANELS:
        raise ParameterError(
            f"the data have {len(sweep.cases)} cases; allowed: <= {MOST_PANELS}, such as data.sel(...)"
        )
    shown = [own for own in sweep.variants if own != CONVERGED or REFERENCE not in sweep.variants]
    curves = {(own, case): _curve(data, own, case.by_axis) for own in shown for case in sweep.cases}
    alone = len(shown) == 1
    titles = [shown[0].title] if alone else [case.title for case in sweep.cases]
    columns = min(len(titles), 2)
    rows = -(-len(titles) // columns)
    canvas = Canvas(figsize=(PAGE_WIDTH if columns > 1 else COLUMN, 0.9 + PANEL_HEIGHT * rows), layout="constrained")
    grid = canvas.subplots(rows, columns, squeeze=False, sharex=True, sharey=True).ravel()
    for axes, title in zip(grid, titles, strict=False):
        axes.axhline(sweep.band.threshold_db, **RULE)
        axes.set(title=title, ylim=_levels(sweep, curves.values()))
    for axes in grid[::columns]:
        axes.set_ylabel(LEVEL_LABEL)
    for axes in grid[len(titles) :]:
        axes.set_visible(False)
    for number, ((variant, case), curve) in enumerate(curves.items()):
        label, panel = (case.title, 0) if alone else (variant.title, sweep.cases.index(case))
        style = curve_style(number if alone else shown.index(variant))
        grid[panel].plot(curve.index, curve, label=label, **style)
    canvas.supxlabel(mathtext(FREQUENCY_LABEL))
    legend(canvas, 2 * columns)
    return canvas


def _levels(sweep: Sweep, curves: Iterable[pd.Series]) -> tuple[float, float]:
    """Give the lowest and the highest transmittance that is drawn."""
    levels = np.concatenate([curve.to_numpy() for curve in curves])
    known = np.append(levels[np.isfinite(levels)], sweep.band.threshold_db)
    return max(LOWEST_DB, known.min() - 5), max(known) + 5


def _curve(data: xr.Dataset, variant: Variant, case: dict[str, float]) -> pd.Series:
    """Give the transmittance [dB] of one curve by η_r: only of its own points, NaN where there is no steady state."""
    place = {"variant": str(variant), **case}
    held = {name: value for name, value in place.items() if name in data.dims}
    own = data[["transmittance_db", "status"]].sel(held).reset_coords(drop=False)
    eta = np.atleast_1d(data["frequency_ratio"].values)
    status, level = np.atleast_1d(own["status"].values), np.atleast_1d(own["transmittance_db"].values)
    level = np.where(status == STATUSES.index(ResultStatus.CONVERGED), level, np.nan)
    return pd.Series(level, eta)[status != STATUSES.index(ResultStatus.MISSING)].sort_index()
