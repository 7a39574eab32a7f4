"""The bound of friction against direction: Coulomb's circle, and the pyramids of engines."""

import math
from dataclasses import replace

import pytest

from multibody_xval.scenarios.catalogue.blocks.direction import DIRECTION
from multibody_xval.scenarios.model import Config
from multibody_xval.scenarios.ruler.judge import AGREES, DEVIATES
from reference_lcp import Chain, Lane, StillBase
from reference_lcp.errors import ParameterError
from tests.installed import each_engine
from tests.scenarios.in_this_process import SHARES, changed_block, judged, judged_copy, only, pressed

SLOW_KILOGRAM = only(DIRECTION, "1 kg, 4.9")
"""One scale and one speed, at which every engine with a pyramid shows it."""


def by_angle(table):
    """Give the rows by their angle [°]."""
    return table.set_index(table.case.str.split().str[-1].str.rstrip("°").astype(int))


@pytest.mark.needs("mujoco")
def test_round_cones_have_no_direction() -> None:
    table = judged(SLOW_KILOGRAM, Config("mujoco", "contact"))
    assert set(table.verdict) == {AGREES}
    assert table.value.astype(float).to_numpy() == pytest.approx(1, abs=1e-4)


@pytest.mark.parametrize("name", each_engine(["ode", "dart"]))
def test_a_bound_a_tangent_lets_friction_grow_to_the_root_of_two_as_stated(name) -> None:
    """It deviates, and is measured there; along the tangents it is judged, and agrees."""
    config = Config(name, "contact")
    table = by_angle(judged(SLOW_KILOGRAM, config))
    assert config.preset.pyramid
    for angle in table.index:
        expected = math.cos(math.radians(angle)) + math.sin(math.radians(angle))
        assert table.value[angle] == pytest.approx(expected, abs=1e-4)
        assert table.verdict[angle] == (AGREES if angle in (0, 90) else DEVIATES)
    assert table.index[~table.judged.astype(bool)].tolist() == [15, 30, 45, 60, 75, 90]


@pytest.mark.needs("ode")
def test_a_bound_that_is_too_large_along_the_tangents_deviates_and_counts() -> None:
    table = by_angle(judged_copy(SLOW_KILOGRAM, Config("ode", "contact"), pressed(1.001)))
    assert table.verdict[0] == DEVIATES
    assert table.judged[0]


@pytest.mark.parametrize(
    "bound",
    [lambda lane: sum(map(abs, lane.axis)), lambda lane: max(map(abs, lane.axis))],
    ids=["circumscribed", "inscribed"],
)
def test_a_pyramid_where_a_cone_is_claimed_is_wrong_between_its_tangents(bound) -> None:
    """Friction is larger or smaller there, as that of a pyramid whose tangents are those of the world."""

    def pyramid(case):
        return changed_block(replace(case, direction=0.0), normal_force=bound(case.lane(case.rows)))

    table = by_angle(judged_copy(SLOW_KILOGRAM, SHARES, pyramid))
    assert table.index[table.verdict == DEVIATES].tolist() == [15, 30, 45, 60, 75]
    assert table.judged.all()


@pytest.mark.parametrize(("cells", "angle"), [(7, 0.1), (1, 1.6), (1, math.nan)])
def test_rows_of_several_cells_are_not_turned_nor_by_more_than_a_right_angle(cells, angle) -> None:
    chain = Chain.from_ratios(friction_ratio=0.3, cells=cells)
    with pytest.raises(ParameterError, match="direction = "):
        Lane(chain, StillBase(0.01), 1e-3, direction=angle)
