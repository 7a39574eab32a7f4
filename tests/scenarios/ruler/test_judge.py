"""The one ruler: a sound copy of the scheme agrees, and one that is off by a hundredth does not."""

import math
from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pandas as pd
import pytest

from multibody_xval.scenarios.compute.batch import run_batch
from multibody_xval.scenarios.model import REFERENCE, Case, Config, Result, Run, Status, failed
from multibody_xval.scenarios.result_tables import points
from multibody_xval.scenarios.ruler import judge
from multibody_xval.scenarios.ruler.exact_values import LADDER, ruler
from multibody_xval.scenarios.ruler.judge import AGREES, DEVIATES, TOO_LARGE, UNKNOWN, failures, judged
from multibody_xval.scenarios.store import Stored

CASES = [
    Case(friction_ratio=f, frequency_ratio=eta) for f, eta in ((0.17, 0.73), (0.3, 0.47), (0.42, 1.24), (0.9, 1.03))
]
"""Points off the usual grids, where contacts stick and slip."""

SHARES, OTHER, DEFAULT = Config("mujoco"), Config("drake"), Config("mujoco", preset_name="default")
"""A judged preset that shares the scheme, one that does not, and one that is measured."""

STEPS = 400


@pytest.fixture(scope="module")
def ruled() -> list[Stored]:
    """Results of the ruler at the cases."""
    runs = ruler((case, STEPS) for case in CASES)
    return [Stored(run, "1", run_batch([run])[0]) for run in runs]


def copies(config: Config, change: Callable[[Case], Case] = lambda case: case) -> list[Stored]:
    """Results of a copy of the scheme that steps a changed chain, said to be those of a configuration."""
    results = [run_batch([Run(REFERENCE, change(case), STEPS)])[0] for case in CASES]
    return [Stored(Run(config, case, STEPS), "1", own) for case, own in zip(CASES, results, strict=True)]


def verdicts(ruled: list[Stored], own: list[Stored]) -> list[str]:
    table = judged(points([*ruled, *own]))
    return table[table.engine != "reference"].verdict.tolist()


def scaled(name: str, factor: float) -> Callable[[Case], Case]:
    return lambda case: replace(case, **{name: factor * getattr(case, name)})


WRONG = {
    "bound": scaled("friction_ratio", 1.01),
    "mass": scaled("mass_ratio", 1.01),
    "spring": scaled("stiffness_ratio", 1.01),
    "dashpots": scaled("damping_ratio", 1.1),
    "frequency": scaled("frequency_ratio", 1.001),
    "one cell": lambda case: replace(case, outer_mass_ratio=(*(1.0,) * 6, 1.02)),
}


@pytest.mark.parametrize("config", [SHARES, OTHER])
def test_a_sound_copy_of_the_scheme_agrees(ruled, config) -> None:
    assert verdicts(ruled, copies(config)) == [AGREES] * len(CASES)


@pytest.mark.parametrize("wrong", WRONG)
def test_a_copy_with_one_error_deviates_at_equal_steps(ruled, wrong) -> None:
    assert verdicts(ruled, copies(SHARES, WRONG[wrong])) == [DEVIATES] * len(CASES)


@pytest.mark.parametrize("wrong", WRONG)
def test_a_copy_with_one_error_deviates_from_the_exact_value_somewhere(ruled, wrong) -> None:
    """Where the scheme's own error is larger, one point need not show it: a grid has many."""
    assert DEVIATES in verdicts(ruled, copies(OTHER, WRONG[wrong]))


@pytest.mark.parametrize("config", [SHARES, OTHER])
def test_a_motion_of_the_right_size_a_step_late_deviates(ruled, config) -> None:
    late = [
        stored._replace(result=replace(stored.result, transmittance=stored.result.transmittance * np.exp(0.02j)))
        for stored in copies(config)
    ]
    assert DEVIATES in verdicts(ruled, late)


def test_the_error_that_is_shown_is_that_to_the_exact_value(ruled) -> None:
    table = judged(points([*ruled, *copies(SHARES)]))
    own = table[table.engine == "mujoco"]
    assert set(own.expected) == {"reference at equal steps"}
    assert np.allclose(own.error_db, own.transmittance_db - own.exact_db)
    assert (own.error_percent > 0).all()
    assert own.exact_kind.tolist() == ["exact"] * len(CASES)


def test_a_stated_accuracy_is_allowed(ruled) -> None:
    table = points([*ruled, *copies(OTHER, scaled("friction_ratio", 1.005))])
    assert DEVIATES in judged(table).verdict.tolist()
    stated = table.assign(accuracy=np.where(table.engine == "drake", 0.05, 0.0))
    own = judged(stated)
    assert set(own[own.engine == "drake"].verdict) <= {AGREES, TOO_LARGE}


def test_coarse_steps_agree_with_nothing() -> None:
    """At a resonance the scheme's error with 40 steps is no longer small beside what friction changes."""
    case, steps = Case(friction_ratio=0.1, frequency_ratio=0.62), 40
    runs = ruler([(case, steps)])
    ruled = [Stored(run, "1", run_batch([run])[0]) for run in runs]
    assert verdicts(ruled, [Stored(Run(OTHER, case, steps), "1", ruled[0].result)]) == [TOO_LARGE]


def test_without_the_ruler_a_number_is_unknown(ruled) -> None:
    table = judged(points(copies(OTHER)))
    assert table.verdict.tolist() == [UNKNOWN] * len(CASES)
    fewer = [own for own in ruled if own.run.steps != LADDER[-1] * STEPS]
    assert UNKNOWN in verdicts(fewer, copies(OTHER))


def result_of(status: Status) -> Result:
    return failed("it crashed") if status is Status.FAILED else Result(status=status)


@pytest.mark.parametrize(
    ("config", "statuses", "says"),
    [
        (SHARES, [Status.PERIODIC] * 4, None),
        (SHARES, [Status.PERIODIC] * 3 + [Status.NOT_PERIODIC], None),
        (SHARES, [Status.PERIODIC] * 2 + [Status.NOT_PERIODIC] * 2, "2 of 4 numbers are missing"),
        (SHARES, [Status.PERIODIC] * 2 + [Status.FAILED] * 2, "2 of 4 numbers failed: it crashed"),
        (SHARES, [Status.UNSUPPORTED] * 4, None),
        (DEFAULT, [Status.NOT_PERIODIC] * 4, None),
        (DEFAULT, [Status.FAILED] * 4, None),
    ],
)
def test_a_quarter_of_missing_numbers_of_a_judged_preset_fails(ruled, config, statuses, says) -> None:
    own = [
        stored if status is Status.PERIODIC else stored._replace(result=result_of(status))
        for stored, status in zip(copies(config), statuses, strict=True)
    ]
    lines = failures(judged(points([*ruled, *own])))
    assert lines == ([] if says is None else [f"{':'.join(['mujoco', 'joint', config.preset_name])}: {says}"])


def test_a_measured_preset_fails_where_it_is_named_and_crashes(ruled) -> None:
    own = [stored._replace(result=failed("it crashed")) for stored in copies(DEFAULT)]
    table = judged(points([*ruled, *own]))
    assert failures(table) == []
    assert failures(table, lambda rows: rows.engine == "mujoco") == [
        "mujoco:joint:default: 4 of 4 numbers failed: it crashed"
    ]


def test_a_table_without_points_has_no_verdicts() -> None:
    assert judged(points([])).empty
    assert "Nothing was judged" in judge.conclusion(judged(points([])))


def test_levels_far_below_the_band_differ_by_their_amplitudes() -> None:
    levels = judge.on_scale(pd.Series([-60.0, -80.0, -math.inf, 0.0]))
    assert levels.tolist() == pytest.approx([-60.0, -60 - judge.DB * 0.9, -60 - judge.DB, 0.0])


@pytest.mark.parametrize(("modulation", "expected"), [(0.9, "reference at equal steps"), (1.5, "exact value")])
def test_where_contacts_open_nothing_shares_the_scheme_and_nothing_is_judged(modulation, expected) -> None:
    """A contact lands in another number of steps in every engine: two of them are 0.04 to 0.1 % apart."""
    case = Case(friction_ratio=0.3, frequency_ratio=0.7, cells=2, modulation=modulation)
    ruled = [Stored(run, "1", run_batch([run])[0]) for run in ruler([(case, STEPS)])]
    held = Config("pybullet", "contact")
    own = ruled[0].result
    near = replace(own, transmittance=own.transmittance * 1.0003)
    table = judged(points([*ruled, Stored(Run(held, case, STEPS), "1", near)]))
    row = table[table.engine == "pybullet"].iloc[0]
    opens = expected == "exact value"
    assert (row.expected, row.judged, row.verdict) == (expected, not opens, AGREES if opens else DEVIATES)
    assert row.exact_kind == "extrapolated"


@pytest.mark.parametrize(("off", "verdict"), [(5e-6, AGREES), (5e-5, DEVIATES)])
def test_an_accuracy_is_that_of_an_amplitude_at_the_floor_where_the_motion_is_smaller(off, verdict) -> None:
    """A hundredth of 6e-5 U0 is 6e-7; of what -60 dB are, 1e-5."""
    case = Case(friction_ratio=0.61, frequency_ratio=1.81)
    ruled = [Stored(run, "1", run_batch([run])[0]) for run in ruler([(case, STEPS)])]
    exact = next(own.result for own in ruled if own.run.config.preset_name == "exact")
    near = Stored(Run(OTHER, case, STEPS), "1", replace(exact, transmittance=exact.transmittance + off))
    table = points([*ruled, near])
    assert abs(exact.transmittance) < 0.1 * judge.FLOOR
    row = judged(table.assign(accuracy=0.01)).iloc[-1]
    assert row.verdict == verdict
    assert judged(table.assign(accuracy=0.0)).iloc[-1].verdict == DEVIATES


def test_a_stated_accuracy_is_at_most_a_tenth_of_what_friction_changes() -> None:
    """Well below the band friction changes 0.1 % of the amplitude: a hundredth of that would agree with no friction."""
    case = Case(friction_ratio=0.31, frequency_ratio=0.3)
    ruled = [Stored(run, "1", run_batch([run])[0]) for run in ruler([(case, STEPS)])]
    exact = next(own.result for own in ruled if own.run.config.preset_name == "exact")
    effect = judge.friction_effect(case, exact.transmittance)
    assert effect < 0.01 * abs(exact.transmittance)
    shares = {0.0: AGREES, 0.09: AGREES, 0.2: DEVIATES}
    for share, verdict in shares.items():
        own = replace(exact, transmittance=exact.transmittance + share * effect)
        table = points([*ruled, Stored(Run(OTHER, case, STEPS), "1", own)])
        assert judged(table.assign(accuracy=0.01)).iloc[-1].verdict == verdict


@pytest.mark.parametrize(("times", "verdict"), [(0.9, AGREES), (1.5, TOO_LARGE), (2.5, DEVIATES)])
def test_where_the_scheme_errs_much_another_scheme_may_err_twice_as_much_undecided(times, verdict) -> None:
    """At this point Euler's step with 400 a period is 2.8 % off, more than any accuracy that a preset may state."""
    case = Case(friction_ratio=0.101, frequency_ratio=1.402)
    ruled = [Stored(run, "1", run_batch([run])[0]) for run in ruler([(case, STEPS)])]
    table = judged(points([*ruled, Stored(Run(OTHER, case, STEPS), "1", ruled[0].result)]).assign(accuracy=0.0))
    row = table[table.engine == "drake"].iloc[0]
    assert row.scheme_error > 0.015 * abs(row.exact)
    own = replace(ruled[0].result, transmittance=row.exact + times * row.allowed)
    table = points([*ruled, Stored(Run(OTHER, case, STEPS), "1", own)]).assign(accuracy=0.0)
    assert judged(table).iloc[-1].verdict == verdict
