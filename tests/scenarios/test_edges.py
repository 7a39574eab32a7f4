"""Band edges: crossings that are known come out, what is hidden is found, what is absent is said, and a search ends."""

import math
from collections.abc import Callable, Iterable
from dataclasses import replace
from typing import Any

import numpy as np
import pandas as pd
import pytest
from scipy.optimize import brentq

from multibody_xval.scenarios.edges import edges, judged_edges, propose, refined
from multibody_xval.scenarios.model import EXACT, REFERENCE, Case, Config, Result, Run, Status
from multibody_xval.scenarios.plan import runs_at
from multibody_xval.scenarios.result_tables import points
from multibody_xval.scenarios.ruler.judge import AGREES, DEVIATES, UNKNOWN
from multibody_xval.scenarios.store import Stored
from tests.scenarios.in_this_process import result_of

SHARES, OTHER = Config("mujoco"), Config("drake")
"""A preset that shares the scheme, and one that does not."""

GRID = [Case(friction_ratio=0.3, frequency_ratio=eta) for eta in np.round(np.arange(0.5, 1.65, 0.1), 3).tolist()]

Level = Callable[[float], float]
"""Level [dB] of a curve at a frequency ratio."""


def grown(
    result: Callable[[Run], Result], configs: Iterable[Config], cases: Iterable[Case], most: int = 40
) -> pd.DataFrame:
    """Give points of configurations at cases, with all runs that their edges need."""
    cases, found = list(cases), dict[Run, Result]()
    new = [Run(config, case, 400) for config in configs for case in cases]
    for _ in range(most):
        found |= {run: result(run) for run in new}
        table = points([Stored(run, "1", own) for run, own in found.items()])
        new = [run for run in propose(table) if run not in found]
        if not new:
            return table
    raise AssertionError("the search does not end")


def at_level(level_db: float) -> Result:
    if math.isnan(level_db):
        return Result(status=Status.NOT_PERIODIC)
    ratio = 10 ** (level_db / 20)
    return Result(status=Status.PERIODIC, transmittance=ratio, residual=1e-13, amplification=1.0, periods=2)


def drawn(levels: dict[Config, Level]) -> Callable[[Run], Result]:
    """Let levels of configurations be functions."""
    return lambda run: at_level(levels[run.config](run.of(Case).frequency_ratio))


def searched(level: Level, others: dict[Config, Level] | None = None) -> pd.DataFrame:
    """Give points of a curve of the reference and the exact motion, and those of others."""
    levels = {REFERENCE: level, EXACT: level, **(others or {})}
    return grown(drawn(levels), levels, GRID)


def of(table: pd.DataFrame, config: Config, edge: str = "lower") -> Any:
    own = table[(table.engine == config.engine) & (table.preset == config.preset_name) & (table.edge == edge)]
    return next(own.itertuples())


def straight(eta: float) -> float:
    return 20 - 25 * eta


CURVES: dict[str, tuple[Level, float]] = {
    "bent": (lambda eta: 40 * (0.8123**3 - eta**3), 0.8123),
    "steep": (lambda eta: -20 * np.tanh(200 * (eta - 0.8377)), 0.8377),
    "kink": (
        lambda eta: min(1 - 500 * (eta - 0.8), 5.0) if eta < 0.8 else max(1 - 300 * (eta - 0.8), -20.0),
        0.8 + 1 / 300,
    ),
    "jump": (lambda eta: 3.0 if eta < 0.8456789 else -15.0, 0.8456789),
    "through a point of the grid": (lambda eta: 30 * (0.8 - eta), 0.8),
}
"""Curves with where they cross."""


@pytest.mark.parametrize("name", CURVES)
def test_a_known_crossing_is_found_as_well_as_is_said(name: str) -> None:
    level, place = CURVES[name]
    table = searched(level)
    found = of(edges(table), REFERENCE)
    assert refined(edges(table))[found.Index]
    assert abs(found.frequency_ratio - place) <= found.interpolation + 1e-9
    assert (table.engine == "reference").sum() < len(GRID) + 90


def test_a_crossing_hidden_between_points_close_below_the_threshold_is_found() -> None:
    def peaked(eta: float) -> float:
        return 8 - 10 * eta + 5 * math.exp(-(((eta - 0.955) / 0.015) ** 2)) - 40 * max(eta - 1.0, 0)

    curve = drawn({REFERENCE: peaked})
    alone = edges(points([Stored(run, "1", curve(run)) for case in GRID for run in [Run(REFERENCE, case, 400)]]))
    assert alone.guess[0] < 0.85
    exact = brentq(peaked, 0.955, 1.0)
    assert of(edges(searched(peaked)), REFERENCE).frequency_ratio == pytest.approx(exact, abs=1e-6)


@pytest.mark.parametrize(("edge", "levels"), [("lower", [5, -1, 0.2, 0.4, -2, -12]), ("upper", [-12, -2, 0.4, -1, 5])])
def test_the_peak_at_an_edge_is_the_highest_point_until_the_curve_is_below(edge: str, levels: list[float]) -> None:
    curve = dict(zip([case.frequency_ratio for case in GRID], levels, strict=False))
    cases = [case for case in GRID if case.frequency_ratio in curve]
    runs = [Run(REFERENCE, case, 400) for case in cases]
    found = edges(points([Stored(run, "1", drawn({REFERENCE: curve.__getitem__})(run)) for run in runs]))
    assert of(found, REFERENCE, edge).peak == pytest.approx(0.4, abs=1e-12)
    assert of(edges(searched(straight)), REFERENCE).peak == math.inf


def always_below(eta: float) -> float:
    return -5 - 10 * eta


def test_an_edge_that_is_absent_says_why_and_agrees_if_the_reference_has_none() -> None:
    found = judged_edges(searched(always_below, {SHARES: always_below, OTHER: always_below}))
    absent = found[found.edge == "lower"]
    assert (set(absent.absent), set(absent.verdict)) == ({"below 0 dB from 0.5 on"}, {AGREES})
    assert absent.frequency_ratio.isna().all()


def test_an_edge_that_one_curve_alone_has_deviates_where_its_points_do() -> None:
    curves = drawn({REFERENCE: straight, EXACT: straight, SHARES: always_below})
    for ruled, verdict in ((runs_at([SHARES], GRID), DEVIATES), ([Run(REFERENCE, own, 400) for own in GRID], UNKNOWN)):
        runs = dict.fromkeys([*ruled, *(Run(SHARES, own, 400) for own in GRID)])
        table = points([Stored(run, "1", curves(run)) for run in runs])
        assert of(judged_edges(table), SHARES).verdict == verdict


def test_an_edge_among_points_without_a_steady_state_is_not_known() -> None:
    found = judged_edges(searched(straight, {SHARES: lambda eta: math.nan if 0.75 < eta < 0.85 else straight(eta)}))
    own, reference = of(found, SHARES), of(found, REFERENCE)
    assert math.isnan(own.frequency_ratio)
    assert own.absent.startswith("not periodic at")
    assert (own.verdict, reference.verdict) == (UNKNOWN, AGREES)


def copied(config: Config, factor: float) -> pd.DataFrame:
    """Give judged edges of a copy of the scheme whose friction bound is off by a factor."""

    def result(run: Run) -> Result:
        own = replace(run.of(Case), friction_profile=factor)
        return result_of(Run(REFERENCE, own, run.steps) if run.config == config else run)

    cases = [Case(friction_ratio=0.3, frequency_ratio=eta) for eta in (0.6, 0.62, 0.65, 0.7, 1.0, 1.4)]
    return judged_edges(grown(result, [REFERENCE, config], cases))


@pytest.mark.parametrize(("config", "factor"), [(SHARES, 1.0), (SHARES, 1.01), (OTHER, 1.0)])
def test_a_sound_copy_has_the_edge_and_one_whose_bound_is_a_hundredth_off_has_not(config, factor) -> None:
    own = of(copied(config, factor), config)
    assert own.verdict == (AGREES if factor == 1 else DEVIATES)
    assert factor == 1 or abs(own.frequency_ratio - own.reference) > 100 * own.allowed
