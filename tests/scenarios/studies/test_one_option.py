"""One option at a time: which variants differ from a preset in one option, and what the page says of them."""

from functools import partial
from pathlib import Path

import pytest

from engines.interface.variant import Variant
from reports import plan
from reports.data.collect import held_creeps
from reports.data.options import headlines, single_options
from reports.plan import planned_report
from scenarios.runs.store import opened_store
from scenarios.studies.one_option import one_option_variants, with_single_options
from tests.reports.conftest import made_errors
from tests.scenarios.in_process import evaluator

DEFAULT, TUNED = Variant("mujoco", "joint", "default"), Variant("mujoco")
ALONE = (("solref_friction", TUNED.preset["solref_friction"]), ("noslip_iterations", 1))
SOLREF, NOSLIP = (DEFAULT.changed(*own) for own in ALONE)


def test_each_option_of_the_tuned_preset_stands_alone_beside_the_default() -> None:
    singles = with_single_options(DEFAULT)
    assert {SOLREF, NOSLIP} <= set(singles)
    tuned = TUNED.preset
    for variant in singles:
        (setting,) = variant.preset.settings
        option = setting.partition("=")[0]
        assert variant.preset[option] == tuned[option] != DEFAULT.preset[option]


def test_options_are_tried_where_the_default_settles_and_varied_where_the_preset_says() -> None:
    """A default of Exudyn needs a minute for five points, and its law predicts few of them."""
    slow = Variant("exudyn-bristle", "joint", "default")
    chosen = one_option_variants([DEFAULT, TUNED, Variant("pybullet")], [slow, Variant("mujoco", "contact", "default")])
    assert {str(variant) for variant in chosen} >= {
        "mujoco:noslip_iterations=0", "mujoco:noslip_iterations=2", str(SOLREF),
        "mujoco:contact:default:noslip_iterations=1",
    }  # fmt: skip
    assert {variant.engine for variant in chosen} == {"mujoco"}
    assert len(set(chosen)) == len(chosen)


@pytest.mark.parametrize("name", ["mujoco", "mujoco:contact", "pybullet:joint:default", "exudyn-regularised"])
def test_varied_values_are_others_than_the_presets_own(name: str) -> None:
    variant = Variant.parse(name)
    assert variant.preset.varied
    for option, values in variant.preset.varied.items():
        assert variant.preset[option] not in values
        assert len(values) >= 2, "three values make a curve"


def test_the_option_that_takes_off_most_of_an_error_is_named() -> None:
    """MuJoCo's time constant of friction does, its sweeps without slip alone do not."""
    few = made_errors({DEFAULT: 14.6, TUNED: 0.2, SOLREF: -0.24, NOSLIP: 14.6}, points=5)
    singles = single_options(few)
    assert [own.option for own in singles] == ["solref_friction", "noslip_iterations"]
    (said,) = headlines(few, singles)
    assert said.decides == "solref_friction = -0.95/h -0.95/h"
    (said,) = headlines(few, singles[1:])
    assert said.decides == "6 options together"


def test_an_option_that_holds_a_block_may_leave_the_error_of_what_moves() -> None:
    """MuJoCo's sweeps without slip cure creep, and not the time constant of friction."""
    with opened_store(None) as store:
        creeps = held_creeps([NOSLIP, SOLREF, TUNED.changed("noslip_iterations", 2)], evaluator(store))
    assert set(creeps) == {DEFAULT, NOSLIP, SOLREF}
    assert creeps[NOSLIP] < 1e-6
    assert 1e3 < creeps[SOLREF] < creeps[DEFAULT]
    few = made_errors({DEFAULT: 14.6, TUNED: 0.2, NOSLIP: 14.6}, points=5)
    (single,) = single_options(few, creeps)
    assert (single.creep, single.creep_without) == (creeps[NOSLIP], creeps[DEFAULT])
    assert not single.halves


def test_options_are_general_where_the_recommended_preset_changes_them_too() -> None:
    """A model of one's own may have MuJoCo's time constant of friction; dual sweeps are exact for the chain alone."""
    assert TUNED.reach("solref_friction") == "general"
    assert TUNED.reach("noslip_iterations") == TUNED.reach("solver") == "this chain only"
    assert Variant("mujoco", "joint", "recommended").reach("solimp_friction") == "general"
    assert Variant("genesis").reach("noslip_iterations") == "this chain only", "nothing is recommended of Genesis"
    assert TUNED.description.endswith("not to be copied into other models.")
    assert "copied" not in DEFAULT.description


def test_each_engine_has_three_numbers_as_installed_as_recommended_and_tuned() -> None:
    recommended = Variant("mujoco", "joint", "recommended")
    (row,) = headlines(made_errors({DEFAULT: 14.6, recommended: 0.23, TUNED: 0.2}, points=5))
    assert row.texts == ["15", "0.23", "0.20"]
    (row,) = headlines(made_errors({DEFAULT: 14.6, TUNED: 0.2}, points=5))
    assert row.texts == ["15", "–", "0.20"]


def test_the_default_report_has_recommended_presets_whose_steps_a_model_has() -> None:
    for quick in (False, True):
        scope = planned_report([], None, quick=quick, stored_in=None).scope
        assert Variant("mujoco", "joint", "recommended") in scope.recommended
        assert Variant("mujoco", "contact", "recommended") not in scope.recommended, "it hops, and never settles"
    assert planned_report(["mujoco"], None, quick=False, stored_in=None).scope.recommended == ()


def test_a_report_is_of_what_its_store_has_and_a_preview_is_not(monkeypatch: pytest.MonkeyPatch) -> None:
    stored = planned_report(["mujoco"], None, quick=True, stored_in=None).sweep
    monkeypatch.setattr(plan, "stored_sweep", lambda _file: stored)
    store, planned = Path("results.sqlite"), partial(planned_report, (), None)
    assert planned(quick=False, stored_in=store).sweep == stored
    assert planned(quick=True, stored_in=store) == planned(quick=True, stored_in=None)
    assert planned(quick=False, stored_in=None).sweep != stored
