"""How well laws predict engines, as a table."""

import math

import pytest

from multibody_xval.engines.interface.variant import Variant
from multibody_xval.scenarios.runs.result import Result
from multibody_xval.scenarios.runs.store import opened_store
from multibody_xval.scenarios.runs.task import Recorded
from multibody_xval.scenarios.studies.law_agreement import (
    LAW_COLUMNS,
    LawAgreement,
    beside_the_reference,
    law_agreements,
    law_document,
)
from multibody_xval.scenarios.tables import csv_text, full_table
from tests.scenarios.in_process import evaluator

SOFT, UNMODELLED = Variant("mujoco", "joint", "default"), Variant("exudyn-bristle", "joint", "default")


LEVELS = {"mujoco": -7.0, "exudyn-bristle": -9.0, "reference": -10.0, "mujoco@law": -7.25}


class Known:
    """Gives numbers that are known: the engine 3 dB beside the reference, its law 0.25 dB beside the engine."""

    def evaluate(self, tasks):
        return [self.result(task) for task in tasks]

    def result(self, task):
        if task.recorded is Recorded.LAW:
            return Result(status="finished", series={"distance": (task.frequency_ratio,), "reference": (1.0,)})
        certified = task.variant.engine != "mujoco" or task.friction_ratio < 1
        return Result(
            status="converged" if certified else "period limit",
            transmittance_db=LEVELS[task.variant.engine],
            stuck_fraction=(0.5 if "@" in task.variant.engine else 0.25,) * 7,
        )


def rows() -> list[LawAgreement]:
    return law_agreements([SOFT, UNMODELLED], Known())


def test_row_has_deviation_what_the_law_leaves_and_the_distance_of_a_period() -> None:
    soft, unmodelled = rows()
    assert (soft.deviation, soft.error, soft.stuck_fraction, soft.certified) == (3.0, 0.25, 0.25, 12)
    assert sorted(set(soft.period)) == [0.5, 0.7, 0.9, 1.1, 1.3, 1.5]
    assert (unmodelled.deviation, unmodelled.certified) == (1.0, 18)
    assert math.isnan(unmodelled.error)
    assert "round-off decides" in unmodelled.reason


def test_every_preset_but_those_of_the_reference_has_a_row() -> None:
    assert beside_the_reference([Variant("reference"), Variant("mujoco"), SOFT]) == [Variant("mujoco"), SOFT]


@pytest.mark.needs("pymunk")
def test_preset_that_takes_the_step_of_the_reference_is_beside_it_what_others_are_beside_their_law() -> None:
    with opened_store(None) as store, evaluator(store) as running:
        (shares,) = law_agreements([Variant("pymunk")], running)
    assert shares.deviation == shares.error < 1e-6
    assert len(shares.period) == shares.certified == 18
    assert max(shares.period) <= shares.bound


def test_document_and_csv_hold_every_row() -> None:
    text = law_document(rows(), "multibody-xval run laws")
    assert "| mujoco:joint:default | a law | 3 | 2.5e-01 | 0.25 | 1.5e+00 |" in text
    assert "round-off decides" in text
    assert len(csv_text(full_table(LAW_COLUMNS, rows())).splitlines()) == 3


@pytest.mark.slow
def test_the_law_of_mujoco_predicts_its_soft_friction_at_eighteen_points() -> None:
    with opened_store(None) as store, evaluator(store) as running:
        (soft,) = law_agreements([SOFT], running)
    assert soft.certified == 18
    assert soft.deviation > 10
    assert soft.error < 1e-5
    assert max(soft.period) <= soft.bound
