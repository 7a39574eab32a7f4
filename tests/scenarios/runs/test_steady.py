"""Steady states and periods beside laws: where searches begin, which does not decide where they end."""

import pytest

from multibody_xval.engines.interface.registry import law_of
from multibody_xval.engines.interface.variant import Variant
from multibody_xval.scenarios.runs.executor import run_batch
from multibody_xval.scenarios.runs.parameters import Modulation
from multibody_xval.scenarios.runs.result import Result, ResultStatus
from multibody_xval.scenarios.runs.steady import ENGINE_PERIODS, law_orbits, run_steady_states
from multibody_xval.scenarios.runs.task import Recorded, Start, SteadyStateTask
from reference_lcp.defaults import DEFAULT_PERIODS
from reference_lcp.steady.neighbours import NEWTON_PERIODS
from reference_lcp.steady.orbits import LONGEST_MULTIPLE, periodic_orbits, repetitions
from tests.scenarios.in_process import press_harder
from tests.scenarios.runs.builders import steady

POINTS = ((0.1, 0.5), (0.3, 0.9), (1.0, 1.3))


def tasks_of(variant: Variant, start: Start = Start.LAW, **more) -> list[SteadyStateTask]:
    return [
        SteadyStateTask(variant=variant, friction_ratio=friction, frequency_ratio=eta, start=start, **more)
        for friction, eta in POINTS
    ]


@pytest.mark.parametrize(
    ("name", "allowed_db"),
    [
        pytest.param("pymunk", 1e-5, marks=pytest.mark.needs("pymunk"), id="the reference's scheme"),
        pytest.param("mujoco:joint:default", 1e-5, marks=pytest.mark.needs("mujoco"), id="soft friction"),
        pytest.param("exudyn-bristle", 1e-5, marks=pytest.mark.needs("exudyn-bristle"), id="bristles, internal state"),
        pytest.param("box2d", 1e-2, marks=pytest.mark.needs("box2d"), id="single precision"),
    ],
)
def test_an_engine_that_obeys_its_law_is_certified_by_its_first_period(name, allowed_db) -> None:
    variant = Variant.parse(name)
    starts = (Start.LAW, Start.HARMONIC_BALANCE)
    from_law, balanced = (run_batch(tasks_of(variant, start)) for start in starts)
    assert {result.status for result in (*from_law, *balanced)} == {"converged"}
    assert [result.periods for result in from_law] == [1] * len(POINTS)
    assert min(result.periods for result in balanced) > 5
    for one, other in zip(from_law, balanced, strict=True):
        assert one.transmittance_db == pytest.approx(other.transmittance_db, abs=allowed_db)
        assert one.residual <= variant.capabilities.residual


@pytest.mark.needs("pymunk")
def test_an_engine_that_does_not_obey_its_law_ends_where_it_would_have(monkeypatch) -> None:
    """A tenth more friction than it is given: the first period does not repeat, and the search goes on."""
    variant = Variant("pymunk")
    press_harder(monkeypatch, variant, 1.1)
    from_law, balanced = (run_batch(tasks_of(variant, start)) for start in (Start.LAW, Start.HARMONIC_BALANCE))
    for one, other in zip(from_law, balanced, strict=True):
        assert one.periods > 1
        assert one.transmittance_db == pytest.approx(other.transmittance_db, abs=1e-5)


@pytest.mark.slow
@pytest.mark.needs("exudyn-regularised")
def test_a_preset_whose_steps_are_not_modelled_is_searched_beside_the_reference() -> None:
    variant = Variant.parse("exudyn-regularised:contact:default")
    beside, balanced = (run_batch(tasks_of(variant, start)[:1])[0] for start in (Start.LAW, Start.HARMONIC_BALANCE))
    assert beside.converged
    assert balanced.converged
    assert beside.periods < balanced.periods
    assert beside.transmittance_db == pytest.approx(balanced.transmittance_db, abs=1e-5)


@pytest.mark.slow
@pytest.mark.needs("exudyn-bristle")
def test_where_the_law_of_bristles_has_no_steady_state_the_engine_is_given_some_periods_and_no_more() -> None:
    """A bristle sticks at the ends of substeps only: here the motion never repeats, in the law and in the engine."""
    variant = Variant("exudyn-bristle")
    task = SteadyStateTask(variant=variant, friction_ratio=0.3, frequency_ratio=1.55)
    (law,) = law_orbits(variant, [task.lane()[0]], 400)
    assert law is not None
    assert not law.converged
    (result,) = run_batch([task])
    assert result.status == "period limit"
    assert 1 < result.periods <= NEWTON_PERIODS + 2 * LONGEST_MULTIPLE
    assert result.residual < 1e-2


BRISTLES = "exudyn-bristle:joint:tuned"


def repeats_after(friction: float, eta: float, leading: str = "") -> int:
    """Periods after which tuned bristles repeat, led by the law of a variant, or by themselves without one."""
    variant = Variant.parse(BRISTLES)
    task = SteadyStateTask(variant=variant, friction_ratio=friction, frequency_ratio=eta)
    lane, steps = task.lane()
    (beside,) = law_orbits(variant, [lane], steps)
    assert beside is not None
    law = law_of(Variant.parse(leading).preset).build([lane]) if leading else None
    engine, tolerance = variant.build([lane]), variant.capabilities.residual
    (multiple,), _, _ = repetitions(engine, beside.trajectory.end, steps, tolerance, leading=law)
    engine.close()
    return multiple


@pytest.mark.needs("exudyn-bristle")
@pytest.mark.parametrize(
    ("friction", "eta", "multiple"),
    [
        pytest.param(0.3, 1.2919, 2, id="every other period"),
        pytest.param(0.6, 0.778888, 4, id="every fourth", marks=pytest.mark.slow),
        pytest.param(0.3, 1.55, 0, id="never"),
    ],
)
def test_bristles_led_by_their_law_repeat_where_they_do_by_themselves(friction, eta, multiple) -> None:
    assert repeats_after(friction, eta, leading=BRISTLES) == repeats_after(friction, eta) == multiple


@pytest.mark.needs("exudyn-bristle")
def test_bristles_led_by_another_law_do_not_repeat_and_nothing_is_certified() -> None:
    """Springs that are half as stiff again repeat every other period too, but elsewhere."""
    assert repeats_after(0.3, 1.2919, leading=f"{BRISTLES}:bristle_phase=0.5") == 0


UNSETTLED = pytest.mark.parametrize(
    "name",
    [
        pytest.param("mujoco:contact:default", marks=pytest.mark.needs("mujoco"), id="a law"),
        pytest.param(
            "exudyn-regularised:contact:default",
            marks=[pytest.mark.needs("exudyn-regularised"), pytest.mark.slow],
            id="nearly",
        ),
    ],
)
"""Contacts whose friction never settles at a point, as their law says, or what nearly is their law."""


def unsettled(name: str, start: Start = Start.LAW) -> Result:
    """Search such a contact."""
    variant = Variant.parse(name)
    return run_batch([SteadyStateTask(variant=variant, friction_ratio=0.1, frequency_ratio=1.5, start=start)])[0]


@UNSETTLED
def test_a_motion_that_neither_settles_nor_repeats_by_its_law_is_followed_for_a_period(name) -> None:
    """The engine's period is the law's; searched at length, the engine finds nothing either."""
    followed, searched = unsettled(name), unsettled(name, Start.HARMONIC_BALANCE)
    assert followed.periods == 1
    assert searched.periods > NEWTON_PERIODS
    assert (followed.status, followed.multiple) == (searched.status, searched.multiple) == ("period limit", 0)


@UNSETTLED
def test_an_engine_that_is_not_its_law_is_searched_where_that_does_not_settle(monkeypatch, name) -> None:
    """A hundredth more friction than it is given: its period is not the law's."""
    press_harder(monkeypatch, Variant.parse(name), 1.01)
    assert unsettled(name).periods > 1


@pytest.mark.slow
@pytest.mark.needs("mujoco")
def test_an_option_that_does_not_matter_leaves_a_motion_unsettled_as_the_unchanged_law_says() -> None:
    """A dense Jacobian changes nothing; another cone does, and there the engine is searched."""
    default, dense, elliptic = (
        unsettled(f"mujoco:contact:default{option}") for option in ("", ":jacobian=dense", ":cone=elliptic")
    )
    assert dense.periods == 1
    assert dense.transmittance_db == pytest.approx(default.transmittance_db, abs=1e-6)
    assert 1 < elliptic.periods <= NEWTON_PERIODS + 1
    at_length = unsettled("mujoco:contact:default:cone=elliptic", Start.HARMONIC_BALANCE)
    assert at_length.periods > 2 * NEWTON_PERIODS
    assert (elliptic.status, elliptic.multiple) == (at_length.status, at_length.multiple) == ("period limit", 0)


@pytest.mark.needs("mujoco")
def test_the_law_of_an_unchanged_preset_is_searched_once_for_all_that_change_an_option() -> None:
    names = [f"mujoco:contact:default{option}" for option in ("", ":jacobian=dense", ":cone=elliptic")]
    lanes = [task.lane()[0] for task in tasks_of(Variant.parse(names[0]))[:2]]
    own, dense, elliptic = (law_orbits(Variant.parse(name), lanes, 400) for name in names)
    for one, two, three in zip(own, dense, elliptic, strict=True):
        assert two is three is not None
        assert one is not None
        assert (two.residual, two.lane) == (one.residual, one.lane)
    assert dense[0] is not dense[1]


@pytest.mark.needs("exudyn-bristle")
@pytest.mark.slow
def test_what_an_engine_without_a_law_does_not_find_in_a_hundred_periods_it_does_not_find_in_four_hundred(
    monkeypatch,
) -> None:
    """Exudyn's bristle as installed never settles here; a search is over in fewer periods wherever there is an end."""
    variant = Variant.parse("exudyn-bristle:joint:default")
    task = SteadyStateTask(variant=variant, friction_ratio=0.1, frequency_ratio=1.6)
    (stopped,) = run_steady_states([task])
    monkeypatch.setattr("multibody_xval.scenarios.runs.steady.ENGINE_PERIODS", DEFAULT_PERIODS)
    (at_length,) = run_steady_states([task])
    assert stopped.periods == ENGINE_PERIODS + 1 < at_length.periods
    assert (stopped.status, stopped.multiple) == (at_length.status, at_length.multiple) == ("period limit", 0)


def starts_of(name: str, **more) -> list[bool]:
    variant = Variant.parse(name)
    lanes = [task.lane()[0] for task in tasks_of(variant, **more)]
    return [orbit is not None for orbit in law_orbits(variant, lanes, 400)]


@pytest.mark.parametrize("name", ["reference", "reference:joint:converged", "pymunk@law:joint:default"])
def test_neither_the_reference_nor_a_law_begins_at_a_law(name) -> None:
    assert starts_of(name) == [False] * len(POINTS)


def test_presets_that_are_not_modelled_and_lanes_that_no_law_claims_do_not_begin_at_a_law() -> None:
    assert starts_of("exudyn-bristle:joint:default") == [False] * len(POINTS)
    swinging = Modulation(modulation=0.5)
    assert starts_of("mujoco:contact", modulation=swinging) == [True] * len(POINTS)
    law = law_of(Variant("drake", "contact").preset)
    assert law is not None
    assert starts_of("drake:contact", modulation=swinging) == [law.modulated] * len(POINTS)


def test_a_start_is_part_of_a_question_unless_it_is_the_usual_one() -> None:
    usual, balanced = tasks_of(Variant("pymunk"))[0], tasks_of(Variant("pymunk"), Start.HARMONIC_BALANCE)[0]
    assert "start" not in usual.content()["task"]
    assert usual.key() != balanced.key()


def test_a_first_period_that_repeats_is_the_last() -> None:
    task = steady()
    lane, steps = task.lane()
    simulation = task.variant.build([lane])
    (orbit,) = periodic_orbits(simulation, steps, tolerance=1e-10)
    (again,) = periodic_orbits(simulation, steps, start=orbit.trajectory.end, max_periods=1)
    assert again.periods == 1
    assert again.converged
    assert again.residual <= 1e-9
    assert Result(status=str(again.status)).converged


def test_point_that_needs_too_many_steps_is_blocked_and_its_neighbours_are_computed() -> None:
    before, impossible, after = run_steady_states([steady(eta) for eta in (0.9, 1e-9, 1.3)])
    assert before.converged
    assert after.converged
    assert impossible.status == "blocked"
    assert "steps; allowed: <= 1000000, as with a frequency " in impossible.reason


DEFAULT = Variant("exudyn-regularised", "joint", "default")


@pytest.mark.needs("exudyn-regularised")
def test_law_is_compared_where_it_does_not_claim_to_hold_and_the_reason_is_noted(monkeypatch) -> None:
    """An engine that is pressed harder is not its law, claimed or not."""
    task = SteadyStateTask(variant=DEFAULT, friction_ratio=0.6, frequency_ratio=0.9, recorded=Recorded.LAW)
    law = law_of(DEFAULT.preset)
    assert law is not None
    (claimed,) = run_steady_states([task])
    monkeypatch.setattr(
        "multibody_xval.scenarios.runs.steady.unclaimed_reason", lambda _, lane: f"{lane.chain.cells} cells"
    )
    (unclaimed,) = run_steady_states([task])
    press_harder(monkeypatch, DEFAULT, 1.01)
    (wrong,) = run_steady_states([task])
    assert [result.status for result in (claimed, unclaimed, wrong)] == [ResultStatus.FINISHED] * 3
    assert [result.reason for result in (claimed, unclaimed, wrong)] == ["", "7 cells", "7 cells"]
    assert claimed.series["distance"] == unclaimed.series["distance"]
    assert claimed.series["distance"][0] <= law.period_bound < wrong.series["distance"][0]
