"""Sweeps that run: a first plan, then what points still need, until nothing is proposed; edges as a table."""

import pandas as pd
import xarray as xr

from multibody_xval.scenarios import edges
from multibody_xval.scenarios.dataset import by_tolerance, dataset, sweep_in
from multibody_xval.scenarios.evaluate import Means, computed
from multibody_xval.scenarios.judge import judged
from multibody_xval.scenarios.model import REFERENCE
from multibody_xval.scenarios.result_tables import is_reference, points
from multibody_xval.scenarios.sweep_plan import FREQUENCY, Sweep


def swept(sweep: Sweep, means: Means) -> xr.Dataset:
    """Run a sweep, and give its judged points as labelled arrays."""
    then = [("adaptive curves", sweep.propose)] if sweep.grid is not None else []
    table = judged(points(computed(sweep.runs(), means, then=then)))
    return dataset(sweep, by_tolerance(table, sweep.tolerance_db))


def edge_table(data: xr.Dataset, means: Means) -> pd.DataFrame:
    """Refine both edges of every curve of a dataset.

    Returns
    -------
    DataFrame
        A row an edge: the axes of the sweep that are varied, ``edge``, ``frequency_ratio`` and ``error_bar``; then,
        where there are other configurations than the reference, what is expected and allowed, and the verdict.
    """
    sweep = sweep_in(data)
    plan = sweep.with_config(REFERENCE)
    then = [("adaptive curves", plan.propose), ("band edges", edges.propose)]
    table = points(computed(plan.runs(), means, then=then))
    found = edges.judged_edges(table)
    found = found[found[["engine", "formulation", "preset"]].agg(tuple, axis=1).isin(_names(sweep))]
    axes = [name for name in sweep.axes if name not in (FREQUENCY, "steps_per_period")]
    own = found.assign(
        configuration=found[["engine", "formulation", "preset"]].agg(":".join, axis=1),
        error_bar=found.interpolation + found.exact_bar.where(is_reference(found), 0.0).fillna(0.0),
        **{name: [getattr(case, name) for case in found.curve] for name in axes},
    )
    names = [*axes, *(["steps"] if "steps_per_period" in sweep.axes else []), "edge", FREQUENCY, "error_bar"]
    if set(sweep.configs) - {REFERENCE}:
        return own[[*names, "configuration", "exact", "error", "expected", "allowed", "verdict"]]
    return own[names]


def _names(sweep: Sweep) -> list[tuple[str, str, str]]:
    """Give engine, formulation and preset of the configurations of a sweep."""
    return [(own.engine, str(own.formulation), own.preset_name) for own in sweep.configs]
