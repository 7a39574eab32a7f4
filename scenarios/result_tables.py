"""Tables of results: one row a run, plain columns."""

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import replace
from functools import cache, lru_cache
from typing import Any

import numpy as np
import pandas as pd

from multibody_xval.engines.interface.tolerances import CREEP, TRAJECTORY_TOLERANCE
from multibody_xval.scenarios.model import CASE, EXACT, REFERENCE, Case, Config, Result, Run, Status, amplitude_of
from multibody_xval.scenarios.store import Stored, identity

CONFIG = ["engine", "formulation", "preset"]
"""Columns that say what configuration a row belongs to."""

CURVE = [*CONFIG, "version", "curve", "steps"]
"""Columns that rows of one curve over the frequency ratio share; `curve` is the case without its frequency ratio."""


CLOSED = 1.0
"""Modulation up to which contacts stay closed."""


def now(results: Mapping[Run, Result]) -> list[Stored]:
    """Give results with the versions of the engines of this environment."""
    return [Stored(run, identity(run.config)[0], result) for run, result in results.items()]


def points(stored: Iterable[Stored]) -> pd.DataFrame:
    """Give one row a run of a steady state: configuration, case, numbers, and what of it its judgement needs.

    Columns: those of `CONFIG` and `model.CASE`, ``version``, ``case`` and ``curve`` (`Case` objects), ``steps`` per
    period, ``status``, ``transmittance_db``, ``phase_deg``, ``ratio`` (complex), ``residual``, ``amplification``,
    ``periods``, ``multiple``, ``stuck`` (tuple, a part of the period a cell), ``transitions`` (their number),
    ``stick_velocity`` over ω U0, ``seconds`` of a processor, ``reason``.
    """
    return pd.DataFrame([_point(*row) for row in steady_ones(stored)], columns=_COLUMNS).astype(_TYPES)


def steady_ones(stored: Iterable[Stored]) -> Iterator[Stored]:
    """Give the results of steady states: stores also hold those of motions and scenes."""
    return (row for row in stored if isinstance(row.run.case, Case))


def _point(run: Run, version: str, result: Result) -> dict[str, Any]:
    ratio = result.transmittance if result.status is Status.PERIODIC else complex(np.nan, np.nan)
    return {
        **described(run.config, run.of(Case)), "version": version, "steps": run.steps,
        "status": str(result.status), "transmittance_db": result.level_db, "phase_deg": result.phase_deg,
        "ratio": ratio, "residual": result.residual, "amplification": result.amplification,
        "periods": result.periods, "multiple": result.multiple, "stuck": result.stuck,
        "transitions": len(result.transitions), "stick_velocity": result.stick_velocity,
        "seconds": result.seconds, "reason": result.reason,
    }  # fmt: skip


def described(config: Config, case: Case) -> dict[str, Any]:
    """Give what a row says of its configuration and its case."""
    return {
        **names_of(config), **{name: getattr(case, name) for name in CASE}, "case": case, "curve": curve_of(case),
        **of_config(config, swings=bool(case.modulation), opens=case.modulation > CLOSED),
    }  # fmt: skip


def names_of(config: Config) -> dict[str, str]:
    """Give the columns that name a configuration."""
    return {
        "configuration": full_name(config), "engine": config.engine, "formulation": str(config.formulation),
        "preset": config.preset_name,
    }  # fmt: skip


def full_name(config: Config) -> str:
    """Give engine, formulation, preset and changed options of a configuration, none left out."""
    return ":".join([config.engine, config.formulation, config.preset_name])


@cache
def of_config(config: Config, *, swings: bool, opens: bool = False) -> dict[str, Any]:
    """Give what of a configuration decides how its numbers are compared, also where the normal force swings.

    Where contacts open, no preset shares the scheme, and none is judged: engines let a contact land in one step or in
    several, each in its own way, and what follows of the motion amplifies that.
    """
    preset, able = config.preset, config.capabilities
    if swings:
        preset = preset.modulated()
    return {
        "config": config,
        "shares_scheme": preset.shares_scheme and not opens,
        "judged": "chain" in preset.judged and not opens,
        "accuracy": preset.accuracy_of("transmittance"),
        "least_residual": able.residual,
        "round_off": TRAJECTORY_TOLERANCE[able.precision],
        "gives_way": CREEP * preset.residual_slip_compliance,
    }


_COLUMNS = [
    "configuration", *CONFIG, "version", *CASE, "case", "curve", "steps", "status", "transmittance_db", "phase_deg",
    "ratio", "residual", "amplification", "periods", "multiple", "stuck", "transitions", "stick_velocity", "seconds",
    "reason", "config", "shares_scheme", "judged", "accuracy", "least_residual", "round_off", "gives_way",
]  # fmt: skip

_TYPES = {
    "steps": int,
    "ratio": complex,
    "shares_scheme": bool,
    "judged": bool,
    "residual": float,
    "amplification": float,
}

INTERNAL = [
    "case", "curve", "config", "ratio", "shares_scheme", "accuracy", "least_residual", "round_off", "gives_way",
]  # fmt: skip
"""Columns that files of tables leave out."""

CHANGE = ["cell", "time", "mode"]
"""Of a contact between stick and slip: its time is over the period, the mode is the new one."""


def transitions(stored: Iterable[Stored]) -> pd.DataFrame:
    """Give one row a change between stick and slip: its ``cell``, ``time`` over the period and new ``mode``."""
    rows = [
        {**label, "cell": cell, "time": time, "mode": mode}
        for run, version, result in steady_ones(stored)
        if result.status is Status.PERIODIC and result.transitions
        for label in [{**described(run.config, run.of(Case)), "version": version, "steps": run.steps}]
        for cell, time, mode in result.transitions
    ]
    return pd.DataFrame(rows, columns=[*CONFIG, "version", *CASE, "steps", *CHANGE])


@lru_cache(maxsize=4096)
def curve_of(case: Case) -> Case:
    """Give what the points of one curve share: the case with a frequency ratio of 1."""
    return replace(case, frequency_ratio=1.0)


def rows_of(table: pd.DataFrame, *names: str) -> Iterator[tuple[Any, ...]]:
    """Give the values of some columns, row by row."""
    return zip(*(table[name].tolist() for name in names), strict=True)


def is_reference(table: pd.DataFrame) -> pd.Series:
    """Tell which rows are of the reference's scheme."""
    return (table.engine == REFERENCE.engine) & (table.preset == REFERENCE.preset_name)


def is_exact(table: pd.DataFrame) -> pd.Series:
    """Tell which rows are of the exact motion."""
    return (table.engine == EXACT.engine) & (table.preset == EXACT.preset_name)


def coarsest(table: pd.DataFrame) -> pd.DataFrame:
    """Give the rows of every configuration and case at the fewest steps per period that are there."""
    return table[table.steps == table.groupby([table.config, table.case], sort=False).steps.transform("min")]


def file_columns(table: pd.DataFrame) -> pd.DataFrame:
    """Give a table as files have it: plain values, stuck fractions as numbers with spaces between."""
    shown = table.drop(columns=[name for name in INTERNAL if name in table])
    return with_amplitude(shown).map(_spaced)


def with_amplitude(table: pd.DataFrame) -> pd.DataFrame:
    """Put ``amplitude``, of the base or of the force, and ``amplitude_unit``, m or N, in place of ``displacement``.

    Tables of scenarios have none of them.
    """
    if "displacement" not in table:
        return table
    own = [amplitude_of(*row) for row in rows_of(table, "drive", "displacement")]
    shown = table.rename(columns={"displacement": "amplitude"}).assign(amplitude=[value for value, _ in own])
    shown.insert(list(shown).index("amplitude") + 1, "amplitude_unit", [unit for _, unit in own])
    return shown


def _spaced(value: Any) -> Any:
    return " ".join(f"{part:.6g}" for part in value) if isinstance(value, tuple) else value
