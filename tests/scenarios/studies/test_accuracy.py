"""The table of accuracy: each number finds the error that it is there for, and no other."""

import csv
import dataclasses
import io
import math

import pytest

from multibody_xval.engines.interface.variant import Variant
from multibody_xval.scenarios.runs.result import Result
from multibody_xval.scenarios.studies.accuracy import (
    ACCURACY_COLUMNS,
    ACCURACY_POINTS,
    Accuracy,
    accuracy_document,
    accuracy_of,
    accuracy_tasks,
    error_db,
    remark,
)
from multibody_xval.scenarios.tables import csv_text, full_table

VARIANT = Variant("mujoco")
EXACT = Result(
    status="converged", transmittance_db=-3.0, period=2.0, stuck_fraction=(0.5, 0.25), creep=(0.0, 0.0),
    transitions=((1, 0.5, "stick"), (1, 1.0, "forward slip"), (2, 1.9, "stick"), (2, 0.2, "backward slip")),
)  # fmt: skip


def accuracy(**changes) -> Accuracy:
    """The exact motion but for `changes`, at every question."""
    wrong = dataclasses.replace(EXACT, **changes)
    return accuracy_of(VARIANT, dict.fromkeys(accuracy_tasks(VARIANT), wrong), dict.fromkeys(ACCURACY_POINTS, EXACT))


def test_exact_motion_has_no_error() -> None:
    row = accuracy()
    assert (row.map_db, row.points_db[400], row.stuck_fraction, row.largest_transition, row.creep) == (0, 0, 0, 0, 0)
    assert (row.missed, row.spurious, row.transitions) == (0, 0, 4 * 56)
    assert row.certified == row.points == 68


def test_transmittance_error_is_absolute_in_decibels_and_an_amplitude_below_the_floor() -> None:
    assert accuracy(transmittance_db=-3.25).map_db == pytest.approx(0.25)
    deep = dataclasses.replace(EXACT, transmittance_db=-80.0)
    twice = dataclasses.replace(EXACT, transmittance_db=-80 + 20 * math.log10(2))
    amplitudes = (2e-4 - 1e-4) / 1e-3  # over the floor's, and dB at the floor are 20 / ln 10 times that
    assert error_db(twice, deep) == pytest.approx(20 / math.log(10) * amplitudes)


def test_late_transition_is_a_time_error_across_the_end_of_the_period_too() -> None:
    later = tuple((cell, (time + 0.02) % 2.0, kind) for cell, time, kind in EXACT.transitions)
    row = accuracy(transitions=later)
    assert row.median_transition == pytest.approx(0.01)
    assert row.largest_transition == pytest.approx(0.01)
    assert (row.missed, row.spurious) == (0, 0)


def test_transition_that_is_not_there_is_missed_and_an_added_one_is_spurious() -> None:
    assert accuracy(transitions=EXACT.transitions[1:]).missed == 56
    assert accuracy(transitions=(*EXACT.transitions, (1, 1.5, "stick"))).spurious == 56


def test_stuck_fraction_and_creep_take_the_worst_contact() -> None:
    row = accuracy(stuck_fraction=(0.5, 0.15), creep=(1e-9, 0.02))
    assert row.stuck_fraction == pytest.approx(0.1)
    assert row.creep == 0.02


@pytest.mark.parametrize("order", [0, 1, 2])
def test_order_is_that_of_the_error_in_the_time_step(order) -> None:
    answers = {
        q: dataclasses.replace(EXACT, transmittance_db=-3 + 50 / q.steps_per_period**order)
        for q in accuracy_tasks(VARIANT)
    }
    assert accuracy_of(VARIANT, answers, dict.fromkeys(ACCURACY_POINTS, EXACT)).order == pytest.approx(order, abs=1e-9)


def test_points_without_a_steady_state_are_counted_and_give_no_numbers() -> None:
    answers = {q: Result.blocked("crashed") if q.frequency_ratio == 0.9 else EXACT for q in accuracy_tasks(VARIANT)}
    row = accuracy_of(VARIANT, answers, dict.fromkeys(ACCURACY_POINTS, EXACT))
    assert row.certified < row.points
    assert math.isnan(row.order)
    assert row.map_db == 0
    assert "points are not certified; blocked: crashed" in remark(row)
    whole = accuracy_of(VARIANT, dict.fromkeys(answers, EXACT), dict.fromkeys(ACCURACY_POINTS, EXACT))
    assert whole.certified == whole.points
    assert "certified" not in remark(whole)
    nothing = accuracy_of(
        VARIANT, dict.fromkeys(answers, Result.blocked("gone")), dict.fromkeys(ACCURACY_POINTS, EXACT)
    )
    assert all(column.text(nothing) for column in ACCURACY_COLUMNS)
    assert "–" in accuracy_document([nothing], "command")


def test_tables_hold_every_column_and_name_the_command_and_the_versions() -> None:
    rows = [accuracy(transmittance_db=-3.25)]
    document = accuracy_document(rows, "multibody-xval run accuracy")
    assert "| mujoco | joint | tuned | 0.250 | 0.250 | 0.250 |" in document
    assert "`multibody-xval run accuracy`" in document
    assert "Versions: mujoco" in document
    read = list(csv.DictReader(io.StringIO(csv_text(full_table(ACCURACY_COLUMNS, rows)))))
    assert float(read[0]["map_db"]) == pytest.approx(0.25)
    assert list(read[0]) == [column.key for column in ACCURACY_COLUMNS]
