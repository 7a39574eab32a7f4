"""What a report measures where, as a function of configurations alone."""

from multibody_xval.engines.interface.variant import Variant
from multibody_xval.scenarios import report_plan
from multibody_xval.scenarios.model import Case, Config, Run
from multibody_xval.scenarios.report_plan import (
    HEADLINE,
    HEADLINE_STEPS,
    claim_frequency_ratios,
    frictions,
    grid,
    grid_cases,
    headline_cases,
    left_out,
    report_runs,
)
from multibody_xval.scenarios.ruler.exact_values import ruler

TUNED = Config("mujoco")
DEFAULT = Config("mujoco", preset_name="default")
CONTACT = Config("mujoco", "contact")
UNSETTLED = Config("mujoco", "contact", "default")
SLOW = Config("exudyn-regularised")
SLOW_DEFAULT = Config("exudyn-regularised", preset_name="default")
SLOWEST = Config("exudyn-regularised", "contact", "default")


def of(config: Variant, runs: list[Run]) -> list[Run]:
    return [run for run in runs if run.config == config]


def test_every_preset_is_measured_at_the_headline_points_and_joints_on_the_grid_with_the_ruler() -> None:
    runs = report_runs([TUNED, DEFAULT, CONTACT, UNSETTLED], quick=True)
    assert of(CONTACT, runs) == [Run(CONTACT, case, HEADLINE_STEPS) for case in HEADLINE]
    assert len(of(TUNED, runs)) == len(of(DEFAULT, runs)) == len(HEADLINE) + len(grid(True))
    assert of(UNSETTLED, runs) == [Run(UNSETTLED, HEADLINE[0], HEADLINE_STEPS)]
    assert set(ruler((run.case, run.steps) for run in of(TUNED, runs))) <= set(runs)
    assert len(runs) == len(set(runs))


def test_slow_engines_are_measured_where_claims_and_edges_need_it() -> None:
    own = grid_cases(SLOW, quick=False)
    assert [case for case in own if case.friction_ratio == 0.1] == [
        Case(friction_ratio=0.1, frequency_ratio=eta) for eta in claim_frequency_ratios()
    ]
    assert {case.friction_ratio for case in own} == set(report_plan.FRICTION_RATIOS)
    assert grid_cases(TUNED, quick=False) == list(grid(False))
    assert frictions(SLOW_DEFAULT, quick=False) == report_plan.QUICK_FRICTION_RATIOS
    assert (frictions(SLOW, quick=True), frictions(SLOW_DEFAULT, quick=True)) == ((0.3,), ())
    assert headline_cases(SLOWEST) == HEADLINE[:1]


def test_what_is_left_out_is_said_with_the_command_that_has_it() -> None:
    said = left_out([TUNED, SLOW, UNSETTLED], quick=True)
    assert "friction ratios 0.1, 0.6, 5" in said
    assert said.count("multibody-xval report") == 1
    assert left_out([TUNED], quick=False) == ""
