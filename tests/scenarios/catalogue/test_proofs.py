"""Levels that come with the suite are those that are proven, and the truth of every report at their points."""

import math
from dataclasses import replace
from datetime import date
from decimal import Decimal
from types import SimpleNamespace

import pytest

from multibody_xval.reports.cli.console_script import app
from multibody_xval.scenarios.catalogue import proofs
from multibody_xval.scenarios.catalogue.steady.den_hartog import DenHartog
from multibody_xval.scenarios.catalogue.steady.linear_limits import FrictionlessLimit, LockedLimit
from multibody_xval.scenarios.compute.batch import run_batch
from multibody_xval.scenarios.edges.finding import curves, hidden
from multibody_xval.scenarios.exact_values import exact_values, proven, ruler
from multibody_xval.scenarios.model import REFERENCE, Case, Run
from multibody_xval.scenarios.model import Result as CaseResult
from multibody_xval.scenarios.report_plan import grid
from multibody_xval.scenarios.result_tables import points
from multibody_xval.scenarios.runs.parameters import ChainRatios, Excitation, Modulation
from multibody_xval.scenarios.runs.task import SteadyStateTask
from multibody_xval.scenarios.store import Stored
from multibody_xval.scenarios.verdicts.proven import (
    ROUNDED_DB,
    chain_text,
    proven_level,
    proven_levels,
    steady_state_of,
)
from multibody_xval.scenarios.verdicts.steady_case import CONVERGED, EXACT
from reference_lcp.errors import ExitCode
from reference_lcp.process import run_command

FLOATS_DB = 1e-8
"""Largest distance of the event-driven motion from what is proven [dB], see docs/proof.md."""

FLOATS = 1e-9
"""The same in amplitude, over that of the drive; at a resonance of +52 dB this is 2e-11 dB."""


def task(**changes) -> SteadyStateTask:
    return SteadyStateTask(variant=EXACT, **{"friction_ratio": 0.3, "frequency_ratio": 0.9, **changes})


STILL = {task(friction_ratio=0.0, frequency_ratio=1.0)}
"""The one standard point without a level: the last mass stands still."""

DAYS = 7
"""In which tests prove the whole table again; `multibody-xval run proofs` does it at once."""

NEAREST = 6
"""Levels that are closest to 0 dB, where the band begins: these are proven every day."""


def due(day: int) -> list[SteadyStateTask]:
    tasks, levels = proofs.standard_tasks(), proven_levels()
    nearest = sorted(levels.keys() & set(tasks), key=lambda task: abs(levels[task].transmittance_db))[:NEAREST]
    return list(dict.fromkeys([*tasks[day % DAYS :: DAYS], *nearest]))


def check(tasks) -> None:
    found = [proofs.proof_of(task) for task in tasks]
    assert [proof.label for proof in found if not proof.in_table] == []
    assert {proof.task for proof in found if proof.proven is None} <= STILL
    assert all(not proof.float_error_db > FLOATS_DB for proof in found)
    assert all(not proof.float_error > FLOATS for proof in found)


@pytest.mark.slow
def test_this_days_part_of_the_table_is_proven_again() -> None:
    pytest.importorskip("flint", reason="it needs python-flint")
    check(due(date.today().toordinal()))


def test_no_standard_point_is_left_out_for_longer_than_a_week() -> None:
    assert {task for day in range(DAYS) for task in due(day)} == set(proofs.standard_tasks())


@pytest.mark.slow
@pytest.mark.parametrize("quick", [True, False])
def test_every_point_of_a_report_is_a_standard_one(quick: bool) -> None:
    """Also those that are added where a curve runs close to the threshold."""
    runs = [Run(REFERENCE, case, case.steps()) for case in grid(quick)]
    known: dict[Run, CaseResult] = {}
    while runs:
        known.update(zip(runs, run_batch(runs), strict=True))
        table = points(Stored(run, "1", own) for run, own in known.items())
        near = [replace(curve.case, frequency_ratio=eta) for curve in curves(table) for eta in hidden(curve)]
        added = [Run(REFERENCE, case, case.steps()) for case in near]
        runs = [run for run in added if run not in known]
    lacking = {run.case for run in known} - set(proven())
    assert lacking == {Case(friction_ratio=0.0, frequency_ratio=1.0)}


@pytest.mark.slow
def test_edges_of_the_band_lie_between_proven_levels(monkeypatch) -> None:
    """A band that began elsewhere would be noticed."""
    pytest.importorskip("flint", reason="it needs python-flint")
    edges = proofs.edge_proofs()
    assert all(edge.crosses for edge in edges)
    assert [edge.friction_ratio for edge in edges if edge.alone] == [0, 0, 5]
    monkeypatch.setattr(proofs, "EDGES", ((0.3, 0.6375),))
    assert not proofs.edge_proofs()[0].crosses


def test_all_standard_steady_states_have_a_proven_level() -> None:
    assert set(proofs.standard_tasks()) - set(proven_levels()) == STILL


def test_a_digit_that_is_wrong_is_noticed(monkeypatch, capsys) -> None:
    """The twentieth decimal of the one point that is drawn."""
    pytest.importorskip("flint", reason="it needs python-flint")
    drawn = ["run", "proofs", "--sample", "1", "--seed", "3"]
    (drawn_task,) = proofs.chosen_tasks(1, 3)
    assert run_command(app, drawn) == ExitCode.DONE
    known = proven_levels()[drawn_task]
    spoilt = known._replace(transmittance_db=known.transmittance_db + Decimal("2e-20"))
    monkeypatch.setattr(proofs, "proven_levels", lambda: {**proven_levels(), drawn_task: spoilt})
    assert run_command(app, drawn) == ExitCode.FAILED
    assert "not as in the table" in capsys.readouterr().out


@pytest.mark.parametrize(
    "changes",
    [
        {"friction_ratio": 0.31},
        {"frequency_ratio": 0.90001},
        {"ratios": ChainRatios(cells=6)},
        {"ratios": ChainRatios(damping_ratio=0.02)},
        {"excitation": Excitation(kind="force", amplitude=1.0)},
        {"modulation": Modulation(modulation=0.5)},
        {"friction_ratio": (0.3,) * 7},
    ],
)
def test_nothing_is_proven_of_another_chain(changes) -> None:
    assert proven_level(task(**changes)) is None


def test_levels_over_the_displacement_scale_hold_for_every_amplitude() -> None:
    assert proven_level(task(excitation=Excitation(amplitude=1.0))) == proven_level(task())
    assert proven_level(task(ratios=ChainRatios(friction_coefficient=0.2))) == proven_level(task())


def test_other_chains_of_the_catalogue_have_a_proven_level() -> None:
    """Each with its own ratios, one a cell where cells differ, and a modulated normal force."""
    chains = {chain_text(task) for task in proven_levels()}
    assert '{"ratios": {"cells": 50}}' in chains
    assert '{"modulation": {"modulation": 0.5, "multiple": 2, "phase": 0.0}}' in chains
    assert any('mass_ratio": [0.75' in chain for chain in chains)


def test_closed_forms_of_the_catalogue_are_what_is_proven() -> None:
    """Of linear chains to round-off, of Den Hartog's standing mass to twice what it moves, amplified."""
    for scenario in (FrictionlessLimit(), LockedLimit(), DenHartog()):
        for case in scenario.cases:
            level, closed = proven_level(case.task(EXACT)), scenario.expected(case, [])
            assert level is not None
            assert abs(float(level.transmittance_db) - closed.transmittance_db) <= 2 * closed.bar_db + FLOATS_DB
            phase = math.remainder(float(level.phase) - closed.phase, 2 * math.pi)
            assert abs(phase) <= 2 * math.radians(closed.phase_bar) + FLOATS_DB


def test_every_search_for_a_steady_state_asks_for_the_same_one() -> None:
    assert steady_state_of(replace(task(), variant=CONVERGED, steps_per_period=800)) == task()


def test_floating_point_loses_decibels_in_a_deep_antiresonance_but_no_amplitude() -> None:
    """A level of −240 dB is off by more than its digits, and its amplitude by less than a rounding of the drive's."""
    pytest.importorskip("flint", reason="it needs python-flint")
    deep = proofs.proof_of(task(friction_ratio=0.0, frequency_ratio=1.01))
    assert deep.proven is not None
    assert float(abs(Decimal(deep.float_db) - deep.proven.transmittance_db.value)) > 1e-6
    assert deep.float_error < 2**-53


def test_rounding_of_a_level_is_what_is_stated() -> None:
    levels = [level.transmittance_db for level in proven_levels().values()]
    assert max(abs(Decimal(float(level)) - level) for level in levels) <= ROUNDED_DB


def test_a_steady_state_counts_as_unique_where_dashpots_make_it_so() -> None:
    pytest.importorskip("flint", reason="it needs python-flint")
    from reference_lcp.exact.proof.prove import Uniqueness

    states = [SimpleNamespace(unique_by=by) for by in (Uniqueness.DAMPING, Uniqueness.NOT_SHOWN)]
    found = [SimpleNamespace(proven=state) for state in (*states, states[0], None)]
    (unique,) = (column for column in proofs.PROOF_COLUMNS if column.key == "unique")
    assert unique.value(found) == 2


def test_the_exact_value_of_standard_points_is_proven_and_no_exact_motion_is_planned() -> None:
    known, other = (Case(friction_ratio=0.3, frequency_ratio=eta) for eta in (0.7, 0.71))
    runs = ruler([(known, 400), (other, 400)])
    assert {run.case for run in runs if run.config == EXACT} == {other}
    table = exact_values(points(Stored(run, "1", own) for run, own in zip(runs, run_batch(runs), strict=True)))
    assert dict(zip(table.case, table.exact_kind, strict=True)) == {known: "proven", other: "exact"}
    level = proven_levels()[task(frequency_ratio=0.7)].transmittance_db
    assert abs(Decimal(20 * math.log10(abs(table.exact[0]))) - level) <= ROUNDED_DB
