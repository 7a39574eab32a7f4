"""Sweeps: every combination of values of any parameters, by every variant."""

import itertools
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr

from engines.interface.variant import Variant
from reference_lcp.chain.simulation import FEWEST_STEPS_PER_PERIOD, MINIMUM_STEPS_PER_PERIOD
from reference_lcp.validation import ParameterError, checked_count, checked_scalar
from scenarios.execution.evaluator import Evaluator
from scenarios.execution.store import ResultStore
from scenarios.sweeps.summary import SweepSummary
from scenarios.tables import csv_text
from scenarios.tasks.parameters import ChainRatios, Excitation
from scenarios.tasks.result import ResultStatus
from scenarios.tasks.task import SteadyStateTask

CHAIN_AXES = ("cells", "mass_ratio", "stiffness_ratio", "damping_ratio", "inner_damping_ratio")
AXES = ("friction_ratio", "frequency_ratio", *CHAIN_AXES, "steps_per_period")
"""Everything that may be varied."""

_COUNTS = {"cells": 1, "steps_per_period": FEWEST_STEPS_PER_PERIOD}
_POSITIVE = ("frequency_ratio", "mass_ratio", "stiffness_ratio")

STATUSES = (
    ResultStatus.CONVERGED, ResultStatus.PERIOD_LIMIT, ResultStatus.DIVERGED, ResultStatus.BLOCKED,
    ResultStatus.MISSING,
)  # fmt: skip
"""How a point may have ended, by its number in exported files; missing: not answered so far."""


@dataclass(frozen=True)
class Sweep:
    """What is asked.

    Parameters
    ----------
    variants
        Who is asked, at least one.
    axes
        Values by parameter, one of `AXES` each, in the order of the dimensions; friction and frequency ratio
        must be among them.
    ratios
        The chain where it is not varied.
    steps_per_period
        Fewest steps a period where they are not varied.
    excitation
        What drives the chain.

    Raises
    ------
    ParameterError
        If a parameter is unknown, missing or outside its range, has no value or one twice.
    """

    variants: tuple[Variant, ...]
    axes: Mapping[str, tuple[float, ...]]
    ratios: ChainRatios = field(default_factory=ChainRatios)
    steps_per_period: int = MINIMUM_STEPS_PER_PERIOD
    excitation: Excitation = field(default_factory=Excitation)

    def __post_init__(self) -> None:
        if not self.variants:
            raise ParameterError("engines = [] names nobody; allowed: at least one")
        for name, values in self.axes.items():
            check_axis(name, values)
        for name in ("friction_ratio", "frequency_ratio"):
            if name not in self.axes:
                raise ParameterError(f"grid.{name} is missing; allowed: at least one value")

    @property
    def points(self) -> int:
        """Number of questions."""
        return len(self.variants) * int(np.prod([len(values) for values in self.axes.values()]))

    def questions(self) -> Iterator[SteadyStateTask]:
        """Every combination, the last axis fastest; variants are the slowest."""
        for variant in self.variants:
            for values in itertools.product(*self.axes.values()):
                yield self._question(variant, dict(zip(self.axes, values, strict=True)))

    def _question(self, variant: Variant, place: dict[str, Any]) -> SteadyStateTask:
        chain = {name: place[name] for name in CHAIN_AXES if name in place}
        return SteadyStateTask(
            variant=variant,
            friction_ratio=place["friction_ratio"],
            frequency_ratio=place["frequency_ratio"],
            ratios=replace(self.ratios, **chain),
            steps_per_period=place.get("steps_per_period", self.steps_per_period),
            excitation=self.excitation,
        )


def check_axis(name: str, values: tuple[float, ...]) -> None:
    """Raise a `ParameterError` unless these may be the values of an axis."""
    if name not in AXES:
        raise ParameterError(f"grid.{name} is unknown; allowed: {', '.join(AXES)}")
    if not values or len(set(values)) < len(values):
        raise ParameterError(f"grid.{name} = {list(values)}; allowed: at least one value, none of them twice")
    for value in values:
        if name in _COUNTS:
            checked_count(f"grid.{name}", int(value) if value == int(value) else value, _COUNTS[name])  # type: ignore[arg-type]
        else:
            checked_scalar(f"grid.{name}", value, "> 0" if name in _POSITIVE else ">= 0")


def run_sweep(sweep: Sweep, evaluator: Evaluator) -> SweepSummary:
    """Answer whatever the store does not know yet; every answer is on disk the moment it is there."""
    summary = SweepSummary()
    for question, outcome in evaluator.complete(sweep.questions()):
        summary.add(question.variant, outcome)
    return summary


def dataset(sweep: Sweep, store: ResultStore) -> xr.Dataset:
    """Give what the store knows of a sweep, labelled.

    Returns
    -------
    xarray.Dataset
        Dimensions ``variant`` and the axes of the sweep; ``transmittance`` [dB], ``residual`` [-], ``periods``,
        ``status`` (a number, see its attributes), ``stuck_fraction`` and ``creep`` [-], means and maxima over
        the contacts, and ``seconds``. Points that are not answered are NaN, with the status ``missing``.
    """
    sizes = (len(sweep.variants), *(len(values) for values in sweep.axes.values()))
    columns = {name: np.full(sweep.points, np.nan) for name in _COLUMNS}
    status = np.full(sweep.points, STATUSES.index(ResultStatus.MISSING), dtype=np.int8)
    for index, answer in enumerate(store.results(sweep.questions())):
        if answer is None:
            continue
        status[index] = STATUSES.index(answer.status)
        for name, (read, _) in _COLUMNS.items():
            columns[name][index] = read(answer)
    dimensions = ("variant", *sweep.axes)
    variables: dict[str, Any] = {
        name: (dimensions, columns[name].reshape(sizes), attributes) for name, (_, attributes) in _COLUMNS.items()
    }
    meaning = {"flag_values": list(range(len(STATUSES))), "flag_meanings": ", ".join(STATUSES)}
    variables["status"] = (dimensions, status.reshape(sizes), meaning)
    names = [str(variant) for variant in sweep.variants]
    return xr.Dataset(variables, coords={"variant": names, **{k: list(v) for k, v in sweep.axes.items()}})


def _mean(values: tuple[float, ...]) -> float:
    return float(np.mean(values)) if values else np.nan


def _largest(values: tuple[float, ...]) -> float:
    return max(values, default=np.nan)


_COLUMNS: dict[str, tuple[Any, dict[str, str]]] = {
    "transmittance": (lambda answer: answer.transmittance_db, {"units": "dB", "long_name": "20 log10 |U_n| / U0"}),
    "residual": (lambda answer: answer.residual, {"units": "1", "long_name": "periodicity residual"}),
    "periods": (lambda answer: answer.periods, {"units": "1", "long_name": "periods simulated"}),
    "stuck_fraction": (lambda answer: _mean(answer.stuck_fraction), {"units": "1", "long_name": "mean stuck fraction"}),
    "creep": (lambda answer: _largest(answer.creep), {"units": "1", "long_name": "largest creep over ω U0"}),
    "seconds": (lambda answer: answer.seconds, {"units": "s", "long_name": "wall-clock time"}),
}


def write_dataset(found: xr.Dataset, file: Path) -> None:
    """Write labelled results as NetCDF (``.nc``) or as a table (``.csv``), one point a line."""
    if file.suffix == ".nc":
        found.to_netcdf(file, engine="h5netcdf")
        return
    table = found.to_dataframe(dim_order=list(found.status.dims)).reset_index()
    file.write_text(csv_text(table), encoding="utf-8")
