"""What a report measures where, as a function of configurations alone."""

from multibody_xval.engines.interface.variant import Variant
from multibody_xval.scenarios.model import Config, Run
from multibody_xval.scenarios.report_plan import HEADLINE, HEADLINE_STEPS, grid, report_runs
from multibody_xval.scenarios.ruler.exact_values import ruler

TUNED = Config("mujoco")
DEFAULT = Config("mujoco", preset_name="default")
CONTACT = Config("mujoco", "contact")
UNSETTLED = Config("mujoco", "contact", "default")


def of(config: Variant, runs: list[Run]) -> list[Run]:
    return [run for run in runs if run.config == config]


def test_every_preset_is_measured_at_the_headline_points_and_joints_on_the_grid_with_the_ruler() -> None:
    runs = report_runs([TUNED, DEFAULT, CONTACT, UNSETTLED], quick=True)
    assert of(CONTACT, runs) == [Run(CONTACT, case, HEADLINE_STEPS) for case in HEADLINE]
    assert len(of(TUNED, runs)) == len(of(DEFAULT, runs)) == len(HEADLINE) + len(grid(True))
    assert of(UNSETTLED, runs) == [Run(UNSETTLED, HEADLINE[0], HEADLINE_STEPS)]
    assert set(ruler((run.case, run.steps) for run in of(TUNED, runs))) <= set(runs)
    assert len(runs) == len(set(runs))
