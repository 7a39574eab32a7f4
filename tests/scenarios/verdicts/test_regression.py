"""Two results of one task: what has changed, and whether it leads to the truth or away from it."""

import dataclasses
from pathlib import Path

import pytest

from multibody_xval.engines.interface.variant import Variant
from multibody_xval.scenarios.runs.result import Result
from multibody_xval.scenarios.runs.store import ResultStore
from multibody_xval.scenarios.runs.transient_task import Block, BlockTask
from multibody_xval.scenarios.verdicts.regression import NOT_COMPARED, Change, TruthDirection, change, compare_stores
from multibody_xval.scenarios.verdicts.stored import StoredResult, StoredTruth
from multibody_xval.scenarios.verdicts.thresholds import Thresholds
from reference_lcp.chain.drives import StillBase
from reference_lcp.errors import ParameterError

STEADY = Result(
    status="converged", transmittance_db=-5.0, residual=1e-9, periods=30, steps_per_period=400, period=1.0,
    stuck_fraction=(0.5, 1.0), transitions=((1, 0.2, "stick"),),
)  # fmt: skip


@pytest.mark.parametrize(
    ("now", "beyond"),
    [
        ({"status": "period limit"}, "converged before, period limit now"),
        ({"stuck_fraction": (0.5, 0.9)}, "stuck fraction 0.1, unknown"),
        ({"transitions": ((1, 0.21, "stick"),)}, "a transition 0.01 periods away, unknown"),
        ({"residual": 1e3}, "residual +1e+03, unknown"),
        ({"period": 1.1}, "period +0.1, unknown"),
        ({"transitions": ()}, "1 transitions without a partner, unknown"),
        ({"transitions": ((1, 0.999, "stick"),)}, "2 transitions without a partner, unknown"),
    ],
)
def test_every_kind_of_change_passes_its_threshold(now: dict[str, object], beyond: str) -> None:
    stored = [StoredResult({}, 3, "1", {}, result) for result in (STEADY, dataclasses.replace(STEADY, **now))]
    assert beyond in change(*stored, Thresholds()).beyond
    assert change(stored[0], stored[0], Thresholds()).beyond == ()


def test_a_residual_that_leaves_less_open_than_the_threshold_is_no_change() -> None:
    stored = [StoredResult({}, 3, "1", {}, result) for result in (STEADY, dataclasses.replace(STEADY, residual=1e-6))]
    assert change(*stored, Thresholds()).beyond == ()


def test_a_series_of_nothing_but_zeros_is_the_same_as_itself() -> None:
    still = StoredResult({}, 3, "1", {}, dataclasses.replace(STEADY, series={"speed across": (0.0, 0.0)}))
    assert change(still, still, Thresholds()).beyond == ()


NAN = float("nan")


@pytest.mark.parametrize(
    ("now", "beyond"),
    [
        ({"transmittance_db": NAN}, "transmittance db is no longer finite"),
        ({"transitions": ((1, NAN, "stick"),)}, "time of a transition is no longer finite"),
        ({"residual": NAN}, "residual is no longer finite"),
        ({"stuck_fraction": (0.5, NAN)}, "stuck fraction is no longer finite"),
        ({"stuck_fraction": ()}, "stuck fraction is no longer complete"),
        ({"series": {"travels": (0.1, float("inf"))}}, "travels is no longer finite"),
        ({"series": {}}, "travels is no longer complete"),
    ],
)
@pytest.mark.parametrize("status", ["converged", "finished"])
def test_numbers_that_are_lost_or_no_longer_finite_pass_every_threshold(status, now, beyond) -> None:
    old = dataclasses.replace(STEADY, status=status, series={"travels": (0.1, 0.2)})
    stored = [StoredResult({}, 3, "1", {}, result) for result in (old, dataclasses.replace(old, **now))]
    assert beyond in change(*stored, Thresholds(1e3, 1.0, 1.0)).beyond
    if "transitions" not in now:  # NaN has no partner
        assert change(stored[1], stored[1], Thresholds()).beyond == ()


def of_status(status: str, *changed: dict[str, object]) -> list[StoredResult]:
    """Two results that differ from `STEADY`."""
    return [StoredResult({}, 4, "1", {}, dataclasses.replace(STEADY, status=status, **own)) for own in changed]


def test_a_motion_that_is_cut_short_is_lost_and_one_that_is_longer_is_named() -> None:
    whole, short = {"series": {"slip": (0.0,) * 10}}, {"series": {"slip": (0.0,) * 5}}
    cut = change(*of_status("finished", whole, short), Thresholds())
    assert (cut.beyond, cut.fails()) == (("slip is no longer complete",), True)
    assert change(*of_status("finished", short, whole), Thresholds()).beyond == ("more of slip",)


@pytest.mark.parametrize("status", ["converged", "finished"])
@pytest.mark.parametrize(
    ("old", "new", "beyond"),
    [
        ({"distance": (0.0,)}, {"distance": (5.0,)}, "distance 5 of its scale"),
        ({"energy": (0.1, 0.2)}, {"energy": (99.1, 0.2)}, "energy 99"),
        ({"rest": (2.0,)}, {"rest": (1.0,)}, "rest 0.5 of its largest"),
        ({"slip_velocity": (0.0, 2e-9)}, {"slip_velocity": (0.0, -2e-9)}, "slip velocity 2 of its largest"),
        ({"of_a_plugin": (0.0,)}, {"of_a_plugin": (3.0,)}, "of a plugin 1 of its largest"),
    ],
)
def test_every_series_is_compared(status: str, old: dict, new: dict, beyond: str) -> None:
    stored = of_status(status, {"series": old}, {"series": new})
    assert change(*stored, Thresholds()).beyond == (f"{beyond}, unknown",)


def test_every_number_of_a_steady_state_is_compared_or_named_as_not_compared() -> None:
    numbers = {
        each.name for each in dataclasses.fields(Result) if each.name not in ("status", "reason", "by_engine", "series")
    }
    changed = {name: _other(getattr(STEADY, name)) for name in sorted(numbers - NOT_COMPARED.keys())}
    known = {"phase": 0.0, "creep": (0.0,), "open_fraction": (0.0,), "largest_gap": (0.0,)}
    for name, value in changed.items():
        assert change(*of_status("converged", known, {**known, name: value}), Thresholds()).shifts, name


def _other(value: object) -> object:
    """Give another value of a number of `STEADY`."""
    if isinstance(value, tuple):
        return {0: (0.1,), 1: (), 2: (0.2, 0.3)}[len(value)]
    return 3 if isinstance(value, int) else 0.5


def test_points_that_were_never_certified_are_not_compared() -> None:
    stored = of_status("period limit", {}, {"transmittance_db": -50.0})
    unknown = change(*stored, Thresholds())
    assert (unknown.beyond, unknown.uncertified) == ((), True)


def test_thresholds_name_what_is_wrong() -> None:
    with pytest.raises(ParameterError, match=r"threshold of stuck_fraction = 0"):
        Thresholds(stuck_fraction=0)


def judged(old: dict[str, object], new: dict[str, object], true: dict[str, object]) -> Change:
    """Compare one point with one truth, from numbers that differ from those of `STEADY`."""
    results = [dataclasses.replace(STEADY, **own) for own in (old, new, true)]
    stored = [StoredResult({"frequency_ratio": 0.9}, 4, "1", {}, result) for result in results]
    return change(*stored[:2], Thresholds()).judged(StoredTruth(results[2], "exact motion"))


@pytest.mark.parametrize(
    ("old", "new"),
    [
        ({"stuck_fraction": (0.5, 0.8)}, {"stuck_fraction": (0.5, 0.9)}),
        ({"transitions": ((1, 0.21, "stick"),)}, {"transitions": ((1, 0.2, "stick"),)}),
        ({"transitions": ()}, {}),
    ],
)
def test_stick_and_slip_are_held_to_the_truth_too(old, new) -> None:
    assert judged(old, new, {}).direction is TruthDirection.IMPROVED
    assert judged(new, old, {}).direction is TruthDirection.REGRESSED


def motions(file: Path, slips: dict[tuple[str, int], float]) -> Path:
    """Keep motions of a block that slips by so much, by variant and steps."""
    block = Block(mass=1.0, normal_force=10.0, stiffness=1e3)
    with ResultStore(file) as store:
        for (name, steps), slip in slips.items():
            task = BlockTask(
                variant=Variant.parse(name), block=block, base=StillBase(0.01), time_step=0.1 / steps, steps=steps,
                every=steps // 100, recorded="slip",
            )  # fmt: skip
            rows = {"slip": (0.0,) * 99 + (slip,)}
            store.keep([(task, Result(status="finished", series=rows, seconds=1.0))])
    return file


@pytest.mark.parametrize(
    ("name", "steps", "direction"),
    [
        ("reference:joint:exact", 100, TruthDirection.REGRESSED),
        ("reference:joint:converged", 100, TruthDirection.REGRESSED),
        ("reference", 400, TruthDirection.REGRESSED),
        ("reference", 200, TruthDirection.UNKNOWN),
    ],
)
def test_a_block_that_creeps_now_and_did_not_is_farther_from_the_truth(
    name: str, steps: int, direction: TruthDirection, tmp_path: Path
) -> None:
    """The reference with few steps more has an error like the engine's, and says nothing."""
    before = motions(tmp_path / "before.sqlite", {("mujoco", 100): 0.0, (name, steps): 0.0})
    now = motions(tmp_path / "now.sqlite", {("mujoco", 100): 1e-3, (name, steps): 0.0})
    (changed,) = compare_stores(before, now).beyond
    assert (changed.variant, changed.direction) == ("mujoco", direction)
    assert changed.beyond == (f"motion 0.001 of its scale, {direction}",)
    assert compare_stores(before, now, Thresholds(motion=0.01)).beyond == []
    (back,) = compare_stores(now, before).beyond
    assert back.fails() is (direction is TruthDirection.UNKNOWN)


def test_a_point_whose_numbers_disagree_goes_by_the_worst() -> None:
    both = judged({"transmittance_db": -6.0}, {"transmittance_db": -5.0, "stuck_fraction": (0.4, 1.0)}, {})
    assert [str(shift.direction) for shift in both.shifts] == ["improved", "regressed"]
    assert both.fails()


def test_a_steady_state_that_was_not_certified_before_is_gained() -> None:
    gained = judged({"status": "period limit"}, {}, {})
    assert gained.beyond == ("period limit before, converged now",)
    assert gained.direction is TruthDirection.IMPROVED
    assert not gained.fails()
    assert judged({"status": "period limit"}, {"transmittance_db": -3.0}, {}).direction is TruthDirection.REGRESSED
    assert judged({}, {"status": "period limit"}, {}).direction is TruthDirection.MISSING
