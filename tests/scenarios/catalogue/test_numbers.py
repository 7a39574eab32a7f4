"""Every scenario: what it says, and numbers of a box on a slope made by hand; runs that scenarios and reports plan."""

import re
from dataclasses import replace

import pytest

from multibody_xval.scenarios.catalogue.all_scenarios import SCENARIOS
from multibody_xval.scenarios.catalogue.numbers import numbers
from multibody_xval.scenarios.catalogue.scenes import scene
from multibody_xval.scenarios.model import REFERENCE, Config, Result, Run, Status
from multibody_xval.scenarios.report_plan import HEADLINE, HEADLINE_STEPS, grid, report_runs
from multibody_xval.scenarios.ruler.exact_values import ruler
from multibody_xval.scenarios.ruler.judge import AGREES, DEVIATES
from multibody_xval.scenarios.store import Stored
from tests.scenarios.in_this_process import OTHER

HOLD = SCENARIOS["slope-hold"]
SLOPE = replace(HOLD, cases={"load 0.5": HOLD.cases["load 0.5"]})

RECIPE, SOFT = Config("pybullet", "contact", "recommended"), Config("mujoco", "contact", "recommended")
"""Without a stated drift, and with one of 0.5 µm/s."""


def box(config: Config, drift: float) -> Stored:
    """Give the result of a box that has drifted along the slope by so many µm/s."""
    run = list(SLOPE.own_runs(config).values())[-1]
    way = 1e-6 * drift * scene.HOLDING
    rows = {"along": (way,), "across": (0.0,), "off": (1.0,), "from the start": (0.0, 0.0, 1.0)}
    return Stored(run, "1", Result(status=Status.FINISHED, series=rows))


def test_scenes_are_judged_of_recipes_alone_and_a_stated_drift_is_allowed() -> None:
    default = Config("mujoco", "contact", "default")
    assert HOLD.configs(["mujoco"]) == [default, SOFT]
    for config, drift, verdict in ((RECIPE, 0.2, DEVIATES), (SOFT, 0.55, AGREES), (SOFT, 0.7, DEVIATES)):
        table = numbers(SLOPE, [box(config, drift)])
        assert table.verdict.tolist() == [verdict, AGREES]
        assert table.value.tolist() == pytest.approx([drift, 0.0])
        assert table.judged.all()
    assert not numbers(SLOPE, [box(default, 0.0)]).judged.any()


def test_every_scenario_plans_the_runs_of_its_ruler_and_says_what_it_asks() -> None:
    """So that a number of a run that was planned is never unknown for want of another run."""
    for name, scenario in SCENARIOS.items():
        runs = scenario.runs([RECIPE if next(iter(scenario.cases.values())).cells == 0 else OTHER])
        assert len(set(runs)) == len(runs)
        steps = {run.steps for run in runs if run.config == REFERENCE}
        own = {run.steps for run in runs if run.config == OTHER}
        assert steps >= {factor * count for count in own for factor in (1, 2, 4, 8)} or not steps
        assert re.fullmatch(r"[a-z0-9]+(-[a-z0-9]+)*", name)
        assert (scenario.name, scenario.question[-1]) == (name, "?")
        assert scenario.source
        assert scenario.expects
        names = [quantity.name for quantity in scenario.quantities]
        assert len(set(names)) == len(names) > 0
        assert len(set(scenario.cases.values())) == len(scenario.cases) > 0


def test_every_preset_is_measured_at_the_headline_points_and_joints_on_the_grid_with_the_ruler() -> None:
    tuned, contact = Config("mujoco"), Config("mujoco", "contact")
    restless = replace(contact, preset_name="default")
    runs = report_runs([tuned, contact, restless], quick=True)
    of = {own: [run for run in runs if run.config == own] for own in (tuned, contact, restless)}
    assert of[contact] == [Run(contact, case, HEADLINE_STEPS) for case in HEADLINE]
    assert len(of[tuned]) == len(HEADLINE) + len(grid(True))
    assert of[restless] == [Run(restless, HEADLINE[0], HEADLINE_STEPS)], "it is known not to settle"
    assert set(ruler((run.case, run.steps) for run in of[tuned])) <= set(runs)
    assert len(runs) == len(set(runs))
