"""From a dataset, the file of a sweep, a store, or a sweep itself, to the folder of a report."""

from collections.abc import Sequence
from contextlib import ExitStack
from pathlib import Path
from typing import NamedTuple

import xarray as xr

from reference_lcp.console import checked_output_file, checked_output_folder
from reference_lcp.refusal import ParameterError, checked_path
from reports.data.collect import Scope, collect, collect_dataset, expected_tasks
from reports.data.report import Report
from reports.drawing.drawn import DrawnFigures
from reports.export.earlier import check_loses_nothing
from reports.export.files import FILES, PAGE, cards_beside, files_of, write_all
from reports.page.render import FIGURES
from scenarios.execution.evaluator import StoredResults
from scenarios.execution.executor import Executor
from scenarios.execution.limits import TIME_LIMIT
from scenarios.execution.progress import CountingEvaluator, ProgressBars
from scenarios.execution.storage.store import ResultStore
from scenarios.execution.workers.dask_cluster import executor_for
from scenarios.sweeps.dataset_file import read_dataset
from scenarios.sweeps.noted import note_sweep, noted_sweeps
from scenarios.sweeps.size import check_size
from scenarios.sweeps.spec_file import read_sweep
from scenarios.sweeps.sweep import Sweep
from scenarios.verdicts.finding import Finding

STORE = "results.sqlite"
"""File of the results in the folder of a report, where no other is named."""


class Written(NamedTuple):
    """The page of a report, what its comparison came to, and why it fails, a line each."""

    page: Path
    findings: Sequence[Finding]
    failures: list[str]


def write_report(data: xr.Dataset | str | Path, folder: str | Path) -> Written:
    """Write the report of a dataset, of the file of a sweep, or of a store; see `reports.report`."""
    folder = checked_path("folder", folder)
    if isinstance(data, xr.Dataset):
        return write_dataset_report(data, folder, "reports.report(data, folder)")
    file, command = checked_path("data", data), f"reports.report({str(data)!r}, folder)"
    if file.suffix == ".toml":
        planned = read_sweep(file).with_reference()
        check_size(planned)
        return write_sweep_report(planned, folder, command)
    if file.suffix == ".sqlite":
        return write_sweep_report(noted_sweeps(file).sweep.with_reference(), folder, command, store=file, ask=False)
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
    ask: bool = True,
    scope: Scope | None = None,
    executor: Executor | None = None,
    retry_blocked: bool = False,
) -> Written:
    """Write the report of a sweep, in which the reference takes part.

    Parameters
    ----------
    sweep
        The sweep, see `Sweep.with_reference`.
    folder
        Where it is written; made if it is missing.
    command
        Command or call that gives the same numbers, for the page.
    store
        File of the results; without it, `STORE` in the folder.
    ask
        Whether what the store lacks is computed; if not, a page that shows more is not overwritten.
    scope
        The parts of the report beside the grid.
    executor
        Runs the tasks; processes on this machine without it.
    retry_blocked
        Whether points are run again at which their engine has failed before.
    """
    chosen = scope or Scope()
    executor = executor or executor_for(None, TIME_LIMIT, None)
    file = store or folder / STORE
    check_folder("folder", folder, [file])
    with ExitStack() as stack:
        stored = stack.enter_context(ResultStore(file))
        if not ask:
            shown = collect(sweep, stored, StoredResults(stored), command, scope=chosen)
            check_loses_nothing(folder, shown)
            return _written(shown, folder)
        note_sweep(stored, sweep)
        bars = stack.enter_context(ProgressBars(sweep.variants))
        expected = expected_tasks(sweep, chosen)
        evaluator = stack.enter_context(
            CountingEvaluator(stored, executor, expected, bars, retry_blocked=retry_blocked)
        )
        report = collect(sweep, stored, evaluator, command, scope=chosen)
    return _written(report, folder)


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
    write_all(folder, files_of(report, DrawnFigures(folder / FIGURES), cards_beside(folder)))
    return Written(folder / PAGE, report.result.findings, report.failures)
