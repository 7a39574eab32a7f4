"""The options of one engine with which boxes move as in another one."""

import math
import re

import numpy as np
import pandas as pd
import pytest

from multibody_xval.scenarios.catalogue import translation
from multibody_xval.scenarios.catalogue.translation import CASES, Translation, apart, translated
from multibody_xval.scenarios.model import Config, Result, Status
from multibody_xval.scenarios.running.evaluate import Means

MEANS = Means(workers=1)


def motion(acceleration: float, turn: float, times: np.ndarray) -> Result:
    """A box that slides along with a constant acceleration, and turns at a constant rate."""
    still = dict.fromkeys(("across", "off", "speed across", "speed off"), tuple(np.zeros_like(times)))
    moving = {"along": acceleration * times**2 / 2, "speed along": acceleration * times, "turn": turn * times}
    series = {"time": tuple(times), **{name: tuple(own) for name, own in moving.items()}, **still}
    return Result(status=Status.FINISHED, series=series)


def test_boxes_are_apart_by_their_ways_and_at_the_corners_by_their_turns() -> None:
    """Rows of the two are at other times, between which the way is a parabola."""
    case = CASES["slide-to-stop, 3 m/s, 30° off"]
    one, other = motion(2.0, 0.1, np.linspace(0, 2, 41)), motion(2.1, 0.0, np.linspace(0, 2, 31))
    assert apart(case, one, other) == pytest.approx(1e3 * (0.1 * 2**2 / 2 + 0.2 * math.hypot(0.2, 0.2) / 2), rel=1e-12)
    assert apart(case, one, one) < 1e-12
    assert apart(case, one, Result(status=Status.FAILED)) == translation.NEVER_APART


WRITTEN = {
    "newton:contact:recommended": r"solver = newton.*Steel\(model, iterations=50, friction_anchor_beta=0.2\)",
    "drake:contact:default": r"# after Finalize\nplant.set_stiction_tolerance\(0.001\)",
    "drake:contact:recommended": r"# before (.|\n)*\(side / 2, 10000000.0, box_properties\)\n(.|\n)*tolerance\(1e-05\)",
    "pymunk:contact:recommended": r"iterations = 30\ncollision_slop = 0.001",  # of which no syntax is known
}


@pytest.mark.parametrize("config", WRITTEN)
def test_what_to_write_has_all_values_in_the_syntax_of_the_engine(config) -> None:
    assert re.fullmatch(WRITTEN[config], Translation(Config.parse(config), 1.0, pd.DataFrame()).text)


def test_boxes_move_alike_where_they_are_a_twentieth_of_their_way_apart_or_a_tenth_of_a_millimetre() -> None:
    rows = [("held", 0.0, 5.0, 0.1), ("slides", 100.0, 5.1, 5.0), ("spun", 1.0, 0.1, 0.2)]
    found = Translation(Config.parse("mujoco"), 1.0, pd.DataFrame(rows, columns=["scene", "way", "default", "found"]))
    assert (found.alike("default"), found.alike("found")) == (1, 2)


@pytest.mark.needs("mujoco")
@pytest.mark.slow
def test_options_that_made_a_motion_are_found_from_the_motion() -> None:
    given = Config.parse("mujoco:contact:recommended").changed("impratio", 30.0)
    found = translated(given, "mujoco", MEANS)
    assert found.found.preset["cone"] == "elliptic"
    assert abs(math.log10(found.found.preset["impratio"] / 30)) < translation.FINEST
    assert found.friction == 1
    assert (found.table.found / found.table.way).max() < 10**translation.FINEST - 1
    assert found.table.default.max() > 100


@pytest.mark.needs("mujoco", "pybullet")
@pytest.mark.slow
def test_damping_that_bullet_adds_goes_where_a_box_is_to_slide_as_in_mujoco(monkeypatch) -> None:
    monkeypatch.setattr(translation, "CASES", {name: CASES[name] for name in ("slope-slide, μ 0.5, load 1.5",)})
    found = translated(Config.parse("mujoco:contact:recommended"), "pybullet", MEANS)
    row = found.table.iloc[0]
    assert found.found.preset["linearDamping"] == 0
    assert found.friction == pytest.approx(1, abs=0.01)
    assert row.found < 0.01 * row.way < row.default
