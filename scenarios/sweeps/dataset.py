"""A sweep as labelled arrays with units, options, versions, and the sweep itself."""

import itertools
import json
import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from importlib.metadata import version
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr
from pydantic import ConfigDict, Field, TypeAdapter

from multibody_xval.engines.interface.presets import OfStep
from multibody_xval.engines.interface.registry import engine
from multibody_xval.engines.interface.variant import Variant
from multibody_xval.scenarios.runs.result import Result, ResultStatus
from multibody_xval.scenarios.sweeps.point import Point, own_error_db
from multibody_xval.scenarios.sweeps.sweep import Sweep
from multibody_xval.scenarios.tables import csv_text
from multibody_xval.scenarios.verdicts.finding import PHASE, TRANSMITTANCE, Metric, Prediction, Verdict
from reference_lcp.defaults import FRICTION_COEFFICIENT
from reference_lcp.observables.stick_slip import Mode
from reference_lcp.output import write_whole
from reference_lcp.validation import FloatArray

DISTRIBUTION = "multibody-xval"

STATUSES = (
    ResultStatus.CONVERGED, ResultStatus.PERIOD_LIMIT, ResultStatus.DIVERGED, ResultStatus.BLOCKED,
    ResultStatus.MISSING,
)  # fmt: skip
"""How a point may have ended, by its number in datasets; missing: not evaluated so far."""

VERDICTS = tuple(Verdict)
MODES = tuple(Mode)
CERTIFIED = ("not certified", "certified")

PREDICTED = ((TRANSMITTANCE, "db", "dB"), (PHASE, "phase", "degree"))
"""Metrics that laws predict, with the end of the names of their variables, and their unit there."""

SWEEP = TypeAdapter(Sweep)
"""Reads and writes a sweep as JSON."""


@dataclass(frozen=True)
class StoredPoint:
    """What is known of a point, its findings but for what judging it again gives."""

    __pydantic_config__ = ConfigDict(extra="forbid", ser_json_inf_nan="constants")

    result: Result
    others: tuple[Result, ...] = ()
    predictions: Mapping[str, Prediction] = field(default_factory=dict)
    """What the law of the variant says, by the name of the metric."""
    modelled: bool = Field(default=False, exclude_if=lambda modelled: not modelled)
    """Whether the others are those of its model."""


STORED_POINT = TypeAdapter(StoredPoint)
"""Reads and writes a point as JSON."""


def stored_text(point: Point) -> str:
    """Give a point as JSON."""
    predictions = {own.metric.name: own.prediction for own in point.findings if own.prediction is not None}
    return STORED_POINT.dump_json(StoredPoint(point.result, point.others, predictions, point.modelled)).decode()


_AXES = {
    "friction_ratio": "friction bound over k_c U0, μ λ_N / (k_c U0)",
    "frequency_ratio": "ω / ω_r",
    "cells": "number of cells",
    "mass_ratio": "inner over outer mass",
    "stiffness_ratio": "inner over chain stiffness",
    "damping_ratio": "c_c / (2 sqrt(k_c m_o))",
    "inner_damping_ratio": "c_i / (2 sqrt(k_i m_i))",
    "steps_per_period": "fewest steps a period",
}

_FIXED = {
    **_AXES,
    "outer_mass_ratio": "outer masses over the unit of mass",
    "chain_stiffness_ratio": "chain stiffnesses over their unit",
    "friction_profile": "friction bounds over that of friction_ratio",
    "drive_amplitude": "of the base U0 [m], or of the force P0 [N]",
}
"""Attributes of what is not varied."""


def _mean(values: Sequence[float]) -> float:
    return float(np.mean(values)) if values else math.nan


def _of_law(name: str, *metrics: Metric) -> Callable[[Point], float]:
    """Give what reads a number of the prediction of one of these metrics; NaN where the law was not asked."""
    return lambda point: float(getattr(point.prediction(*metrics), name, math.nan))


_METRICS = tuple(metric for metric, _, _ in PREDICTED)


_NUMBERS: dict[str, tuple[Callable[[Point], float], str, str]] = {
    "transmittance_db": (lambda point: point.result.transmittance_db, "dB", "20 log10 |U_n| / U0"),
    "phase": (lambda point: point.result.phase, "rad", "by which the last outer mass is ahead of the drive's sine"),
    "difference_db": (
        lambda point: point.difference(TRANSMITTANCE), "dB", "transmittance less that of the baseline",
    ),
    "allowed_db": (
        lambda point: point.allowed(TRANSMITTANCE), "dB", "largest such difference that counts as agreement",
    ),
    "difference_phase": (lambda point: point.difference(PHASE), "degree", "phase less that of the baseline"),
    "allowed_phase": (
        lambda point: point.allowed(PHASE), "degree", "largest such difference that counts as agreement",
    ),
    "residual": (lambda point: point.result.residual, "1", "periodicity residual"),
    "amplification": (
        lambda point: point.result.amplification, "1", "how many residuals the reference may be from its steady state"
    ),
    "periods": (lambda point: point.result.periods, "1", "periods simulated"),
    "multiple": (lambda point: point.result.multiple, "1", "periods of the drive after which the motion repeats"),
    "steps_per_period": (lambda point: point.result.steps_per_period, "1", "steps a period that were taken"),
    "period": (lambda point: point.result.period, "s", "period of the drive"),
    "mean_stuck_fraction": (
        lambda point: _mean(point.result.stuck_fraction), "1", "part of the period that a contact sticks, mean",
    ),
    "creep": (
        lambda point: max(point.result.creep, default=math.nan), "1", "largest slip velocity within a stick over ω U0",
    ),
    "seconds": (lambda point: point.result.seconds, "s", "wall-clock time of a point"),
    **{
        f"law_{name}_{ending}": (_of_law(field, metric), units, text)
        for metric, ending, units in PREDICTED
        for name, field, text in (
            ("value", "value", "of the law of the variant, where this deviates"),
            ("left", "difference", "variant less its law"),
            ("allowed", "allowed", "largest difference from its law that both leave open"),
        )
    },
    "law_distance": (_of_law("distance", *_METRICS), "1", "positions of variant and law after a period, over U0"),
    "law_period_bound": (_of_law("period_bound", *_METRICS), "1", "largest such distance that the law allows"),
}  # fmt: skip

_BESIDE = {
    "transmittance_db": "step_error_db status",
    "phase": "status",
    "difference_db": "allowed_db verdict",
    "difference_phase": "allowed_phase verdict",
}
"""Variables that say how good another one is, by the CF conventions."""

NO_POINT = -1
"""Verdict where the sweep has no point."""


def sweep_dataset(sweep: Sweep, points: Sequence[Point], store: Path | None = None) -> xr.Dataset:
    """Give judged points as labelled arrays.

    Parameters
    ----------
    sweep
        The sweep; its frequency ratios are those of the points.
    points
        Of some or all of its places.
    store
        File of the results; its name becomes an attribute.

    Returns
    -------
    xarray.Dataset
        Dimensions ``variant`` and the axes of the sweep. ``transmittance_db`` [dB] and its estimated error where other
        numbers of steps give it, ``phase`` [rad], ``difference_db`` and ``difference_phase`` from the baseline; where
        a variant with a law deviates, what the law says: ``law_value_db``, ``law_left_db`` (variant less law) and
        ``law_allowed_db``, the same of the phase, and ``law_distance`` after a period; ``status`` and ``verdict``
        (numbers, see their attributes; a verdict of −1 where the sweep has no point), ``reason``, ``residual``,
        ``periods``, ``multiple``, ``steps_per_period``, ``period`` [s], ``stuck_fraction`` of each contact along
        ``cell`` and its mean, ``creep``, ``seconds``; changes of mode along ``transition``. ``stored`` has everything
        that is known of a point, as JSON: reports are made of it. NaN where there is no number; points that are not
        evaluated have the status ``missing``. Attributes: the fixed ratios, the drive, versions and options of every
        variant, and the sweep as JSON.
    """
    index = {point: number for number, point in enumerate(sweep.grid_points())}
    numbers = [index[point.place] for point in points]
    errors = np.array(list(map(own_error_db, points)))
    arrays = {
        "step_error_db": ((), errors, {"units": "dB", "long_name": "error of the step, from other steps"}),
        **_of_points(points),
        **_of_contacts(points),
        "stored": ((), np.array(list(map(stored_text, points)), dtype=object), {"long_name": "the point, as JSON"}),
    }
    grid = ("variant", *sweep.axes)
    sizes = tuple(len(values) for values in (sweep.variants, *sweep.axes.values()))
    cells = arrays["stuck_fraction"][1].shape[1]
    variables = {
        name: (
            (*grid, *more),
            _on_grid(values, numbers, sizes, _ABSENT.get(name, math.nan)),
            attributes | ({"ancillary_variables": _BESIDE[name]} if name in _BESIDE else {}),
        )
        for name, (more, values, attributes) in arrays.items()
    }
    return xr.Dataset(variables, coords=_coordinates(sweep, cells), attrs=_attributes(sweep, store))


_ABSENT = {"status": STATUSES.index(ResultStatus.MISSING), "verdict": NO_POINT, "reason": "", "stored": ""}
"""Where the sweep has no point; NaN in all other variables."""


def _on_grid(values: np.ndarray[Any, Any], numbers: Sequence[int], sizes: tuple[int, ...], absent: object) -> Any:
    """Put values with one row a point, those with these numbers, on the whole grid."""
    whole = np.full((math.prod(sizes), *values.shape[1:]), absent, dtype=values.dtype)
    whole[numbers] = values
    return whole.reshape(*sizes, *values.shape[1:])


Arrays = dict[str, tuple[tuple[str, ...], np.ndarray[Any, Any], dict[str, Any]]]
"""Dimensions beside the grid, values with one row a point, and attributes by name."""


def _of_points(points: Sequence[Point]) -> Arrays:
    """Give what is one number or one text a point."""
    arrays: Arrays = {
        name: ((), np.array([read(point) for point in points], dtype=np.float64), {"units": units, "long_name": text})
        for name, (read, units, text) in _NUMBERS.items()
    }
    statuses = [point.result.status for point in points]
    verdicts = [point.comparison.verdict for point in points]
    reasons = [point.result.reason for point in points]
    certified = np.array([_of_law("certified", *_METRICS)(point) for point in points], dtype=np.float64)
    arrays["law_certified"] = ((), certified, _meaning(CERTIFIED, "steady state of the law", np.float64))
    arrays["status"] = ((), _numbers(statuses, STATUSES), _meaning(STATUSES, "how the search for a steady state ended"))
    meaning = _meaning(VERDICTS, "comparison with the baseline")
    meaning["flag_values"] = np.append(meaning["flag_values"], np.int8(NO_POINT))
    meaning["flag_meanings"] += " no_point"
    arrays["verdict"] = ((), _numbers(verdicts, VERDICTS), meaning)
    arrays["reason"] = ((), np.array(reasons, dtype=object), {"long_name": "why there is no result"})
    return arrays


def _of_contacts(points: Sequence[Point]) -> Arrays:
    """Give stuck fractions by cell, and changes of mode by number; there are as many as the longest point has."""
    stuck = _padded([point.result.stuck_fraction for point in points])
    cells, times, modes = (
        _padded([tuple(read(change) for change in point.result.transitions) for point in points])
        for read in (lambda c: float(c[0]), lambda c: c[1], lambda c: float(MODES.index(Mode(c[2]))))
    )
    return {
        "stuck_fraction": (("cell",), stuck, {"units": "1", "long_name": "part of the period that a contact sticks"}),
        "transition_cell": (("transition",), cells, {"units": "1", "long_name": "cell of a change of mode, from 1"}),
        "transition_time": (("transition",), times, {"units": "s", "long_name": "time of a change of mode"}),
        "transition_mode": (("transition",), modes, _meaning(MODES, "mode that a change begins", np.float64)),
    }


def _padded(rows: Sequence[Sequence[float]]) -> FloatArray:
    """Give rows of unequal lengths as one array, with NaN at their ends."""
    return np.array(list(itertools.zip_longest(*rows, fillvalue=math.nan)), dtype=np.float64).reshape(-1, len(rows)).T


def _numbers(values: Sequence[str], every: Sequence[str]) -> Any:
    return np.array([every.index(value) for value in values], dtype=np.int8)


def _meaning(every: Sequence[str], text: str, kind: type = np.int8) -> dict[str, Any]:
    """Give the attributes of a variable of numbered values, by the CF conventions."""
    meanings = " ".join(str(member).replace(" ", "_") for member in every)
    return {"long_name": text, "flag_values": np.arange(len(every), dtype=kind), "flag_meanings": meanings}


def _coordinates(sweep: Sweep, cells: int) -> dict[str, Any]:
    axes = {name: (name, list(values), {"units": "1", "long_name": _AXES[name]}) for name, values in sweep.axes.items()}
    names = [str(variant) for variant in sweep.variants]
    variant = ("variant", names, {"long_name": "engine, formulation and preset; joint and tuned are left out"})
    parts = {
        name: ("variant", [read(variant) for variant in sweep.variants], {"long_name": text})
        for name, (read, text) in _PARTS.items()
    }
    cell = ("cell", np.arange(1, cells + 1), {"units": "1", "long_name": "cell, from the base on"})
    return {"variant": variant, **parts, "cell": cell, **axes}


def _version(variant: Variant) -> str:
    """Give the version of the engine as it is on this machine; empty where it is not installed."""
    own = engine(variant.engine)
    return own.version() if own.unavailable_reason() is None else ""


_PARTS: dict[str, tuple[Callable[[Variant], str], str]] = {
    "engine": (lambda variant: variant.engine, "engine of the variant"),
    "formulation": (lambda variant: str(variant.formulation), "formulation of friction"),
    "preset": (lambda variant: variant.preset_name, "preset of options"),
    "version": (_version, "version of the engine"),
}
"""What a variant consists of."""


def _attributes(sweep: Sweep, store: Path | None) -> dict[str, Any]:
    """Give everything that a reader of the numbers needs to know, and the sweep itself."""
    ratios = {name: value for name, value in vars(sweep.ratios).items() if name not in sweep.axes}
    if sweep.ratios.friction_coefficient == FRICTION_COEFFICIENT:
        del ratios["friction_coefficient"]  # only a part of what friction_ratio says
    steps = {} if "steps_per_period" in sweep.axes else {"steps_per_period": sweep.steps_per_period}
    tolerance = {} if sweep.tolerance is None else {
        "tolerance_db": sweep.tolerance.transmittance_db, "baseline": str(sweep.tolerance.baseline),
    }  # fmt: skip
    return {
        "Conventions": "CF-1.11",
        "title": "Steady states of a frictional mass-in-mass chain",
        "source": f"{DISTRIBUTION} {version(DISTRIBUTION)}",
        "comment": "; ".join(f"{name}: {text}" for name, text in _FIXED.items() if name not in sweep.axes),
        **{name: list(value) if isinstance(value, tuple) else value for name, value in ratios.items()},
        **steps,
        "drive_kind": sweep.excitation.kind,
        "drive_amplitude": sweep.excitation.amplitude,
        "drive_amplitude_units": "m" if sweep.excitation.kind == "base" else "N",
        **tolerance,
        **({} if store is None else {"store": store.name}),
        "variants": json.dumps(
            {str(variant): description_of(variant) for variant in sweep.variants}, ensure_ascii=False, default=repr
        ),
        "sweep": SWEEP.dump_json(sweep).decode(),
    }


def description_of(variant: Variant) -> dict[str, Any]:
    """Give version, preset and options of a variant, as they are on this machine."""
    of, preset = engine(variant.engine), variant.preset
    return {
        "package": of.capabilities.package,
        "version": of.version() if of.unavailable_reason() is None else None,
        "description": variant.description,
        "options": [
            {"name": name, "value": _plain(option.value), "default": option.default, "reason": option.reason}
            for name, option in preset.engine_options.items()
        ],
    }


def _plain(value: Any) -> Any:
    """Give the value of an option without its formula: the text of one that depends on the time step."""
    return value.text if isinstance(value, OfStep) else value


def write_dataset(data: xr.Dataset, file: Path) -> None:
    """Write labelled results as NetCDF (``.nc``) or as a table (``.csv``), one point a line.

    In the table, status and verdict are words; the verdict is empty where the sweep has no point.
    """
    if file.suffix == ".nc":
        # in memory: HDF5 ends the process on a full disk
        write_whole(file, bytes(data.to_netcdf(engine="h5netcdf")))
        return
    grid = data.status.dims
    columns = [name for name, values in data.data_vars.items() if values.dims == grid and name != "stored"]
    plain = data[columns].reset_coords(drop=True)
    table = plain.to_dataframe(dim_order=list(grid)).reset_index()
    table["status"] = [str(STATUSES[number]) for number in table["status"]]
    table["verdict"] = ["" if number < 0 else str(VERDICTS[number]) for number in table["verdict"]]
    write_whole(file, csv_text(table))
