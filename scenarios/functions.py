"""The functions of a notebook: `sweep` gives labelled arrays, `check` a table of judged numbers.

They do what the commands ``sweep`` and ``run`` do: every result is kept in the store the moment it is there, engines
run in worker processes, and progress is shown on standard error.
"""

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
import xarray as xr

from multibody_xval.engines.interface.registry import default_engine_names
from multibody_xval.scenarios.catalogue.asking import answers, named_scenarios
from multibody_xval.scenarios.compute import SECONDS_A_RUN
from multibody_xval.scenarios.running.evaluate import Means
from multibody_xval.scenarios.store import checked_store
from multibody_xval.scenarios.sweeps.file import sweep_of
from multibody_xval.scenarios.sweeps.plan import check_size
from multibody_xval.scenarios.sweeps.swept import swept
from reference_lcp.defaults import MINIMUM_STEPS_PER_PERIOD
from reference_lcp.errors import ParameterError, shown
from reference_lcp.validation import FloatArray

Numbers = float | Sequence[float] | FloatArray
"""One number, or several: a list, a tuple or an array."""

AxisValues = float | list[float] | FloatArray | tuple[float, float, int] | Mapping[str, float]
"""Values of an axis: numbers, (first, last, how many), or what a sweep file takes: first, last, accuracy_db."""


def sweep(
    engines: str | Sequence[str],
    friction_ratio: AxisValues,
    frequency_ratio: AxisValues,
    *,
    vary: Mapping[str, AxisValues] | None = None,
    chain: Mapping[str, Numbers] | None = None,
    drive: str = "base",
    amplitude: float | None = None,
    steps_per_period: int = MINIMUM_STEPS_PER_PERIOD,
    tolerance_db: float | None = None,
    store: str | Path | None = None,
    workers: int | None = None,
    time_limit: float = SECONDS_A_RUN,
    scheduler: str | None = None,
    retry_failed: bool = False,
    yes: bool = False,
    **unknown: object,
) -> xr.Dataset:
    """Simulate every combination of values by every engine, and give the steady states as labelled arrays.

    Parameters
    ----------
    engines
        Names ``ENGINE[:FORMULATION[:PRESET]][:OPTION=VALUE]``, or ``all``.
    friction_ratio, frequency_ratio
        μ λ_N / (k_c U0) >= 0 and η_r = ω / ω_r > 0: a number, a list or array of them, or a tuple (first, last, how
        many). η_r may be an adaptive grid: ``{"first": 0.3, "last": 1.6, "accuracy_db": 0.5}``.
    vary, chain
        Other axes by name, such as ``{"mass_ratio": [0.5, 1, 2]}``; what is not varied, as in `Chain.from_ratios`.
    drive, amplitude
        ``"base"`` with U0 [m], or ``"force"`` on the outer mass of cell 1 with P0 [N].
    steps_per_period, tolerance_db
        Fewest steps per period; the largest error that counts as agreement [dB], without it what the time step and the
        accuracy of an engine explain.
    store, workers, time_limit, scheduler, retry_failed, yes
        As the options of ``multibody-xval sweep``; without a store, no result is kept.

    Returns
    -------
    xarray.Dataset
        Dimensions ``configuration`` and the axes. Among its variables: ``transmittance_db``, ``exact_db`` and
        ``error_db``, ``phase_deg``, ``verdict``, ``status``, ``reason``, ``stuck_fraction`` by ``cell``. `plot`,
        `band_edges` and `report` take it, or a part of it by ``data.sel(...)``.

    Raises
    ------
    ParameterError
        If something is outside its range.
    """
    for name in unknown:
        raise ParameterError(
            f"sweep has no argument {name!r}; allowed: in chain={{{name!r}: ...}}, or in vary to vary it"
        )
    for name, given in {"vary": vary, "chain": chain}.items():
        if given is not None and not isinstance(given, Mapping):
            raise ParameterError(f"{name} = {shown(given)}; allowed: values by name")
    axes = {"friction_ratio": friction_ratio, "frequency_ratio": frequency_ratio, **(vary or {})}
    content = {
        "engines": _names(engines), "steps_per_period": steps_per_period,
        "grid": {name: _axis(name, values) for name, values in axes.items()},
        "chain": {name: _numbers(value) for name, value in (chain or {}).items()},
        "drive": {"kind": drive, **({} if amplitude is None else {"amplitude": amplitude})},
        **({} if tolerance_db is None else {"tolerances": {"transmittance_db": tolerance_db}}),
    }  # fmt: skip
    planned = sweep_of(content)
    check_size(planned, yes=yes, how="yes=True")
    file = None if store is None else checked_store(store)
    return swept(
        planned,
        Means(store=file, workers=workers, scheduler=scheduler, seconds_a_run=time_limit, retry_failed=retry_failed),
    )


def check(
    scenario: str | Sequence[str],
    engines: str | Sequence[str] | None = None,
    *,
    store: str | Path | None = None,
    workers: int | None = None,
    time_limit: float = SECONDS_A_RUN,
    scheduler: str | None = None,
    retry_failed: bool = False,
) -> pd.DataFrame:
    """Run a scenario of the catalogue and judge every number of every engine.

    Parameters
    ----------
    scenario
        Its name, see ``multibody-xval run``, several names, or ``"all"``.
    engines
        Names as for `sweep`; those that come with the suite without it.
    store, workers, time_limit, scheduler, retry_failed
        As the options of ``multibody-xval run``.

    Returns
    -------
    pandas.DataFrame
        One row a run and quantity: ``scenario``, ``case``, ``configuration``, ``engine``, ``formulation``, ``preset``,
        ``version``, ``steps``, ``quantity`` and ``unit``; ``value`` beside ``exact`` and ``reference`` at equal steps,
        of which ``expected`` says which one counts; ``error`` to the exact value; ``distance`` from what is expected
        and ``allowed``, with the parts of that; ``verdict``, and whether the configuration is ``judged``; ``reason``
        where there is no number. Transmittances are complex.

    Raises
    ------
    ParameterError
        If a name is unknown or a number is outside its range.
    """
    scenarios = named_scenarios(_names(scenario, "scenario"))
    names = _names(default_engine_names() if engines is None else engines)
    means = Means(
        store=None if store is None else checked_store(store), workers=workers, scheduler=scheduler,
        seconds_a_run=time_limit, retry_failed=retry_failed,
    )  # fmt: skip
    return answers(scenarios, names, means)


def _names(given: str | Sequence[str], what: str = "engines") -> list[str]:
    """Give the names, also where there is only one."""
    names = [given] if isinstance(given, str) else given
    if not isinstance(names, Sequence) or not names or not all(isinstance(name, str) for name in names):
        raise ParameterError(f"{what} = {shown(given)}; allowed: a name, or a list of names")
    return list(names)


def _axis(name: str, values: Any) -> Any:
    """Give the values of an axis as a sweep file has them."""
    if isinstance(values, Mapping):
        return dict(values)
    if isinstance(values, tuple):
        if len(values) != 3 or not isinstance(values[2], int | np.integer):
            ways = f"{list(values)} for these values, or (first, last, how many), the last one whole"
            raise ParameterError(f"{name} = {shown(values)} is a tuple; allowed: {ways}")
        return {"first": values[0], "last": values[1], "points": int(values[2])}
    try:
        return np.atleast_1d(np.asarray(values, dtype=float)).tolist()
    except (TypeError, ValueError, OverflowError):
        return values  # the check of the sweep names it


def _numbers(value: Any) -> Any:
    """Give arrays and tuples as lists."""
    return value.tolist() if isinstance(value, np.ndarray) else list(value) if isinstance(value, tuple) else value
