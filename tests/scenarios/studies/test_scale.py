"""The scale of time: a default with a time constant errs otherwise at another frequency, a tuned preset does not."""

import math
from itertools import pairwise
from pathlib import Path

import pytest

from engines.interface.variant import Variant
from reports.export.tables import scale_table
from reports.figures.scale import scale_figure
from reports.plan import planned_report
from scenarios.runs.store import opened_store
from scenarios.studies.scale import STIFFNESSES, ScalePoint, scale_study, scaled_task
from scenarios.verdicts.steady_case import REFERENCE
from tests.scenarios.in_process import evaluator

ROOT = Path(__file__).parents[3]

DEFAULT, TUNED = Variant("mujoco", "joint", "default"), Variant("mujoco")
LEAST_DIFFERENCE = 1e-6
"""Of errors of a scheme that knows no scale [dB]: a steady state repeats to 1e-8."""


@pytest.fixture(scope="module")
def points() -> tuple[ScalePoint, ...]:
    with opened_store(None) as store, evaluator(store) as running:
        return scale_study((REFERENCE, TUNED, DEFAULT), running)


def errors(points: tuple[ScalePoint, ...], variant: Variant) -> list[float]:
    return [point.error_db for point in points if point.variant == variant]


def test_the_drive_runs_from_less_than_one_to_eighty_hertz(points: tuple[ScalePoint, ...]) -> None:
    hertz = [point.hertz for point in points if point.variant == DEFAULT]
    assert hertz == pytest.approx([0.8 * 1.0066 * math.sqrt(ratio / 0.01) for ratio in STIFFNESSES], rel=1e-4)


def test_ratios_of_the_chain_are_the_same_at_every_scale() -> None:
    """Friction over the force of a spring, damping and frequency: only the unit of time changes."""
    chains = [scaled_task(TUNED, ratio).setting() for ratio in STIFFNESSES]
    for chain, drive in chains:
        force = chain.chain_stiffness[0] * drive.amplitude
        assert chain.friction_bound / force == pytest.approx(0.1)
        assert drive.angular_frequency / chain.resonator_frequency == pytest.approx(1.6)
        damping = chain.chain_damping / (2 * math.sqrt(chain.chain_stiffness[0] * chain.outer_mass[0]))
        assert damping == pytest.approx(0.01)


@pytest.mark.parametrize("variant", [REFERENCE, TUNED], ids=str)
def test_what_is_tuned_errs_alike_at_every_frequency(points: tuple[ScalePoint, ...], variant: Variant) -> None:
    own = errors(points, variant)
    assert max(own) - min(own) < LEAST_DIFFERENCE


def test_mujoco_as_installed_errs_more_the_faster_the_motion(points: tuple[ScalePoint, ...]) -> None:
    """Its friction brings a velocity to zero within 20 ms: a tenth of a period at 5 Hz, and more than one at 80 Hz."""
    own = errors(points, DEFAULT)
    assert all(before < after for before, after in pairwise(own))
    assert (own[0], own[-1]) == pytest.approx((1.147, 32.17), rel=1e-3)


def test_the_readme_states_the_scale_of_its_headline(points: tuple[ScalePoint, ...]) -> None:
    text = " ".join((ROOT / "README.md").read_text(encoding="utf-8").split())
    own = errors(points, DEFAULT)
    assert "1 kg, 1 kN/m, 5 Hz" in text
    assert f"is {own[0]:.1f} dB off at 0.8 Hz and {own[-1]:.0f} dB at 80 Hz" in text


def test_the_default_report_has_the_scale_and_a_preview_has_not() -> None:
    planned = [planned_report((), None, quick=quick, stored_in=None).scope.scaled for quick in (False, True)]
    assert {DEFAULT, TUNED, Variant("mujoco", "joint", "recommended")} <= set(planned[0])
    assert planned[1] == ()


def test_without_variants_nothing_is_asked_for() -> None:
    assert scale_study((), None) == ()  # type: ignore[arg-type]


def test_figure_and_table_have_a_number_a_frequency(points: tuple[ScalePoint, ...]) -> None:
    compared = tuple(point for point in points if point.variant != REFERENCE)
    (axes,) = scale_figure(compared).canvas.axes
    assert [len(line.get_ydata()) for line in axes.get_lines()] == [len(STIFFNESSES)] * 2
    table = scale_table(compared)
    assert list(table.error_db) == [point.error_db for point in compared]


def test_what_has_no_steady_state_is_a_gap(points: tuple[ScalePoint, ...]) -> None:
    unsteady = tuple(ScalePoint(DEFAULT, point.hertz, math.nan) for point in points[:2])
    assert scale_figure((*unsteady, *points)).file("svg")
