"""How far engines are from their laws over a period: a row each, whatever becomes of the engine."""

import math

import pytest

from multibody_xval.engines.interface.variant import Variant
from multibody_xval.scenarios.model import REFERENCE
from multibody_xval.scenarios.studies import law_distances as study
from multibody_xval.scenarios.studies.law_distances import formulas, law_distances, shown

UNMODELLED = Variant("exudyn-bristle", "joint", "default")


@pytest.mark.needs("pymunk")
def test_an_engine_is_as_close_to_what_it_steps_by_as_the_contract_allows() -> None:
    table = law_distances([REFERENCE, Variant("pymunk"), Variant("pymunk", "joint", "default")])
    assert table.steps_by.tolist() == ["the reference's scheme", "a law"]
    assert table.points.tolist() == [18, 18]
    assert (table.largest <= table.allowed).all()
    assert (table.largest >= table["median"]).all()
    (line,) = formulas(table)
    assert line.startswith("pymunk:joint:default: ")


@pytest.mark.needs("pymunk")
def test_a_law_that_is_another_presets_is_far_from_the_engine(monkeypatch) -> None:
    own = study.stepped_by(Variant("pymunk", "joint", "default"))
    monkeypatch.setattr(study, "stepped_by", lambda _: own)
    assert max(study.period_distances(Variant("pymunk"))) > 1e3 * study.allowed_distance(Variant("pymunk"))


def test_a_preset_that_no_law_describes_has_a_row_that_says_why() -> None:
    row = law_distances([UNMODELLED]).iloc[0]
    assert (row.steps_by, row.points) == ("neither", 0)
    assert math.isnan(row.largest)
    assert "round-off decides" in row.reason
    assert shown(law_distances([UNMODELLED])).iloc[0]["largest [U0]"] == "–"


class Dies:
    """A pool whose worker ends."""

    def submit(self, _job):
        raise OSError("no such file")


@pytest.mark.needs("pymunk")
def test_an_engine_that_fails_is_the_reason_of_its_row() -> None:
    row = study._row(Variant("pymunk"), Dies())
    assert row["reason"] == "OSError: no such file"
    assert row["points"] == 0
