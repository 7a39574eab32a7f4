"""Numbers of a scenario: a row a run and quantity, beside its exact value, judged by the one ruler."""

import math
from collections import defaultdict
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import replace
from functools import cache
from typing import Any, NamedTuple

import numpy as np
import pandas as pd

from multibody_xval.scenarios.catalogue.scenario import (
    STICK_SLIP,
    TRANSMITTANCE,
    Exact,
    Number,
    Quantity,
    Scenario,
    largest,
)
from multibody_xval.scenarios.catalogue.stick_slip import stick_slip
from multibody_xval.scenarios.compute.motions import is_pressed
from multibody_xval.scenarios.exact_values import LADDER
from multibody_xval.scenarios.judge import DB, decided, judged, parts_of
from multibody_xval.scenarios.model import EXACT, REFERENCE, AnyCase, Case, Config, Result, Run, Status
from multibody_xval.scenarios.motions import BlockMotion
from multibody_xval.scenarios.result_tables import CONFIG, full_name, of_config, points
from multibody_xval.scenarios.scene_motion import SceneMotion
from multibody_xval.scenarios.store import Stored
from reference_lcp.steady.richardson import ROUND_OFF, ROUND_OFF_STEPS, richardson

COLUMNS = [
    "scenario", "case", "configuration", *CONFIG, "version", "steps", "quantity", "unit", "value", "reference", "exact",
    "exact_bar", "exact_kind", "scheme_error", "resolution", "accuracy", "allowed", "error", "distance", "expected",
    "verdict", "judged", "reason",
]  # fmt: skip

DECIDING = [
    "distance", "exact_bar", "scheme_error", "stated", "resolution", "repeats", "size", "effect",
]  # fmt: skip
"""Sizes that decide, see `judge.decided`."""

RELATIVE = ("transmittance", "share")
"""Accuracies that are stated as a part of the number."""

CLOSED_FORM = "closed form"

DONE = (Status.PERIODIC, Status.FINISHED)

Row = dict[str, Any]


class Known(NamedTuple):
    """What is known of a quantity at a case and a number of steps."""

    exact: Number = math.nan
    bar: float = math.nan
    kind: str = ""
    scheme_error: float = math.nan
    reference: Number = math.nan
    """Of the scheme itself with these steps."""
    over: float = 1.0
    """What a number is given over."""

    def over_exact(self) -> "Known":
        """Give all over the exact value."""
        unit, reference = self.exact, self.reference
        assert isinstance(unit, float), "real numbers are given over their exact values"
        assert isinstance(reference, float), "a number like the exact one"
        return Known(
            unit / unit, self.bar / abs(unit), self.kind, self.scheme_error / abs(unit), reference / unit, over=unit
        )


def numbers(scenario: Scenario, stored: Iterable[Stored]) -> pd.DataFrame:
    """Give a row a run and quantity, in the order of results and quantities; judging asks for no runs.

    Columns: `COLUMNS`. All sizes are in the unit of the quantity; value and exact value of a transmittance are complex,
    and those of an array are its largest difference and zero. ``error`` is that to the exact value, ``distance`` that
    to what is ``expected``, and ``reference`` the number of the scheme at equal steps; ``accuracy`` is what the preset
    states.
    """
    known = list(stored)
    configs = dict.fromkeys(own.run.config for own in known if own.run.config != EXACT)
    names = {run: name for config in configs for name, run in scenario.own_runs(config).items()}
    asked = {run: run for run in names}  # whose drives are here: stored ones know a user's record by its hash alone
    known = [own._replace(run=asked.get(own.run, own.run)) for own in known]
    ruler, levels = _Ruler(scenario, known), _transmittances(scenario, known)
    rows = [
        _labels(scenario, names[own.run], own, quantity) | part
        for own in known
        if own.run in names
        for quantity, part in _parts(scenario, own, ruler, levels)
    ]
    columns = dict.fromkeys([*COLUMNS, *DECIDING, "status", "shares_scheme", "group"])
    table = pd.DataFrame(rows, columns=list(columns), dtype=object)  # values are real or complex, row by row
    table = table.astype({**dict.fromkeys(DECIDING, float), "shares_scheme": bool, "judged": bool, "steps": int})
    table = table.assign(scheme_error=_shared(table))
    return table.assign(**decided(table))[COLUMNS]


def _labels(scenario: Scenario, case: str, own: Stored, quantity: Quantity) -> Row:
    """Give what names a row, and what of its configuration decides."""
    run, config = own.run, own.run.config
    about = about_config(run)
    return {
        "scenario": scenario.name, "case": case, "configuration": full_name(config), "engine": config.engine,
        "formulation": str(config.formulation), "preset": config.preset_name, "version": own.version,
        "steps": run.steps, "quantity": quantity.name, "unit": quantity.unit, "status": str(own.result.status),
        "reason": own.result.reason, "group": quantity.group, "judged": about["judged"],
        "accuracy": config.preset.accuracy_of(quantity.accuracy) if quantity.accuracy else 0.0,
        "shares_scheme": about["shares_scheme"] and quantity.step_error is None, "repeats": 0.0,
    }  # fmt: skip


def about_config(run: Run) -> Row:
    """Give what of a configuration decides how its numbers are compared; see `result_tables.of_config`."""
    case, preset = run.case, run.config.preset
    if isinstance(case, SceneMotion):
        return of_config(run.config, swings=False) | {"judged": "scenes" in preset.judged, "shares_scheme": False}
    modulation = case.modulation if isinstance(case, Case) else 0.0
    about = of_config(run.config, swings=bool(modulation) or is_pressed(run), opens=modulation > 1)
    if isinstance(case, BlockMotion) and case.direction and preset.turned_bound is not None:
        return about | {"judged": False}  # its friction is stated to be a pyramid, no cone
    return about


def _parts(
    scenario: Scenario, own: Stored, ruler: "_Ruler", levels: Mapping[Any, Row]
) -> Iterator[tuple[Quantity, Row]]:
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


def _read(quantity: Quantity, own: Stored, ruler: "_Ruler") -> Row:
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
    return {
        "value": _shown(value, known.exact), "exact": 0.0 if _is_array(known.exact) else known.exact,
        "reference": _shown(known.reference, known.exact), "exact_bar": known.bar, "exact_kind": known.kind,
        "scheme_error": known.scheme_error,
        "resolution": quantity.resolution(run, known.exact)
        + (amplitude * open_amplitude if quantity.step_error is None else 0.0),
        "error": _shown(value, known.exact) if _is_array(known.exact) else value - known.exact,
        "distance": largest(value - (known.reference if expected_is_scheme else known.exact)),
        "expected": "reference at equal steps" if expected_is_scheme else "exact value",
        "stated": stated(quantity, run.config, size * quantity.conditioning(run.case)), "size": size, "effect": effect,
    }  # fmt: skip


def stated(quantity: Quantity, config: Config, size: float) -> float:
    """Give the accuracy that a preset states of a quantity, in its unit; `size` is what parts refer to."""
    accuracy = config.preset.accuracy_of(quantity.accuracy) if quantity.accuracy else 0.0
    return accuracy * size if quantity.accuracy in RELATIVE else accuracy


def _effect(quantity: Quantity, case: AnyCase, exact: Number) -> float:
    if quantity.effect is not None:
        return quantity.effect(case, exact)
    if quantity.step_error is not None:
        return math.inf
    return DB if quantity.unit == "dB" else largest(exact)


def _is_array(number: Number) -> bool:
    return isinstance(number, np.ndarray)


def _shown(value: Number, exact: Number) -> Number:
    """Give a number as tables have it: of an array, the largest difference."""
    return largest(value - exact) if _is_array(value) or _is_array(exact) else value


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
    if not callable(quantity.exact):
        return None
    rows = [(case, quantity.exact(case), quantity.bar(case), CLOSED_FORM) for case in scenario.cases.values()]
    return pd.DataFrame(rows, columns=["case", "exact", "exact_bar", "exact_kind"]).astype({"exact": complex})


class _Ruler:
    """Exact values and errors of the scheme, from stored results of the reference and the exact motion."""

    def __init__(self, scenario: Scenario, stored: Sequence[Stored]):
        self._refinement = scenario.exact_refinement
        self._by_case: dict[tuple[Config, AnyCase], dict[int, Result]] = defaultdict(dict)
        for run, _, result in stored:
            if run.config in (REFERENCE, EXACT) and result.status in DONE:
                self._by_case[run.config, run.case][run.steps] = result
        self._cached = cache(self._known)

    def known(self, quantity: Quantity, run: Run) -> Known:
        """Give what is known of a quantity at the case and the steps of a run."""
        return self._cached(quantity, run if quantity.step_error else replace(run, config=REFERENCE))

    def exact(self, case: AnyCase) -> tuple[Run, Result] | None:
        """Give the exact motion of a case."""
        found = self._by_case[EXACT, case]
        return next(((Run(EXACT, case, steps), result) for steps, result in found.items()), None)

    def ladder(self, run: Run) -> dict[int, Result]:
        """Give the reference at the steps of a run and at finer ones; nothing where one is missing."""
        found = self._by_case[REFERENCE, run.case]
        wanted = [run.steps * factor for factor in LADDER]
        return {steps: found[steps] for steps in wanted} if all(steps in found for steps in wanted) else {}

    def _known(self, quantity: Quantity, run: Run) -> Known:
        known = self._as_read(quantity, run)
        return known.over_exact() if quantity.over_exact else known

    def _as_read(self, quantity: Quantity, run: Run) -> Known:
        if quantity.step_error is not None:
            return Known(*self._exact_value(quantity, run.case), quantity.step_error(run))
        assert quantity.read is not None, "it is read alone"
        ladder = self.ladder(run)
        counts = list(ladder)
        values = [quantity.read(own, Run(REFERENCE, run.case, steps)) for steps, own in ladder.items()]
        if not values:
            return Known()
        first, last = (richardson(counts, np.array(values), at=counts[place]) for place in (0, -1))
        scheme = largest(first.error), values[0]
        if quantity.exact is Exact.LADDER:
            return Known(_plain(last.extrapolated), largest(last.error), str(Exact.LADDER), *scheme)
        return Known(*self._exact_value(quantity, run.case), *scheme)

    def _exact_value(self, quantity: Quantity, case: AnyCase) -> tuple[Number, float, str]:
        """Give the exact value, its bar and its kind, of a closed form or of the exact motion."""
        if callable(quantity.exact):
            return quantity.exact(case), quantity.bar(case), CLOSED_FORM
        assert quantity.exact is Exact.MOTION, "a step's error in closed form needs no ladder"
        assert quantity.read is not None, "it is read alone"
        motion = self.exact(case)
        if motion is None:
            return math.nan, math.nan, ""
        return quantity.read(motion[1], motion[0]), ROUND_OFF * quantity.per_amplitude, str(Exact.MOTION)


def _plain(values: Any) -> Number:
    return values if np.ndim(values) else float(values)
