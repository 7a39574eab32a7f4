"""Where the results of a page come from: planned runs, a sweep, stores alone, or a dataset."""

from collections.abc import Callable, Sequence
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

import pandas as pd

from multibody_xval.engines.interface.texts import checked_path
from multibody_xval.reports.page.drift import drift_runs
from multibody_xval.reports.page.files import check_folder, check_loses_nothing
from multibody_xval.reports.page.write import Written, write_dataset_page, write_page
from multibody_xval.scenarios import edges
from multibody_xval.scenarios.model import EXACT, REFERENCE, Case, Config
from multibody_xval.scenarios.report_plan import left_out, report_configs, report_runs
from multibody_xval.scenarios.result_tables import curve_of, steady_ones
from multibody_xval.scenarios.ruler.judge import judged
from multibody_xval.scenarios.running.evaluate import Means, computed, stored_results
from multibody_xval.scenarios.store import Stored, checked_store, existing_store
from reference_lcp.errors import ParameterError

if TYPE_CHECKING:
    from multibody_xval.scenarios.sweeps.plan import Sweep

STORE = "results.sqlite"
"""File of the results in the folder of a page, where no other is named."""

EDGES = ("band edges", edges.propose)
"""What follows the points of a plan."""


def planned_page(
    names: Sequence[str], folder: Path, command: str, means: Callable[[Path | None], Means], store: Path | None = None,
    *, quick: bool = False,
) -> Written:  # fmt: skip
    """Run what a report of engines needs, and write its page; `means` gives what computes, with the store."""
    configs = report_configs(names)
    own = _prepared(means, folder, store)
    stored = computed(report_runs(configs, quick=quick) + drift_runs(configs), own, then=[EDGES])
    named = partial(_is_of, configs) if names else None
    return write_page(stored, folder, command, left_out=left_out(configs, quick=quick), named=named)


def sweep_page(
    sweep: "Sweep", folder: Path, command: str, means: Callable[[Path | None], Means], store: Path | None = None,
    source: Path | None = None,
) -> Written:  # fmt: skip
    """Run a sweep with the reference, and both edges of its curves, and write its page; `source` is its file."""
    from multibody_xval.scenarios.sweeps.dataset import by_tolerance

    plan = sweep.with_config(REFERENCE)
    own = _prepared(means, folder, store, source)
    stored = computed(plan.runs(), own, then=[*plan.proposals, EDGES])
    named = partial(_is_of, [config for config in sweep.configs if config != REFERENCE])
    return write_page(
        stored, folder, command, named=named, judge=lambda table: by_tolerance(judged(table), sweep.tolerance_db)
    )


def stored_page(
    stores: Sequence[Path], folder: Path, command: str, names: Sequence[str] = (), sweep: "Sweep | None" = None
) -> Written:
    """Write the page of what stores hold, of engines and versions of any environment; of `names`, or of a sweep."""
    for store in stores:
        existing_store(store)
    stored = stored_results(*stores)
    if names:
        stored = _of_names(stored, names, stores)
    if sweep is not None:
        stored = _of_sweep(stored, sweep)
    if not stored:
        raise ParameterError(
            f"{_listed(stores)} holds no results for this page; allowed: a store of `sweep` or `report`"
        )
    check_folder(folder, stores)
    check_loses_nothing(folder, stored)
    return write_page(stored, folder, command)


def _of_names(stored: Sequence[Stored], names: Sequence[str], stores: Sequence[Path]) -> list[Stored]:
    """Give the results of named engines and configurations, and those of the ruler."""
    wanted = {REFERENCE, EXACT}
    for name in names:
        parsed = Config.parse(name)
        own = {row.run.config for row in stored if row.run.config == parsed or row.run.config.engine == name}
        if not own:
            held = ", ".join(sorted({row.run.config.engine for row in stored}))
            raise ParameterError(f"engine = {name} has no results in {_listed(stores)}; allowed: of {held}")
        wanted |= own
    return [row for row in stored if row.run.config in wanted]


def _of_sweep(stored: Sequence[Stored], sweep: "Sweep") -> list[Stored]:
    """Give the results on the curves of a sweep, and those of the ruler there."""
    configs = {*sweep.configs, REFERENCE, EXACT}
    curves = {place.case for place in sweep.places}
    own = (row for row in steady_ones(stored) if row.run.config in configs)
    return [row for row in own if curve_of(row.run.of(Case)) in curves]


def dataset_page(file: Path, folder: Path, command: str) -> Written:
    """Write the page of the file of a dataset; nothing is computed."""
    from multibody_xval.scenarios.sweeps.dataset import read_dataset

    data = read_dataset(file)
    check_folder(folder, [file])
    return write_dataset_page(data, folder, command)


def written_report(data: Any, folder: str | Path) -> Written:
    """Write the report of a dataset, of the file of one, of a sweep, or of a store; see `multibody_xval.report`."""
    import xarray as xr

    from multibody_xval.scenarios.sweeps.file import read_sweep

    folder = checked_path("folder", folder)
    if isinstance(data, xr.Dataset):
        check_folder(folder, [])
        return write_dataset_page(data, folder, "multibody_xval.report(data, folder)")
    if not isinstance(data, str | Path):
        kinds = "the dataset of a sweep, or the path of a .nc, .toml or .sqlite file"
        raise ParameterError(f"data is a {type(data).__name__}; allowed: {kinds}")
    file, command = checked_path("data", data), f"multibody_xval.report({str(data)!r}, folder)"
    if file.suffix == ".toml":
        return sweep_page(read_sweep(file), folder, command, lambda store: Means(store=store), source=file)
    if file.suffix == ".sqlite":
        return stored_page([file], folder, command)
    if file.suffix != ".nc":
        raise ParameterError(f"{file} has the ending {file.suffix!r}; allowed: .nc, .toml or .sqlite")
    return dataset_page(file, folder, command)


def _prepared(
    means: Callable[[Path | None], Means], folder: Path, store: Path | None, source: Path | None = None
) -> Means:
    """Give what computes, with the store of a page; refuse numbers, and files and folders that cannot be written."""
    own = means(store or folder / STORE)
    if store is not None:
        checked_store(store)
    check_folder(folder, [own.store, source])
    return own


def _is_of(configs: Sequence[Config], rows: pd.DataFrame) -> pd.Series:
    return rows.config.isin(configs)


def _listed(stores: Sequence[Path]) -> str:
    return ", ".join(map(str, stores))
