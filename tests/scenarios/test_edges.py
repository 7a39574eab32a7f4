"""Band edges: crossings that are known come out, what is hidden is found, what is absent is said, and a search ends."""

import math
from collections.abc import Callable, Iterable
from dataclasses import replace
from typing import Any

import numpy as np
import pandas as pd
import pytest
from scipy.optimize import brentq

from multibody_xval.scenarios.compute.batch import run_batch
from multibody_xval.scenarios.edges import edges, judged_edges, propose, refined
from multibody_xval.scenarios.model import EXACT, REFERENCE, Case, Config, Result, Run, Status
from multibody_xval.scenarios.plan import runs_at
from multibody_xval.scenarios.result_tables import points
from multibody_xval.scenarios.ruler.judge import AGREES, DEVIATES, UNKNOWN
from multibody_xval.scenarios.store import Stored

SHARES, OTHER = Config("mujoco"), Config("drake")
"""A preset that shares the scheme, and one that does not."""

GRID = np.round(np.arange(0.5, 1.65, 0.1), 3).tolist()

Level = Callable[[float], float]
"""Level [dB] of a curve at a frequency ratio."""


def result(level_db: float) -> Result:
    if math.isnan(level_db):
        return Result(status=Status.NOT_PERIODIC)
    return Result(
        status=Status.PERIODIC, transmittance=10 ** (level_db / 20), residual=1e-13, amplification=1.0, periods=2
    )


def case_at(eta: float) -> Case:
    return Case(friction_ratio=0.3, frequency_ratio=eta)


def stored(config: Config, level: Level, etas: Iterable[float]) -> list[Stored]:
    return [Stored(Run(config, case_at(eta), 400), "1", result(level(eta))) for eta in etas]


def searched(levels: dict[Config, Level], etas: Iterable[float] = GRID, most: int = 40) -> pd.DataFrame:
    """Points of curves that are functions, with all runs that their edges need."""
    runs = {Run(config, case_at(eta), 400): None for config in levels for eta in etas}
    for _ in range(most):
        rows = [Stored(run, "1", result(levels[run.config](run.case.frequency_ratio))) for run in runs]
        table = points(rows)
        new = [run for run in propose(table) if run not in runs]
        if not new:
            return table
        runs |= dict.fromkeys(new)
    raise AssertionError("the search does not end")


def straight(eta: float) -> float:
    return 20 - 25 * eta


def known(level: Level) -> dict[Config, Level]:
    """The reference and the exact motion, both on one curve."""
    return {REFERENCE: level, EXACT: level}


def of(table: pd.DataFrame, config: Config, edge: str = "lower") -> Any:
    own = table[(table.engine == config.engine) & (table.preset == config.preset_name) & (table.edge == edge)]
    return next(own.itertuples())


def with_kink(eta: float) -> float:
    """Falls by 500 dB, and from 0.8 on by 300 dB: crosses at 0.8 + 0.01 / 3."""
    return min(1 - 500 * (eta - 0.8), 5.0) if eta < 0.8 else max(1 - 300 * (eta - 0.8), -20.0)


CURVES: dict[str, tuple[Level, float]] = {
    "bent": (lambda eta: 40 * (0.8123**3 - eta**3), 0.8123),
    "steep": (lambda eta: -20 * np.tanh(200 * (eta - 0.8377)), 0.8377),
    "kink": (with_kink, 0.8 + 1 / 300),
    "jump": (lambda eta: 3.0 if eta < 0.8456789 else -15.0, 0.8456789),
    "through a point of the grid": (lambda eta: 30 * (0.8 - eta), 0.8),
}
"""Curves with where they cross."""


@pytest.mark.parametrize("name", CURVES)
def test_a_known_crossing_is_found_as_well_as_is_said(name: str) -> None:
    level, place = CURVES[name]
    table = searched(known(level))
    found = of(edges(table), REFERENCE)
    assert refined(edges(table))[found.Index]
    assert abs(found.frequency_ratio - place) <= found.interpolation + 1e-9
    assert (table.engine == "reference").sum() < len(GRID) + 90


def test_a_crossing_hidden_between_points_close_below_the_threshold_is_found() -> None:
    def peaked(eta: float) -> float:
        return 8 - 10 * eta + 5 * math.exp(-(((eta - 0.955) / 0.015) ** 2)) - 40 * max(eta - 1.0, 0)

    alone = edges(points(stored(REFERENCE, peaked, GRID)))
    found = of(edges(searched(known(peaked))), REFERENCE)
    assert alone.guess[0] < 0.85
    assert found.frequency_ratio == pytest.approx(brentq(peaked, 0.955, 1.0), abs=1e-6)


def always_below(eta: float) -> float:
    return -5 - 10 * eta


def test_an_edge_that_is_absent_says_why_and_agrees_if_the_reference_has_none() -> None:
    found = judged_edges(searched({**known(always_below), SHARES: always_below, OTHER: always_below}))
    absent = found[found.edge == "lower"]
    assert set(absent.absent) == {"below 0 dB from 0.5 on"}
    assert absent.frequency_ratio.isna().all()
    assert set(absent.verdict) == {AGREES}


def test_an_edge_that_one_curve_alone_has_deviates_where_its_points_do() -> None:
    runs = runs_at([SHARES], [case_at(eta) for eta in GRID])
    levels = {REFERENCE: straight, EXACT: straight, SHARES: always_below}
    table = points([Stored(run, "1", result(levels[run.config](run.case.frequency_ratio))) for run in runs])
    assert of(judged_edges(table), SHARES).verdict == DEVIATES
    without_ruler = points([*stored(REFERENCE, straight, GRID), *stored(SHARES, always_below, GRID)])
    assert of(judged_edges(without_ruler), SHARES).verdict == UNKNOWN


def test_an_edge_among_points_without_a_steady_state_is_not_known() -> None:
    def lost(eta: float) -> float:
        return math.nan if 0.75 < eta < 0.85 else straight(eta)

    found = judged_edges(searched({**known(straight), SHARES: lost}))
    own = of(found, SHARES)
    assert math.isnan(own.frequency_ratio)
    assert own.absent.startswith("not periodic at")
    assert own.verdict == UNKNOWN
    assert of(found, REFERENCE).verdict == AGREES


def computed(
    spoilt: dict[Config, Callable[[Case], Case]], friction: float, etas: Iterable[float], cells: int = 7
) -> pd.DataFrame:
    """Points of copies of the scheme that step changed chains, with all runs that edges need."""
    found: dict[Run, Result] = {}
    cases = [Case(friction_ratio=friction, frequency_ratio=eta, cells=cells) for eta in etas]
    new = [Run(config, case, 400) for config in (REFERENCE, *spoilt) for case in cases]
    while new:
        for run in new:
            change = spoilt.get(run.config)
            own = run if change is None else Run(REFERENCE, change(run.case), run.steps)
            found[run] = run_batch([own])[0]
        table = points([Stored(run, "1", own) for run, own in found.items()])
        new = [run for run in propose(table) if run not in found]
    return table


@pytest.mark.slow
def test_beside_a_kink_a_sound_copy_has_the_edge_and_the_exact_one_is_the_exact_motions() -> None:
    """With two cells a contact sticks for one step more just below the edge: the slope goes from 494 to 311 dB."""
    found = judged_edges(computed({SHARES: off()}, 0.1, [0.6, 0.8, 0.8505, 0.9, 1.1, 1.4], cells=2))
    own, reference = of(found, SHARES), of(found, REFERENCE)
    assert abs(own.frequency_ratio - reference.frequency_ratio) <= own.allowed <= 2e-6
    curve = Case(friction_ratio=0.1, frequency_ratio=1.0, cells=2)

    def exact_level(eta: float) -> float:
        return run_batch([Run(EXACT, replace(curve, frequency_ratio=eta), 400)])[0].level_db

    place = brentq(exact_level, reference.exact - 1e-5, reference.exact + 1e-5, xtol=1e-11)
    assert abs(reference.exact - place) <= min(reference.exact_bar, 1e-7)


def off(**factors: float) -> Callable[[Case], Case]:
    return lambda case: replace(case, **{name: factor * getattr(case, name) for name, factor in factors.items()})


@pytest.mark.parametrize(("config", "factor"), [(SHARES, 1.0), (SHARES, 1.01), (OTHER, 1.0)])
def test_a_sound_copy_has_the_edge_and_one_whose_bound_is_a_hundredth_off_has_not(config, factor) -> None:
    table = computed({config: off(friction_ratio=factor)}, 0.3, [0.6, 0.62, 0.65, 0.7, 1.0, 1.4])
    own = of(judged_edges(table), config)
    assert own.verdict == (AGREES if factor == 1 else DEVIATES)
    assert factor == 1 or abs(own.frequency_ratio - own.reference) > 100 * own.allowed
