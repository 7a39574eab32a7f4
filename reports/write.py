"""From a dataset, the file of a sweep, a store, or a sweep itself, to the folder of a report."""

import sys
from collections import Counter
from collections.abc import Sequence
from contextlib import ExitStack
from pathlib import Path
from typing import NamedTuple

import xarray as xr

from multibody_xval.reports.data.collect import Scope, collect, collect_dataset
from multibody_xval.reports.data.report import Report
from multibody_xval.reports.export.files import FILES, NETCDF, PAGE, files_of, write_all
from multibody_xval.reports.page.render import FIGURES
from multibody_xval.reports.plan import sweep_of
from multibody_xval.scenarios.runs.dask_cluster import executor_for
from multibody_xval.scenarios.runs.evaluator import Evaluator, StoredResults
from multibody_xval.scenarios.runs.executor import Executor
from multibody_xval.scenarios.runs.progress import ProgressBars
from multibody_xval.scenarios.runs.result import ResultStatus
from multibody_xval.scenarios.runs.store import ResultStore
from multibody_xval.scenarios.sweeps.dataset import STATUSES
from multibody_xval.scenarios.sweeps.dataset_reader import read_dataset
from multibody_xval.scenarios.sweeps.run import save_sweep, saved_sweeps
from multibody_xval.scenarios.sweeps.sweep import Sweep
from multibody_xval.scenarios.verdicts.proven import proven_level
from multibody_xval.scenarios.verdicts.steady_case import EXACT
from reference_lcp.errors import ParameterError, checked_path
from reference_lcp.output import checked_output_file, checked_output_folder

STORE = "results.sqlite"
"""File of the results in the folder of a report, where no other is named."""

MOST_CASES = 9
"""Cases of a sweep of which the first line says what is proven: more fill the screen."""


class Written(NamedTuple):
    """The page of a report, and what it is made of."""

    page: Path
    report: Report


def write_report(data: object, folder: str | Path) -> Written:
    """Write the report of a dataset, of the file of a sweep, or of a store; see `multibody_xval.report`."""
    folder = checked_path("folder", folder)
    if isinstance(data, xr.Dataset):
        return write_dataset_report(data, folder, "multibody_xval.report(data, folder)")
    if not isinstance(data, str | Path):  # a DataFrame, such as `check` gives
        kinds = "the dataset of a sweep, or the path of a .nc, .toml or .sqlite file"
        raise ParameterError(f"data is a {type(data).__name__}; allowed: {kinds}")
    file, command = checked_path("data", data), f"multibody_xval.report({str(data)!r}, folder)"
    if file.suffix == ".toml":
        return write_sweep_report(sweep_of(file), folder, command)
    if file.suffix == ".sqlite":
        return write_sweep_report(saved_sweeps(file).sweep.with_reference(), folder, command, store=file, run=False)
    return write_dataset_report(read_dataset(file), folder, command, file)


def write_dataset_report(data: xr.Dataset, folder: Path, command: str, file: Path | None = None) -> Written:
    """Write the report of what a dataset, read from `file` if it was, holds; nothing is computed."""
    check_folder("folder", folder, [file])
    try:
        report = collect_dataset(data, command)
    except ParameterError as problem:
        raise ParameterError(f"{file}: {problem}" if file is not None else str(problem)) from None
    return _written(report, folder)


def write_sweep_report(
    sweep: Sweep,
    folder: Path,
    command: str,
    *,
    store: Path | None = None,
    run: bool = True,
    scope: Scope | None = None,
    executor: Executor | None = None,
    retry_blocked: bool = False,
    keep_old: bool = False,
) -> Written:
    """Write the report of a sweep, in which the reference takes part."""
    chosen = scope or Scope()
    executor = executor or executor_for()
    file = store or folder / STORE
    check_folder("folder", folder, [file])
    with ExitStack() as stack:
        stored = stack.enter_context(ResultStore(file, keep_old=keep_old))
        if not run:
            shown = collect(sweep, stored, StoredResults(stored), command, scope=chosen)
            check_loses_nothing(folder, shown)
            return _written(shown, folder)
        save_sweep(stored, sweep)
        _say_proven(sweep)
        bars = stack.enter_context(ProgressBars(sweep.variants))
        evaluator = stack.enter_context(Evaluator(stored, executor, bars, retry_blocked=retry_blocked))
        report = collect(sweep, stored, evaluator, command, scope=chosen)
    return _written(report, folder)


def _say_proven(sweep: Sweep) -> None:
    """Say what is proven of the grid before anything is run: how much of it the exact motion attenuates."""
    counts = []
    for case in sweep.cases if len(sweep.cases) <= MOST_CASES else ():
        proven = [proven_level(sweep.task(EXACT, case, eta)) for eta in sweep.frequency_ratios]
        below = [level.transmittance_db < sweep.band.threshold_db for level in proven if level is not None]
        if below:
            counts.append(f"{sum(below)} of {len(below)} ({case})")
    if counts:
        print(f"proven: frequency ratios that the exact motion attenuates: {', '.join(counts)}", file=sys.stderr)


def check_folder(name: str, folder: Path, inputs: Sequence[Path | None]) -> None:
    """Raise a `ParameterError` unless every file of a report can be written into the folder, which is made.

    None of them may be one of `inputs`, the files that the report is made of.
    """
    checked_output_folder(name, folder)
    for file in FILES:
        checked_output_file("output file", folder / file, inputs)
    for used in inputs:
        if used is not None and used.resolve().parent == (folder / FIGURES).resolve():
            raise ParameterError(f"{used} lies among the figures that are written; allowed: a file outside {FIGURES}")
    checked_output_folder("figures", folder / FIGURES)


def _written(report: Report, folder: Path) -> Written:
    write_all(folder, files_of(report))
    return Written(folder / PAGE, report)


def check_loses_nothing(folder: Path, report: Report) -> None:
    """Refuse to overwrite a report that has results of a variant which this one has not."""
    points = report.result.points
    shown = Counter(str(point.variant) for point in points if point.result.status is not ResultStatus.MISSING)
    earlier = _results(folder / NETCDF)
    fewer = {variant: count for variant, count in earlier.items() if count > shown[variant]}
    if fewer:
        variant, count = max(fewer.items(), key=lambda item: item[1] - shown[item[0]])
        problem = f"{folder / PAGE} shows more than the store holds for this page: of {variant} {count} points"
        raise ParameterError(f"{problem} for {shown[variant]}; allowed: another --out, or without --no-run")


def _results(file: Path) -> Counter[str]:
    """Count the points with a result of each variant of a report; none where there is no report that can be read."""
    if not file.is_file():
        return Counter()
    try:
        data = read_dataset(file)
        present = data["status"] != STATUSES.index(ResultStatus.MISSING)
        counts = present.sum([name for name in present.dims if name != "variant"])
        return Counter(
            {str(name): int(count) for name, count in zip(data["variant"].values, counts.values, strict=True)}
        )
    except (ParameterError, KeyError):
        return Counter()
