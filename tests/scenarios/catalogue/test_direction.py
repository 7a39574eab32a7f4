"""The bound of friction against direction: Coulomb's circle, and the pyramids of engines."""

import dataclasses
import math

import numpy as np
import pytest

from multibody_xval.engines.interface.variant import Variant
from multibody_xval.engines.shared.claims import tangents_of_the_world
from multibody_xval.scenarios.catalogue.block.direction import NO_DIRECTION, PART, Direction
from multibody_xval.scenarios.runs.transient import run_transients
from multibody_xval.scenarios.verdicts.finding import Finding, Verdict
from multibody_xval.scenarios.verdicts.steady_case import EXACT, REFERENCE
from reference_lcp import Chain, CompiledSimulation, Lane, StillBase
from reference_lcp.errors import ParameterError
from tests.installed import each_engine
from tests.scenarios.in_process import deviating, findings, press_harder

MUJOCO = Variant("mujoco", "contact")

needs_mujoco = pytest.mark.needs("mujoco")


def turn_into_pyramid(monkeypatch, bound) -> None:
    """Make the contact of MuJoCo the reference whose normal force depends on the direction by a factor."""
    build = Variant.build

    def wrong(self, lanes):
        if self.engine != "mujoco":
            return build(self, lanes)
        chains = [dataclasses.replace(lane.chain, normal_force=bound(lane) * lane.chain.normal_force) for lane in lanes]
        return CompiledSimulation(
            [dataclasses.replace(lane, chain=chain) for lane, chain in zip(lanes, chains, strict=True)]
        )

    monkeypatch.setattr(Variant, "build", wrong)


def of_angle(judged: list[Finding], angle: int) -> list[Finding]:
    return [finding for finding in judged if finding.case.endswith(f" {angle}°")]


@pytest.fixture
def slow_kilogram(monkeypatch: pytest.MonkeyPatch) -> None:
    """One scale and one speed, at which every engine with a pyramid shows it."""
    monkeypatch.setattr(Direction, "cases", [slide for slide in Direction.cases if "1 kg, 4.9" in str(slide)])


@pytest.mark.parametrize("slide", [each for each in Direction.cases if each.angle == 0], ids=str)
def test_exact_slide_loses_its_part_of_the_velocity_to_friction(slide) -> None:
    """The carrier, of twenty blocks, is moved as well: the slip loses at most a twentieth more."""
    (result,) = run_transients([slide.task(EXACT)])
    lost = 1 - result.series["slip_velocity"][-1] / slide.velocity
    assert PART * 0.99 < lost < PART * 1.05


@needs_mujoco
def test_round_cones_have_no_direction(slow_kilogram) -> None:
    judged = findings(Direction(), MUJOCO, REFERENCE, laws=True)
    assert {finding.comparison.verdict for finding in judged} == {Verdict.AGREE}
    assert np.array([finding.value for finding in judged]) == pytest.approx(1, abs=1e-4)


@pytest.mark.parametrize("name", each_engine(["ode", "dart"]))
def test_a_bound_a_tangent_lets_friction_grow_to_the_root_of_two_as_stated(name, slow_kilogram) -> None:
    judged = findings(Direction(), Variant(name, "contact"), laws=True)
    for angle in (15, 45, 75):
        (finding,) = of_angle(judged, angle)
        assert finding.comparison.verdict is Verdict.DISAGREE
        assert finding.modelled
        expected = math.cos(math.radians(angle)) + math.sin(math.radians(angle))
        assert finding.value == pytest.approx(expected, abs=1e-4)
    assert {finding.comparison.verdict for finding in of_angle(judged, 0) + of_angle(judged, 90)} == {Verdict.AGREE}


@pytest.mark.needs("ode")
def test_a_statement_excuses_no_bound_that_is_another(slow_kilogram, monkeypatch) -> None:
    ode = Variant("ode", "contact")
    press_harder(monkeypatch, ode, 1.001)
    judged = findings(Direction(), ode, laws=True)
    assert {finding.comparison.verdict for finding in judged} == {Verdict.DISAGREE}
    assert not any(finding.modelled for finding in judged)


@needs_mujoco
@pytest.mark.parametrize(
    "bound", [tangents_of_the_world, lambda lane: max(map(abs, lane.axis))], ids=["circumscribed", "inscribed"]
)
def test_a_pyramid_where_a_cone_is_claimed_is_wrong_between_its_tangents(bound, slow_kilogram, monkeypatch) -> None:
    turn_into_pyramid(monkeypatch, bound)
    judged = findings(Direction(), MUJOCO, laws=True)
    wrong = deviating(judged)
    assert [finding.case.split()[-1] for finding in wrong] == ["15°", "30°", "45°", "60°", "75°"]
    assert not any(finding.modelled for finding in wrong)


def test_joints_have_no_direction(slow_kilogram) -> None:
    judged = findings(Direction(), Variant("mujoco"), laws=True)
    assert {finding.comparison.reason for finding in judged} == {NO_DIRECTION}
    assert {finding.comparison.verdict for finding in judged} == {Verdict.BLOCKED}


@pytest.mark.needs("pymunk")
def test_engines_of_a_plane_say_that_they_cannot_turn_the_row(slow_kilogram) -> None:
    judged = findings(Direction(), Variant("pymunk", "contact"), laws=True)
    assert all("cannot turn its row" in finding.comparison.reason for finding in of_angle(judged, 45))
    assert of_angle(judged, 0)[0].comparison.verdict is Verdict.AGREE


@pytest.mark.parametrize(("cells", "angle"), [(7, 0.1), (1, 1.6), (1, math.nan)])
def test_rows_of_several_cells_are_not_turned_nor_by_more_than_a_right_angle(cells, angle) -> None:
    chain = Chain.from_ratios(friction_ratio=0.3, cells=cells)
    with pytest.raises(ParameterError, match="direction = "):
        Lane(chain, StillBase(0.01), 1e-3, direction=angle)
