"""Band edges of presets that share the Euler scheme: at equal step, a chain that is a little wrong is found out."""

import dataclasses

import numpy as np
import pytest

from multibody_xval.engines.interface.variant import Variant
from multibody_xval.scenarios.runs.result import Result
from multibody_xval.scenarios.runs.store import opened_store
from multibody_xval.scenarios.studies.figure3 import figure3
from multibody_xval.scenarios.sweeps.attenuation_band import EDGE_RESOLUTION, Edge
from multibody_xval.scenarios.sweeps.compared import ComparedSweep, compare_sweep
from multibody_xval.scenarios.sweeps.edges import BandEdge
from multibody_xval.scenarios.sweeps.refinement import EDGE_RESIDUAL, decided_db
from multibody_xval.scenarios.sweeps.sweep import GivenTolerance
from multibody_xval.scenarios.verdicts.finding import Verdict
from multibody_xval.scenarios.verdicts.steady_case import REFERENCE
from tests.scenarios.in_process import evaluator, misread_the_chain

TWIN = Variant("mujoco")
"""The reference in place of an engine that shares its scheme."""

GRID = (0.55, 0.62, 0.66, 0.8, 0.8505, 0.9, 1.1, 1.4, 1.422)
"""Frequency ratios with both edges of the chain without friction between them, and the lower one of the other."""

FRICTION_RATIOS = (0.0, 0.3)
EDGES = 3


def compared(given: GivenTolerance | None = None) -> ComparedSweep:
    sweep = dataclasses.replace(figure3((TWIN,), FRICTION_RATIOS, GRID), tolerance=given)
    with opened_store(None) as store, evaluator(store) as running:
        return compare_sweep(sweep, running)


@pytest.fixture(scope="module")
def sound() -> ComparedSweep:
    """What comes out where the twin is the reference in everything."""
    with pytest.MonkeyPatch.context() as patched:
        misread_the_chain(patched)
        return compared()


def edges_of(result: ComparedSweep, variant: Variant = TWIN) -> list[BandEdge]:
    every = [result.edge(variant, case, edge) for case in result.cases for edge in Edge]
    edges = [edge for edge in every if edge.frequency_ratio is not None]
    assert len(edges) == EDGES
    return edges


def test_an_engine_that_is_the_reference_has_its_edges_to_what_neither_resolves(sound) -> None:
    for own, reference in zip(edges_of(sound), edges_of(sound, REFERENCE), strict=True):
        assert own.comparison.verdict is Verdict.AGREE
        assert own.frequency_ratio == pytest.approx(reference.frequency_ratio, abs=EDGE_RESOLUTION / 100)
        assert own.comparison.tolerance <= 2.1 * EDGE_RESOLUTION


@pytest.mark.slow
@pytest.mark.parametrize(
    ("factors", "disagreeing"),
    [
        ({"outer_mass": 1.005, "inner_mass": 1.005}, 3),
        ({"outer_mass": 1.00001, "inner_mass": 1.00001}, 3),
        ({"chain_damping": 1.1}, 2),
        ({"chain_damping": 1.001}, 2),
        ({"normal_force": 0.95}, 1),
        ({"normal_force": 0.9995}, 1),
    ],
)
def test_a_small_error_of_a_parameter_moves_edges_beyond_what_is_allowed(monkeypatch, factors, disagreeing) -> None:
    misread_the_chain(monkeypatch, **factors)
    edges = edges_of(compared())
    assert sum(edge.comparison.verdict is Verdict.DISAGREE for edge in edges) >= disagreeing


def test_a_baseline_that_is_given_is_that_of_edges_too(monkeypatch) -> None:
    misread_the_chain(monkeypatch)
    result = compared(GivenTolerance(transmittance_db=0.001, baseline=REFERENCE))
    assert max(abs(edge.comparison.difference) for edge in edges_of(result)) < EDGE_RESOLUTION / 100


def test_the_reference_itself_is_compared_with_the_converged_one_by_its_own_steps(sound) -> None:
    for edge in edges_of(sound, REFERENCE):
        assert edge.comparison.verdict is Verdict.AGREE
        assert abs(edge.comparison.difference) > 2 * EDGE_RESOLUTION


@pytest.mark.parametrize(("residual", "decides"), [(EDGE_RESIDUAL, True), (1.001 * EDGE_RESIDUAL, False)])
def test_a_search_that_has_come_close_decides_an_edge(residual: float, decides: bool) -> None:
    level = decided_db(Result(status="period limit", transmittance_db=-3.0, residual=residual, period=1.0))
    assert level == -3.0 if decides else np.isnan(level)
