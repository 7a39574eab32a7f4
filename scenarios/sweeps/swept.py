"""Sweeps that run: a first plan, then what points still need, until nothing is proposed; or out of a store alone."""

from pathlib import Path

import pandas as pd
import xarray as xr

from multibody_xval.scenarios.model import Run
from multibody_xval.scenarios.result_tables import points
from multibody_xval.scenarios.ruler.judge import judged
from multibody_xval.scenarios.running.evaluate import Means, computed, newest, stored_results
from multibody_xval.scenarios.store import Stored
from multibody_xval.scenarios.sweeps.dataset import by_tolerance, dataset
from multibody_xval.scenarios.sweeps.plan import Sweep


def swept(sweep: Sweep, means: Means) -> xr.Dataset:
    """Run a sweep, and give its judged points as labelled arrays."""
    return _judged(sweep, points(computed(sweep.runs(), means, then=sweep.proposals)))


def stored_sweep(sweep: Sweep, store: Path) -> xr.Dataset:
    """Give what a store holds of a sweep as labelled arrays; nothing is run.

    Where it holds several versions of an engine, those of the installed one are given, or else the last.
    """
    kept = newest(stored_results(store))
    found: dict[Run, Stored] = {}
    new = sweep.runs()
    while new := [run for run in new if run in kept and run not in found]:
        found |= {run: kept[run] for run in new}
        new = sweep.runs(points(found.values()))
    return _judged(sweep, points(found.values()))


def _judged(sweep: Sweep, table: pd.DataFrame) -> xr.Dataset:
    return dataset(sweep, by_tolerance(judged(table), sweep.tolerance_db))
