"""Levels that come with the suite are those that are proven, and the exact values of every report at their points."""

import math
from dataclasses import replace
from datetime import date
from decimal import Decimal

import pytest

from multibody_xval.reports.cli.console_script import app
from multibody_xval.reports.cli.ending import run_command
from multibody_xval.reports.cli.exit_code import ExitCode
from multibody_xval.scenarios.catalogue import edge_proofs, proofs
from multibody_xval.scenarios.compute.batch import run_batch
from multibody_xval.scenarios.model import EXACT, Case, linear_limits
from multibody_xval.scenarios.result_tables import points
from multibody_xval.scenarios.ruler.exact_values import exact_values, ruler
from multibody_xval.scenarios.ruler.proven import proven, proven_levels
from multibody_xval.scenarios.store import Stored

FLOATS = 1e-9
"""Largest distance of the event-driven motion from what is proven in amplitude, over that of the drive."""

CASE = Case(friction_ratio=0.3, frequency_ratio=0.9)

STILL = {Case(friction_ratio=0.0, frequency_ratio=1.0)}
"""The one standard case without a level: the last mass stands still."""

DAYS = 7
"""In which tests prove the whole table again; `multibody-xval run proofs` does it at once."""

NEAREST = 6
"""Levels that are closest to 0 dB, where the band begins: these are proven every day."""


def due(day: int) -> list[Case]:
    cases, levels = proofs.standard_cases(), proven_levels()
    nearest = sorted(levels.keys() & set(cases), key=lambda case: abs(levels[case].transmittance_db))[:NEAREST]
    return list(dict.fromkeys([*cases[day % DAYS :: DAYS], *nearest]))


@pytest.mark.slow
def test_this_days_part_of_the_table_is_proven_again() -> None:
    pytest.importorskip("flint", reason="it needs python-flint")
    table = proofs.proofs([proofs.proof_of(case) for case in due(date.today().toordinal())])
    assert table[~table.as_known].case.tolist() == []
    assert set(table[table.level.isna()].case) <= STILL
    assert table.float_error_db.max() <= 1e-8, "the event-driven motion, in decibels"
    assert table.float_error.max() <= FLOATS


def test_every_standard_point_is_proven_and_none_is_left_out_for_longer_than_a_week() -> None:
    every = {case for day in range(DAYS) for case in due(day)}
    assert every == set(proofs.standard_cases()) == {*proven_levels(), *STILL}


@pytest.mark.slow
def test_edges_of_the_band_lie_between_proven_levels(monkeypatch) -> None:
    """A band that began elsewhere would be noticed."""
    pytest.importorskip("flint", reason="it needs python-flint")
    edges = edge_proofs.edge_proofs()
    assert all(edge.crosses for edge in edges)
    assert [edge.friction_ratio for edge in edges if edge.alone] == [0, 0, 5]
    monkeypatch.setattr(edge_proofs, "EDGES", ((0.3, 0.6375),))
    assert not edge_proofs.edge_proofs()[0].crosses


def test_a_digit_that_is_wrong_is_noticed(monkeypatch, capsys) -> None:
    """The twentieth decimal of the one case that is drawn."""
    pytest.importorskip("flint", reason="it needs python-flint")
    drawn = ["run", "proofs", "--sample", "1", "--seed", "3"]
    (case,) = proofs.chosen_cases(1, 3)
    assert run_command(app, drawn) == ExitCode.DONE
    known = proven_levels()[case]
    spoilt = known._replace(transmittance_db=known.transmittance_db + 2 * proofs.RADIUS)
    monkeypatch.setattr(proofs, "proven_levels", lambda: {**proven_levels(), case: spoilt})
    assert run_command(app, drawn) == ExitCode.FAILED
    printed = capsys.readouterr()
    assert "not as in the table" in printed.out
    assert printed.err == "", "a bar is drawn in a terminal alone"


def test_what_is_proven_holds_for_every_amplitude_and_coefficient_of_friction_and_for_no_other_chain() -> None:
    changed = {replace(CASE, friction_ratio=0.31), replace(CASE, damping_ratio=0.02), replace(CASE, drive="force")}
    assert not changed & set(proven())
    others = [replace(CASE, displacement=1.0), replace(CASE, friction_coefficient=0.2)]
    other = replace(CASE, frequency_ratio=0.71)
    runs = ruler((case, 400) for case in [*others, other])
    assert {run.case for run in runs if run.config == EXACT} == {other}, "what is proven needs no exact motion"
    table = exact_values(points(Stored(run, "1", own) for run, own in zip(runs, run_batch(runs), strict=True)))
    assert dict(zip(table.case, table.exact_kind, strict=True)) == {**dict.fromkeys(others, "proven"), other: "exact"}
    assert set(table.exact[table.exact_kind == "proven"]) == {proven()[CASE]}
    level = Decimal(20 * math.log10(abs(proven()[CASE])))
    assert abs(level - proven_levels()[CASE].transmittance_db) <= Decimal(2.0**-45)


def test_linear_limits_in_closed_form_are_what_is_proven() -> None:
    """Without friction, and with contacts that never slide: no contact has a transition then."""
    free = [case for case in proven() if case.friction_ratio == 0]
    locked = [case for case in proven() if case.friction_ratio == 5 and case.cells == 3]
    assert (len(free) > 50, len(locked)) == (True, 2)
    for case, limit in [*((own, 0) for own in free), *((own, 1) for own in locked)]:
        assert not proven_levels()[case].events
        assert abs(linear_limits(case)[limit] - proven()[case]) <= FLOATS * max(1.0, abs(proven()[case]))
