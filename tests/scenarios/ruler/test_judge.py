"""The one ruler: a sound copy of the scheme agrees, and one that is off by a hundredth does not."""

from dataclasses import replace
from typing import Any

import numpy as np
import pandas as pd
import pytest

from multibody_xval.scenarios.model import EXACT, REFERENCE, Case, Config, Result, Run, Status, failed
from multibody_xval.scenarios.result_tables import points
from multibody_xval.scenarios.ruler import judge
from multibody_xval.scenarios.ruler.exact_values import LADDER, ruler
from multibody_xval.scenarios.ruler.judge import AGREES, DEVIATES, TOO_LARGE, UNKNOWN, failures, judged
from multibody_xval.scenarios.store import Stored
from tests.scenarios.in_this_process import result_of

CASES = [
    Case(friction_ratio=f, frequency_ratio=eta) for f, eta in ((0.17, 0.73), (0.3, 0.47), (0.42, 1.24), (0.9, 1.03))
]
"""Points off the usual grids, where contacts stick and slip; `tests/faulty` judges copies that are wrong."""

SHARES, OTHER, DEFAULT = Config("mujoco"), Config("drake"), Config("mujoco", preset_name="default")
"""A judged preset that shares the scheme, one that does not, and one that is measured."""

STEPS = 400


def ruled_at(*cases: Case) -> list[Stored]:
    """Give results of the ruler at cases."""
    return [Stored(run, "1", result_of(run)) for run in ruler((case, STEPS) for case in cases)]


def exact_of(ruled: list[Stored]) -> Result:
    return next(own.result for own in ruled if own.run.config == EXACT)


def copies(config: Config) -> list[Stored]:
    """The scheme's results, said to be those of a configuration."""
    return [Stored(Run(config, case, STEPS), "1", result_of(Run(REFERENCE, case, STEPS))) for case in CASES]


def row_of(ruled: list[Stored], config: Config, result: Result, **columns: float) -> Any:
    """Judge one result beside its ruler."""
    own = Stored(Run(config, ruled[0].run.case, STEPS), "1", result)
    table = judged(points([*ruled, own]).assign(**columns))
    return table[table.engine == config.engine].iloc[0]


@pytest.mark.parametrize(("config", "expected"), [(SHARES, "reference at equal steps"), (OTHER, "exact value")])
def test_the_error_that_is_shown_is_that_to_the_exact_value(config, expected) -> None:
    table = judged(points([*ruled_at(*CASES), *copies(config)]))
    own = table[table.engine == config.engine]
    assert (set(own.verdict), set(own.expected), set(own.exact_kind)) == ({AGREES}, {expected}, {"exact"})
    assert np.allclose(own.error_db, own.transmittance_db - own.exact_db)
    assert (own.error_percent > 0).all()


def test_without_the_finest_steps_of_the_ruler_a_number_is_unknown() -> None:
    coarse = [own for own in ruled_at(*CASES) if own.run.steps != LADDER[-1] * STEPS]
    table = judged(points([*coarse, *copies(OTHER)]))
    assert UNKNOWN in set(table[table.engine != "reference"].verdict)


ENDS = {"n": Result(status=Status.NOT_PERIODIC), "u": Result(status=Status.UNSUPPORTED), "f": failed("it crashed")}


@pytest.mark.parametrize(
    ("config", "ends", "says"),
    [
        (SHARES, "    ", None),
        (SHARES, "   n", None),
        (SHARES, "  nn", "2 of 4 numbers are missing"),
        (SHARES, "  ff", "2 of 4 numbers failed: it crashed"),
        (SHARES, "uuuu", None),
        (DEFAULT, "nnnn", None),
        (DEFAULT, "ffff", None),
    ],
)
def test_a_quarter_of_missing_numbers_of_a_judged_preset_fails(config, ends, says) -> None:
    own = [
        stored if end == " " else stored._replace(result=ENDS[end])
        for stored, end in zip(copies(config), ends, strict=True)
    ]
    table = judged(points([*ruled_at(*CASES), *own]))
    assert failures(table) == ([] if says is None else [f"mujoco:joint:{config.preset_name}: {says}"])
    if (config, ends) == (DEFAULT, "ffff"):
        named = failures(table, lambda rows: rows.engine == "mujoco")
        assert named == ["mujoco:joint:default: 4 of 4 numbers failed: it crashed"]


@pytest.mark.parametrize(("off", "verdict"), [(5e-6, AGREES), (5e-5, DEVIATES)])
def test_an_accuracy_is_that_of_an_amplitude_at_the_floor_where_the_motion_is_smaller(off, verdict) -> None:
    """A hundredth of 6e-5 U0 is 6e-7; of what -60 dB are, 1e-5."""
    ruled = ruled_at(Case(friction_ratio=0.61, frequency_ratio=1.81))
    exact = exact_of(ruled)
    assert abs(exact.transmittance) < 0.1 * judge.FLOOR
    near = replace(exact, transmittance=exact.transmittance + off)
    assert row_of(ruled, OTHER, near, accuracy=0.01).verdict == verdict
    assert row_of(ruled, OTHER, near, accuracy=0.0).verdict == DEVIATES


def test_a_stated_accuracy_is_at_most_a_tenth_of_what_friction_changes() -> None:
    """Well below the band friction changes 0.1 % of the amplitude: a hundredth of that would agree with no friction."""
    ruled = ruled_at(Case(friction_ratio=0.31, frequency_ratio=0.3))
    exact = exact_of(ruled)
    effect = judge.friction_effect(ruled[0].run.of(Case), exact.transmittance)
    assert effect < 0.01 * abs(exact.transmittance)
    for share, verdict in {0.0: AGREES, 0.09: AGREES, 0.2: DEVIATES}.items():
        own = replace(exact, transmittance=exact.transmittance + share * effect)
        assert row_of(ruled, OTHER, own, accuracy=0.01).verdict == verdict


@pytest.mark.parametrize(("steps", "verdict"), [(2, AGREES), (2 + 1e-9, DEVIATES)])
def test_a_distance_that_is_what_is_allowed_but_for_its_last_digit_agrees(steps: float, verdict: str) -> None:
    """116 and 114 of 400 steps are 0.005000000000000004 apart; 0.005 is allowed."""
    sizes = dict.fromkeys(("exact_bar", "scheme_error", "stated", "repeats"), 0.0)
    row = {
        "status": "periodic",
        "shares_scheme": False,
        "distance": 0.29 - (116 - steps) / STEPS,
        "resolution": 2 / STEPS,
    }
    parts = pd.DataFrame([{**row, **sizes, "size": 1.0, "effect": 1.0}])
    assert row["distance"] > row["resolution"]
    assert judge.decided(parts)["verdict"].tolist() == [verdict]


def test_where_the_scheme_errs_much_another_scheme_may_err_twice_as_much_undecided() -> None:
    """At this point Euler's step with 400 a period is 2.8 % off, more than any accuracy that a preset may state."""
    ruled = ruled_at(Case(friction_ratio=0.101, frequency_ratio=1.402))
    row = row_of(ruled, OTHER, ruled[0].result, accuracy=0.0)
    assert row.scheme_error > 0.015 * abs(row.exact)
    for times, verdict in ((0.9, AGREES), (1.5, TOO_LARGE), (2.5, DEVIATES)):
        own = replace(ruled[0].result, transmittance=row.exact + times * row.allowed)
        assert row_of(ruled, OTHER, own, accuracy=0.0).verdict == verdict
