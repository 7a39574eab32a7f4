"""Motions that are stretched deviate, and ones of too large a time step show nothing, in every family."""

from dataclasses import replace

import pytest

from multibody_xval.scenarios.catalogue.blocks.direction import DIRECTION
from multibody_xval.scenarios.catalogue.blocks.published import PUBLISHED
from multibody_xval.scenarios.catalogue.blocks.static_friction import STATIC_ABOVE_KINETIC
from multibody_xval.scenarios.catalogue.blocks.thrown import STOPPING_DISTANCE
from multibody_xval.scenarios.catalogue.chains.broadband import RICKER_PULSE
from multibody_xval.scenarios.catalogue.chains.free_decay import FREE_DECAY
from multibody_xval.scenarios.catalogue.chains.long_run import LONG_RUN
from multibody_xval.scenarios.catalogue.scenario import steps_a_row
from multibody_xval.scenarios.model import Result
from multibody_xval.scenarios.ruler.judge import AGREES, DEVIATES, TOO_LARGE
from tests.scenarios.in_this_process import OTHER, SHARES, judged_copy, only


def first(scenario):
    """Give the first case alone."""
    name, case = next(iter(scenario.cases.items()))
    return replace(scenario, cases={name: case})


MOTIONS = [
    *(first(own) for own in (PUBLISHED, FREE_DECAY, STOPPING_DISTANCE, DIRECTION, RICKER_PULSE)),
    only(STATIC_ABOVE_KINETIC, "1 kg, 1.5"),
]


def stretched(part: float):
    """Stretch all series by a part."""

    def spoil(result: Result) -> Result:
        series = {name: tuple((1 + part) * number for number in own) for name, own in result.series.items()}
        return replace(result, series=series)

    return spoil


@pytest.mark.parametrize("config", [SHARES, OTHER])
@pytest.mark.parametrize("scenario", MOTIONS, ids=lambda own: own.name)
def test_a_motion_that_is_stretched_by_a_half_deviates(scenario, config) -> None:
    assert set(judged_copy(scenario, config).verdict) == {AGREES}
    assert DEVIATES in set(judged_copy(scenario, config, spoil=stretched(0.5)).verdict)


def test_a_long_run_that_is_off_by_a_millionth_deviates_at_equal_steps() -> None:
    """It is 640 times as long as a period of the contract, and round-off grows as the root of the number of steps."""
    assert set(judged_copy(LONG_RUN, SHARES).verdict) == {AGREES}
    assert set(judged_copy(LONG_RUN, SHARES, spoil=stretched(1e-6)).verdict) == {DEVIATES}
    assert set(judged_copy(LONG_RUN, OTHER, spoil=stretched(0.05)).verdict) == {DEVIATES}


@pytest.mark.parametrize(
    ("scenario", "steps"), [(only(RICKER_PULSE, "= 0.1"), 4), (only(FREE_DECAY, "inner"), 1)], ids=["pulse", "decay"]
)
def test_a_time_step_that_leaves_out_what_friction_does_shows_nothing(scenario, steps) -> None:
    table = judged_copy(replace(scenario, steps=steps_a_row(steps)), OTHER)
    assert set(table.verdict) == {AGREES, TOO_LARGE}
    assert set(judged_copy(scenario, OTHER).verdict) == {AGREES}
