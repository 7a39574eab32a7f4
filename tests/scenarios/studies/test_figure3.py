"""Figure 3: the paper's three claims, on the reference and on every engine; edges against the converged scheme."""

import functools

import numpy as np
import pytest
from scipy.optimize import brentq

from multibody_xval.engines.interface.registry import default_engine_names
from multibody_xval.engines.interface.variant import Variant
from multibody_xval.scenarios.runs.evaluator import Evaluator
from multibody_xval.scenarios.runs.executor import run_batch
from multibody_xval.scenarios.runs.local_processes import LocalExecutor
from multibody_xval.scenarios.runs.parameters import ChainRatios
from multibody_xval.scenarios.runs.store import ResultStore
from multibody_xval.scenarios.studies.figure3 import default_frequency_ratios, figure3, quick_frequency_ratios
from multibody_xval.scenarios.sweeps.attenuation_band import Edge
from multibody_xval.scenarios.sweeps.compared import compare_sweep
from multibody_xval.scenarios.sweeps.refinement import resonances
from multibody_xval.scenarios.sweeps.sweep import Case
from multibody_xval.scenarios.verdicts.finding import Verdict
from multibody_xval.scenarios.verdicts.steady_case import CONVERGED, REFERENCE
from reference_lcp.chain.drives import HarmonicBase
from reference_lcp.chain.linear_response import frictionless_transmittance
from reference_lcp.errors import ParameterError

CONVERGED_LOWER_EDGES = {0.1: 0.753, 0.3: 0.637, 0.6: 0.756, 1.0: 0.999, 5.0: 1.17}
"""Of the scheme for Δt → 0, to the digits given; the frictionless edge has a closed form instead."""

SUPPORT = {
    0.0: (0.8, 0.8505, 0.9, 1.1, 1.4, 1.422),
    0.1: (0.7, 0.74, 0.8, 0.9),
    0.3: (0.55, 0.62, 0.66, 0.9, 1.1),
    0.6: (0.7, 0.8, 0.9, 1.1, 1.2),
    1.0: (0.9, 0.975, 0.9875, 1.025, 1.1, 1.3),
    5.0: (1.1, 1.1441, 1.2, 1.2919, 1.36),
}
"""Points of the grid that bracket the edges of each friction ratio, so that engines need not answer all."""


SLOW = ("exudyn-bristle", "exudyn-regularised", "pybullet")
"""Engines whose edges take seconds: a period takes Exudyn tenths of one, and every edge is searched at a second step
too; PyBullet takes the reference's steps, as MuJoCo does, and longer."""


@pytest.fixture(scope="module")
def edges_of(tmp_path_factory):
    """Edges of an engine, the reference and its converged preset, each friction ratio on its own few points.

    They are searched once an engine; those of the reference are in the store after the first.
    """
    with (
        ResultStore(tmp_path_factory.mktemp("store") / "results.sqlite") as store,
        Evaluator(store, LocalExecutor(2)) as evaluator,
    ):

        @functools.cache
        def searched(name):
            edges = {}
            for friction, support in SUPPORT.items():
                sweep = figure3([Variant(name)], (friction,), support)
                for edge in compare_sweep(sweep, evaluator).edges:
                    edges[edge.variant, friction, edge.edge] = edge
            return edges

        yield searched


every_engine = pytest.mark.parametrize(
    "name",
    [
        pytest.param(name, marks=[pytest.mark.needs(name), *([pytest.mark.slow] if name in SLOW else [])])
        for name in default_engine_names()
    ],
)


@pytest.mark.slow
@every_engine
def test_claim_1_band_is_wider_for_friction_ratios_up_to_0_6_than_for_none(edges_of, name) -> None:
    def lower(friction):
        return edges_of(name)[Variant(name), friction, Edge.LOWER].frequency_ratio

    def upper(friction):
        return edges_of(name)[Variant(name), friction, Edge.UPPER].frequency_ratio

    for friction in (0.1, 0.3, 0.6):
        assert lower(friction) < lower(0.0)
        assert upper(friction) is None or upper(friction) > upper(0.0)


@every_engine
def test_claim_2_band_is_widest_at_0_3(edges_of, name) -> None:
    lower = {friction: edges_of(name)[Variant(name), friction, Edge.LOWER].frequency_ratio for friction in SUPPORT}
    assert min(lower, key=lower.get) == 0.3


@every_engine
def test_claim_3_first_cut_off_moves_up_when_cells_lock(edges_of, name) -> None:
    lower = [edges_of(name)[Variant(name), friction, Edge.LOWER].frequency_ratio for friction in (0.3, 0.6, 1.0, 5.0)]
    assert lower == sorted(lower)
    assert lower[-1] > edges_of(name)[Variant(name), 0.0, Edge.LOWER].frequency_ratio


@every_engine
def test_every_edge_is_within_the_tolerance_of_the_converged_one(edges_of, name) -> None:
    own = [edge for (variant, _, _), edge in edges_of(name).items() if variant == Variant(name)]
    assert len(own) == 2 * len(SUPPORT)
    assert {edge.comparison.verdict for edge in own} == {Verdict.AGREE}


@pytest.mark.parametrize("friction", CONVERGED_LOWER_EDGES)
def test_lower_edges_of_the_reference_converge_to_the_published_ones(edges_of, friction) -> None:
    for variant in (REFERENCE, CONVERGED):
        eta = edges_of("reference")[variant, friction, Edge.LOWER].frequency_ratio
        assert eta == pytest.approx(CONVERGED_LOWER_EDGES[friction], abs=0.003)


def linear_edge(low: float, high: float) -> float:
    """η_r between `low` and `high` at which the closed form of the chain without friction is 0 dB."""
    chain = ChainRatios().chain(0.0)
    return brentq(lambda eta: frictionless_transmittance(chain, HarmonicBase.from_ratio(chain, eta)) - 1, low, high)


def test_frictionless_edges_of_the_reference_are_those_of_the_linear_response(edges_of) -> None:
    lower, upper = linear_edge(0.8505, 0.8686), linear_edge(1.4, 1.422)
    assert (lower, upper) == pytest.approx((0.8526, np.sqrt(2)), abs=2e-4)
    assert edges_of("reference")[CONVERGED, 0.0, Edge.LOWER].frequency_ratio == pytest.approx(lower, abs=2e-4)
    assert edges_of("reference")[CONVERGED, 0.0, Edge.UPPER].frequency_ratio == pytest.approx(upper, abs=1e-3)


def test_grid_holds_every_resonance_and_the_ends() -> None:
    ratios = ChainRatios()
    grid, peaks = default_frequency_ratios(ratios), resonances(ratios)
    assert peaks.size == 21
    assert (grid[0], grid[-1]) == (0.1, 3.0)
    assert np.max(np.min(np.abs(np.subtract.outer(peaks, grid)), axis=1)) < 1e-4
    quick = quick_frequency_ratios(ratios)
    assert len(quick) < len(grid) / 5
    assert {0.8505, 0.8686, 1.422} <= set(quick)


def test_every_point_is_compared_and_reports_its_residual(tmp_path) -> None:
    sweep = figure3((Variant("mujoco"),), (0.3,), (0.6, 0.9, 1.6))
    with ResultStore(tmp_path / "results.sqlite") as store, Evaluator(store, LocalExecutor(1)) as evaluator:
        result = compare_sweep(sweep, evaluator)
    for variant in (CONVERGED, REFERENCE, Variant("mujoco")):
        curve = result.curve(variant, Case.of(friction_ratio=0.3))
        assert [point.comparison.verdict for point in curve] == [Verdict.AGREE] * len(curve)
        assert all(point.result.residual <= 1e-8 for point in curve)
    eta, line = result.dense_reference[Case.of(friction_ratio=0.3)]
    assert eta.shape == line.shape == (101,)


@pytest.mark.parametrize(
    ("wrong", "message"),
    [
        ({"friction_ratios": (0.3, 0.1)}, "friction_ratios = .*ascending"),
        ({"friction_ratios": (-0.1,)}, "friction_ratios = -0.1"),
        ({"frequency_ratios": ()}, "at least one value"),
        ({"frequency_ratios": (0.0, 1.0)}, "frequency_ratios = 0"),
        ({"steps_per_period": 0}, "steps_per_period = 0"),
        ({"variants": (Variant("bullet"),)}, "engine = 'bullet' is unknown"),
        ({"variants": (Variant("mujoco", preset_name="best"),)}, "preset of mujoco = 'best' is unknown"),
    ],
)
def test_impossible_question_is_refused(wrong, message) -> None:
    with pytest.raises(ParameterError, match=message):
        figure3(**wrong)


@pytest.mark.parametrize("text", ["mujoco", "mujoco:contact", "mujoco:joint:default", "pybullet:contact:default"])
def test_variant_is_read_as_it_is_written(text) -> None:
    assert str(Variant.parse(text)) == text


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("bullet", "engine = 'bullet' is unknown"),
        ("mujoco:glue", "formulation of mujoco = 'glue' is unknown; allowed: joint, contact"),
        ("mujoco:joint:best", "preset of mujoco = 'best' is unknown; allowed: tuned, recommended, default"),
        ("mujoco:joint:tuned:now", "has 4 parts"),
    ],
)
def test_variant_that_there_is_not_is_refused(text, message) -> None:
    with pytest.raises(ParameterError, match=message):
        Variant.parse(text)


@pytest.mark.slow
@pytest.mark.parametrize(
    "name",
    [
        "reference",
        pytest.param(
            "mujoco",
            marks=[pytest.mark.slow, pytest.mark.needs("mujoco")],
        ),
    ],
)
def test_eighty_periods_find_the_steady_state_of_all_but_one_point_in_a_hundred(name) -> None:
    """On the grid of the report, with every resonance of the free and of the stuck chain."""
    sweep = figure3()
    points = [(case, eta) for case in sweep.cases for eta in sweep.frequency_ratios]
    answers = run_batch([sweep.task(Variant(name), *point) for point in points])
    assert len(answers) > 370
    assert all(answer.converged for answer in answers)
    assert np.percentile([answer.periods for answer in answers], 99) <= 80
