"""Levels that come with the suite are those that are proven, and the truth of every report at their points."""

import random
from decimal import Decimal

import pytest

from engines.interface.variant import Variant
from reference_lcp.errors import ExitCode
from reference_lcp.process import run_command
from reports.cli.console_script import app
from scenarios.runs.parameters import ChainRatios, Excitation, Modulation, OperatingPoint
from scenarios.runs.result import Result
from scenarios.runs.store import opened_store
from scenarios.runs.task import SteadyStateTask
from scenarios.studies import proofs
from scenarios.studies.figure3 import FRICTION_RATIOS, QUICK_FRICTION_RATIOS, figure3, quick_frequency_ratios
from scenarios.sweeps.compared import compare_sweep
from scenarios.sweeps.proven import ROUNDED_DB, proven_level, proven_levels
from scenarios.sweeps.sweep import Case
from scenarios.sweeps.truths import with_truths
from scenarios.verdicts.steady_case import EXACT
from tests.scenarios.in_process import evaluator

FLOATS_DB = 1e-8
"""Largest distance of the event-driven motion from what is proven [dB], see docs/proof.md."""

STILL = {OperatingPoint(0.0, 1.0)}
"""The one standard point without a level: the last mass stands still."""


def check(points) -> None:
    found = [proofs.proof_of(point) for point in points]
    assert [proof.point for proof in found if not proof.in_table] == []
    assert {proof.point for proof in found if proof.proven is None} <= STILL
    assert all(not proof.float_error_db > FLOATS_DB for proof in found)


def test_a_sample_of_the_table_is_proven_again() -> None:
    pytest.importorskip("flint", reason="it needs python-flint")
    points = sorted(proven_levels())
    check(random.Random().sample(points, 4))


@pytest.mark.slow
def test_the_whole_table_is_proven_again() -> None:
    pytest.importorskip("flint", reason="it needs python-flint")
    check(proofs.standard_points())


@pytest.mark.slow
@pytest.mark.parametrize(
    ("frictions", "etas"),
    [(FRICTION_RATIOS, None), (QUICK_FRICTION_RATIOS, quick_frequency_ratios(ChainRatios()))],
    ids=["default", "quick"],
)
def test_every_point_of_a_report_is_a_standard_one(frictions, etas) -> None:
    """Also those that are added where a curve runs close to the threshold."""
    with opened_store(None) as store, evaluator(store) as running:
        compared = compare_sweep(figure3([], frictions, etas), running)
    truths = with_truths(compared).truths
    assert {place for place, truth in truths.items() if not truth.proven} == {(Case.of(friction_ratio=0.0), 1.0)}


@pytest.mark.slow
def test_edges_of_the_band_lie_between_proven_levels(monkeypatch) -> None:
    """A band that began elsewhere would be noticed."""
    pytest.importorskip("flint", reason="it needs python-flint")
    assert all(edge.crosses for edge in proofs.edge_proofs())
    monkeypatch.setattr(proofs, "EDGES", ((0.3, 0.6375),))
    assert not proofs.edge_proofs()[0].crosses


def test_all_standard_points_have_a_proven_level() -> None:
    assert set(proofs.standard_points()) - set(proven_levels()) == STILL


def test_a_digit_that_is_wrong_is_noticed(monkeypatch, capsys) -> None:
    """The twentieth decimal of the one point that is drawn."""
    pytest.importorskip("flint", reason="it needs python-flint")
    drawn = ["run", "proofs", "--sample", "1", "--seed", "3"]
    (point,) = proofs.chosen_points(1, 3)
    assert run_command(app, drawn) == ExitCode.DONE
    known = proven_levels()[point]
    spoilt = known._replace(transmittance_db=known.transmittance_db + Decimal("2e-20"))
    monkeypatch.setattr(proofs, "proven_levels", lambda: {**proven_levels(), point: spoilt})
    assert run_command(app, drawn) == ExitCode.FAILED
    assert "not as in the table" in capsys.readouterr().out


def task(**changes) -> SteadyStateTask:
    return SteadyStateTask(variant=EXACT, **{"friction_ratio": 0.3, "frequency_ratio": 0.9, **changes})


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


class Unasked:
    """Nothing is to be computed."""

    def evaluate(self, tasks) -> list[Result]:
        assert not tasks, "an exact motion is computed whose level is proven"
        return []


def test_the_truth_of_standard_points_is_proven_and_no_exact_motion_is_computed() -> None:
    sweep = figure3([Variant("mujoco")], [0.3], [0.7, 0.9])
    with opened_store(None) as store, evaluator(store) as running:
        compared = compare_sweep(sweep, running)
    truths = with_truths(compared, Unasked()).truths
    assert len(truths) == 2
    for (_, eta), truth in truths.items():
        known = proven_levels()[OperatingPoint(0.3, eta)]
        assert truth.proven
        assert truth.exact
        assert abs(Decimal(truth.transmittance_db) - known.transmittance_db) <= ROUNDED_DB == truth.error_db


def test_other_points_are_computed() -> None:
    sweep = figure3([], [0.3], [0.71])
    with opened_store(None) as store, evaluator(store) as running:
        compared = compare_sweep(sweep, running)
        (truth,) = with_truths(compared, running).truths.values()
    assert truth.exact
    assert not truth.proven


def test_rounding_of_a_level_is_what_is_stated() -> None:
    levels = [level.transmittance_db for level in proven_levels().values()]
    assert max(abs(Decimal(float(level)) - level) for level in levels) <= ROUNDED_DB
