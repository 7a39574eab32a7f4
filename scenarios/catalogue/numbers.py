"""Numbers of a scenario: a row a run and quantity, beside its exact value, judged by the one ruler."""

import math
from collections.abc import Iterable, Iterator, Mapping, Sequence
from typing import Any

import numpy as np
import pandas as pd

from multibody_xval.scenarios.cases.motions import BlockMotion
from multibody_xval.scenarios.cases.scene_motion import SceneMotion
from multibody_xval.scenarios.catalogue.ruler import CLOSED_FORM, DONE, Ruler
from multibody_xval.scenarios.catalogue.scenario import (
    STICK_SLIP,
    TRANSMITTANCE,
    Exact,
    Number,
    Quantity,
    Scenario,
    given,
    largest,
)
from multibody_xval.scenarios.catalogue.stick_slip import stick_slip
from multibody_xval.scenarios.compute.motions import is_pressed
from multibody_xval.scenarios.model import EXACT, AnyCase, Case, Config, Run, failed
from multibody_xval.scenarios.result_tables import CONFIG, names_of, of_config, points
from multibody_xval.scenarios.ruler.judge import AT_EQUAL_STEPS, DB, EXACT_VALUE, decided, judged, parts_of
from multibody_xval.scenarios.store import Stored
from reference_lcp.steady.richardson import ROUND_OFF_STEPS

COLUMNS = [
    "scenario", "case", "configuration", *CONFIG, "version", "steps", "quantity", "unit", "value", "reference", "exact",
    "exact_bar", "exact_kind", "scheme_error", "resolution", "accuracy", "allowed", "error", "distance", "expected",
    "verdict", "judged", "reason",
]  # fmt: skip

DECIDING = [
    "distance", "exact_bar", "scheme_error", "stated", "resolution", "repeats", "size", "effect",
]  # fmt: skip
"""Sizes that decide, see `judge.decided`."""

RELATIVE = ("transmittance", "share", "creep")
"""Accuracies that are stated as a part of the number."""

NOT_RUN = "not run"
"""Verdict on numbers whose runs are missing."""

Row = dict[str, Any]


def numbers(scenario: Scenario, stored: Iterable[Stored], configs: Sequence[Config] | None = None) -> pd.DataFrame:
    """Give a row a run and quantity, in the order of results and quantities; judging asks for no runs.

    Columns: `COLUMNS`. All sizes are in the unit of the quantity; value and exact value of a transmittance are complex,
    and those of an array are its largest difference and zero. ``error`` is that to the exact value, ``distance`` that
    to what is ``expected``, and ``reference`` the number of the scheme at equal steps; ``accuracy`` is what the preset
    states.

    Parameters
    ----------
    scenario
        What is asked.
    stored
        Results, those of the ruler too; others are left out.
    configs
        Whose numbers are given, in the order of their runs; the verdict on what is missing is `NOT_RUN`. Without them,
        all that have results, in the order of those.
    """
    results = list(stored)
    stored_configs = dict.fromkeys(own.run.config for own in results if own.run.config != EXACT)
    of = list(stored_configs) if configs is None else configs
    names = {run: name for config in of for name, run in scenario.own_runs(config).items()}
    asked = {run: run for run in scenario.runs(of)}  # their drives are whole: a store knows a user's record by its hash
    known = [own._replace(run=asked[own.run]) for own in results if own.run in asked]
    compared = [own for own in known if own.run in names]
    if configs is not None:
        found = {own.run: own for own in compared}
        missing = [Stored(run, "", failed(NOT_RUN)) for run in names if run not in found]
        known, found = known + missing, found | {own.run: own for own in missing}
        compared = [found[run] for run in names]
    ruler, levels = Ruler(known), _transmittances(scenario, known)
    rows = [
        _labels(scenario, names[own.run], own, quantity) | part
        for own in compared
        for quantity, part in _parts(scenario, own, ruler, levels)
    ]
    columns = dict.fromkeys([*COLUMNS, *DECIDING, "status", "shares_scheme", "group"])
    table = pd.DataFrame(rows, columns=list(columns), dtype=object)  # values are real or complex, row by row
    table = table.astype({**dict.fromkeys(DECIDING, float), "shares_scheme": bool, "judged": bool, "steps": int})
    table = table.assign(scheme_error=_shared(table))
    table = table.assign(**decided(table))[COLUMNS]
    return table.assign(verdict=table.verdict.where(table.reason != NOT_RUN, NOT_RUN))


def _labels(scenario: Scenario, case: str, own: Stored, quantity: Quantity) -> Row:
    """Give what names a row, and what of its configuration decides."""
    run, config = own.run, own.run.config
    about = about_config(run)
    return {
        "scenario": scenario.name, "case": case, **names_of(config), "version": own.version,
        "steps": run.steps, "quantity": quantity.name, "unit": quantity.unit, "status": str(own.result.status),
        "reason": own.result.reason, "group": quantity.group, "judged": about["judged"],
        "accuracy": _accuracy(quantity, config),
        "shares_scheme": about["shares_scheme"] and quantity.step_error is None, "repeats": 0.0,
    }  # fmt: skip


def about_config(run: Run) -> Row:
    """Give what of a configuration decides how its numbers are compared; see `result_tables.of_config`."""
    case, preset = run.case, run.config.preset
    if isinstance(case, SceneMotion):
        return of_config(run.config, swings=False) | {"judged": "scenes" in preset.judged, "shares_scheme": False}
    modulation = case.modulation if isinstance(case, Case) else 0.0
    about = of_config(run.config, swings=bool(modulation) or is_pressed(run), opens=modulation > 1)
    if isinstance(case, BlockMotion):
        return about | {"judged": "blocks" in preset.judged}
    return about


def _parts(scenario: Scenario, own: Stored, ruler: Ruler, levels: Mapping[Any, Row]) -> Iterator[tuple[Quantity, Row]]:
    """Give every quantity of a result, with its numbers."""
    together: Mapping[str, Row] = {}
    if own.result.status in DONE and any(each in STICK_SLIP for each in scenario.quantities):
        exact, ladder = ruler.exact(own.run.case), ruler.ladder(own.run)
        together = stick_slip(own.run, own.result, exact[1] if exact else None, ladder, about_config(own.run))
    for quantity in scenario.quantities:
        if quantity.of is not None and not quantity.of(own.run.case):
            continue
        if quantity.read is not None:
            yield quantity, _read(quantity, own, ruler)
        elif quantity.name == TRANSMITTANCE.name:
            yield quantity, levels[own.run, own.version]
        else:
            yield quantity, together.get(quantity.name, {})


def _read(quantity: Quantity, own: Stored, ruler: Ruler) -> Row:
    """Read a quantity of one result, beside what is known of it."""
    assert quantity.read is not None, "it is read alone"
    run, known, about = own.run, ruler.known(quantity, own.run), about_config(own.run)
    expected_is_scheme = about["shares_scheme"] and quantity.step_error is None
    value: Any = quantity.read(own.result, run) / known.over if own.result.status in DONE else math.nan
    if quantity.between:
        known = known._replace(exact=float(np.clip(value, *quantity.between)))
    per_amplitude = quantity.per_amplitude / abs(known.over)
    amplitude = DB / 10 ** (float(known.exact.real) / 20) if quantity.unit == "dB" else per_amplitude
    open_amplitude = about["round_off"] * math.sqrt(run.steps / ROUND_OFF_STEPS) + about["gives_way"]
    effect = _effect(quantity, run.case, known.exact)
    size = DB if quantity.unit == "dB" else max(largest(known.exact), effect if math.isfinite(effect) else 0.0)
    accuracy = _accuracy(quantity, run.config)
    distance = largest(value - (known.reference if expected_is_scheme else known.exact))
    shown: list[Any] = [value, known.exact, known.reference]
    if np.ndim(value) or np.ndim(known.exact):  # of arrays, the largest difference
        shown = [largest(own - known.exact) for own in shown]
    return {
        **dict(zip(("value", "exact", "reference"), shown, strict=True)), "error": shown[0] - shown[1],
        "exact_bar": known.bar, "exact_kind": known.kind, "scheme_error": known.scheme_error, "distance": distance,
        "resolution": given(quantity.resolution, run)
        + (amplitude * open_amplitude if quantity.step_error is None else 0.0),
        "expected": AT_EQUAL_STEPS if expected_is_scheme else EXACT_VALUE,
        "stated": accuracy * (size if quantity.accuracy in RELATIVE else 1.0),
        "size": size, "effect": effect,
    }  # fmt: skip


def _accuracy(quantity: Quantity, config: Config) -> float:
    """Give the accuracy that a preset states of a quantity."""
    return config.preset.accuracy_of(quantity.accuracy) if quantity.accuracy else 0.0


def _effect(quantity: Quantity, case: AnyCase, exact: Number) -> float:
    if quantity.effect is not None:
        return given(quantity.effect, case, exact)
    if quantity.step_error is not None:
        return math.inf
    return DB if quantity.unit == "dB" else largest(exact)


def _shared(table: pd.DataFrame) -> "pd.Series[float]":
    """Give the error of the step: of quantities of one group, the largest, since that of one may vanish by chance."""
    keys = ["configuration", "version", "case", "steps", "group"]
    most = table.groupby(keys, sort=False).scheme_error.transform("max")
    return table.scheme_error.where(table.group == "", most)


def _transmittances(scenario: Scenario, stored: Sequence[Stored]) -> dict[tuple[Run, str], Row]:
    """Give the judged transmittances of steady states, level and phase as one complex number."""
    own = (each for each in scenario.quantities if each.read is None and each.name == TRANSMITTANCE.name)
    quantity = next(own, None)
    if quantity is None:
        return {}
    rows = judged(points(stored), closed_forms=_closed_forms(scenario, quantity))
    rows = rows.assign(**parts_of(rows))
    found = {}
    for row in rows.to_dict("records"):
        found[Run(row["config"], row["case"], row["steps"]), row["version"]] = {
            **{name: row[name] for name in DECIDING},
            **{name: row[name] for name in ("reference", "exact", "exact_kind", "expected")},
            "value": row["ratio"],
            "error": abs(row["ratio"] - row["exact"]),
        }
    return found


def _closed_forms(scenario: Scenario, quantity: Quantity) -> pd.DataFrame | None:
    """Give the closed forms of transmittances, as `exact_values.exact_values` gives other ones."""
    if isinstance(quantity.exact, Exact):
        return None
    rows = [
        (case, given(quantity.exact, case), given(quantity.bar, case), CLOSED_FORM) for case in scenario.cases.values()
    ]
    return pd.DataFrame(rows, columns=["case", "exact", "exact_bar", "exact_kind"]).astype({"exact": complex})
