"""One option at a time: which variants differ from a preset in one option, and what the page says of them."""

from pathlib import Path

import pytest

from engines.interface.variant import Variant
from reports.data.options import installed, single_options
from reports.data.variants import VariantErrors
from reports.page.sections.summary import sentence
from scenarios.studies.few_points import one_option_variants, with_single_options
from scenarios.sweeps.sweep import Case

DEFAULT, TUNED = Variant("mujoco", "joint", "default"), Variant("mujoco")
SOLREF, NOSLIP = (DEFAULT.changed(*own) for own in (("solref_friction", (-1.0, -1.0)), ("noslip_iterations", 1)))


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


def test_options_of_a_version_that_is_not_there_are_named_all_the_same(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A report of a store shows versions that another machine ran."""
    monkeypatch.setenv("MULTIBODY_XVAL_ENVIRONMENTS", str(tmp_path))
    chosen = one_option_variants([Variant("mujoco@3.3.7"), Variant("mujoco@3.3.7", "joint", "default")])
    assert "mujoco@3.3.7:noslip_iterations=0" in map(str, chosen)
    assert "mujoco@3.3.7:joint:default:solref_friction=-1.0,-1.0" in map(str, chosen)


@pytest.mark.parametrize("name", ["mujoco", "mujoco:contact", "pybullet:joint:default", "exudyn-regularised"])
def test_varied_values_are_others_than_the_presets_own(name: str) -> None:
    variant = Variant.parse(name)
    assert variant.preset.varied
    for option, values in variant.preset.varied.items():
        assert variant.preset[option] not in values
        assert len(values) >= 2, "three values make a curve"


def errors(**sizes: tuple[Variant, float]) -> dict[Variant, VariantErrors]:
    case = Case.of(friction_ratio=0.1)
    return {variant: VariantErrors(variant, 5, 5, size, case, 1.6, 0.1) for variant, size in sizes.values()}


def test_the_option_that_takes_off_most_of_an_error_is_named() -> None:
    """MuJoCo's time constant of friction does, its sweeps without slip alone do not."""
    few = errors(default=(DEFAULT, 14.6), tuned=(TUNED, 0.2), solref=(SOLREF, -0.24), noslip=(NOSLIP, 14.6))
    singles = single_options(few)
    assert [own.option for own in singles] == ["solref_friction", "noslip_iterations"]
    (pair,) = installed(few, singles)
    assert pair.decisive is not None
    assert sentence("MuJoCo", [pair], 299)["decisive"] == [
        {"setting": "solref_friction=-1.0,-1.0", "left": "0.24 dB (at 5 points)"}
    ]
    (pair,) = installed(few, singles[1:])
    assert pair.decisive is None
