"""Options of presets that are changed by name: what they are called, and what is refused."""

from collections import UserDict
from dataclasses import replace

import numpy as np
import pytest

from multibody_xval.engines.interface.engine import sample_lane
from multibody_xval.engines.interface.presets import ACROSS, ADAPTERS_UNITS, Formulation, Option
from multibody_xval.engines.interface.registry import engine
from multibody_xval.engines.interface.variant import Variant, variants_named
from multibody_xval.scenarios.model import Case, Run
from reference_lcp.chain.trajectory import State
from reference_lcp.errors import ParameterError
from tests.installed import each_variant


class ReadOptions(UserDict[str, Option]):
    """Options that note which of them are read."""

    def __init__(self, options):
        self.read: set[str] = set()
        super().__init__(options)

    def __getitem__(self, name: str) -> Option:
        self.read.add(name)
        return super().__getitem__(name)


@pytest.mark.parametrize("variant", each_variant(variants_named(["all:all:all"])))
def test_an_adapter_reads_every_option_that_may_be_set(variant: Variant) -> None:
    own, options = engine(variant.engine), ReadOptions(variant.preset.options)
    preset = replace(variant.preset, options=options)
    simulation = own._build((preset.pressed(sample_lane(2)),), Formulation(variant.formulation), preset)
    try:
        simulation.advance(State.at_rest(1, 2), 0, 1)
    finally:
        simulation.close()
    assert {name for name, option in variant.preset.options.items() if not option.fixed} <= options.read


@pytest.mark.parametrize(
    ("written", "name"),
    [
        ("mujoco:noslip_iterations=3", "mujoco:noslip_iterations=3"),
        ("mujoco:joint:tuned:noslip_iterations=03", "mujoco:noslip_iterations=3"),
        ("mujoco:noslip_iterations=1", "mujoco"),
        ("mujoco:noslip_iterations=3:iterations=2", "mujoco:iterations=2:noslip_iterations=3"),
        ("mujoco:joint:default:solref_friction=1e-2,1", "mujoco:joint:default:solref_friction=0.01,1.0"),
        ("mujoco:joint:default:solref_friction=-0.95/h,-0.95/h",) * 2,
        ("mujoco:solref_friction=-0.95/h,-0.95/h", "mujoco"),
        ("mujoco:disable=", "mujoco:disable="),
        ("rapier:can_sleep=True", "rapier:can_sleep=true"),
        ("mujoco:solver=Newton", "mujoco:solver=Newton"),
    ],
)
def test_a_variant_has_one_name_however_it_is_written(written: str, name: str) -> None:
    assert str(Variant.parse(written)) == name
    assert Variant.parse(name) == Variant.parse(written)


@pytest.mark.parametrize(
    ("written", "message"),
    [
        ("mujoco:noslip=3", r"option 'noslip' cannot be set in mujoco:joint:tuned; allowed: iterations \(an integer"),
        ("dart:constraint force mixing=1", "option 'constraint force mixing' cannot be set in dart:joint:tuned"),
        ("mujoco:noslip_iterations=-1", r"'-1' of mujoco:joint:tuned; allowed: an integer >= 0, such as 1$"),
        ("mujoco:noslip_iterations=1.5", "allowed: an integer >= 0"),
        ("mujoco:noslip_iterations=99999999999", "allowed: an integer >= 0"),
        ("mujoco:solver=CG", "solver = 'CG' of mujoco:joint:tuned; allowed: Newton or PGS"),
        ("mujoco:disable=all", "allowed: any of autoreset, eulerdamp"),
        ("mujoco:disable=island,island", "allowed: any of"),
        ("mujoco:solref_friction=1", "values with commas between, or -0.95/h,-0.95/h or 2h,1, such as -0.95/h,-0.95/h"),
        ("mujoco:solref_friction=-0.9/h,-0.9/h", "allowed: 2 values with commas between, or -0.95/h,-0.95/h"),
        ("exudyn-regularised:zone=nan", "zone = 'nan' .* allowed: a number"),
        ("rapier:can_sleep=1", "allowed: true or false"),
        ("ode:contact:recommended:soft_cfm=hard", "allowed: a number, or none, such as 1e-05"),
        ("sapien:contact:inertia=none", r"inertia = 'none' .* allowed: a number, such as 1e\+30$"),
        ("mujoco:cone=elliptic:cone=elliptic", "is set twice; allowed: once"),
        ("reference:substeps=2", "allowed: none"),
        ("mujoco:units=SI", "option 'units' cannot be set in mujoco:joint:tuned"),
        ("mujoco:noslip_iterations=3:joint", "has 3 parts"),
    ],
)
def test_a_wrong_option_is_refused_in_a_line(written: str, message: str) -> None:
    with pytest.raises(ParameterError, match=message) as refused:
        Variant.parse(written)
    assert "\n" not in str(refused.value)


@pytest.mark.parametrize("variant", each_variant(variants_named(["all:all:all"])))
def test_what_is_the_adapters_is_no_option_of_an_engine(variant: Variant) -> None:
    """Results depend on units, and on what is held, all the same: a task has them beside the options."""
    preset = variant.preset
    own = {ADAPTERS_UNITS, ACROSS}
    assert not own & set(preset.engine_options)
    left_out = set(preset.options) - set(preset.engine_options)
    assert {option for option in left_out if not preset.options[option].held} == set(preset.options) & own


@pytest.mark.parametrize("name", ["mujoco", "mujoco-warp"])
def test_the_damping_of_a_held_contact_is_no_option_of_a_free_one(name: str) -> None:
    """A free sphere has that of solref; what nothing reads would be listed, set and compared for nothing."""
    option, default = "normal time constant", f"{name}:contact:default"
    assert option not in Variant.parse(default).preset.engine_options
    assert option in Variant.parse(f"{default}:across=held").preset.engine_options
    assert Variant.parse(f"{default}:across=held:{option}=0.01").preset[option] == 0.01
    with pytest.raises(ParameterError, match=f"option '{option}' cannot be set in {default}; allowed: .*across"):
        Variant.parse(f"{default}:{option}=0.01")


def test_a_changed_option_is_another_run() -> None:
    runs = [
        Run(Variant.parse(name), Case(friction_ratio=0.3, frequency_ratio=0.9), 400)
        for name in ("mujoco", "mujoco:noslip_iterations=3")
    ]
    assert runs[0] != runs[1]
    assert runs[0].text != runs[1].text
    assert Run.from_text(runs[1].text) == runs[1]
    assert runs[1].config.preset["noslip_iterations"] == 3


@pytest.mark.parametrize(
    "name", ["mujoco:solref_friction", "mujoco:contact:solreffriction", "mujoco:joint:default:solref_friction"]
)
def test_a_formula_of_the_step_is_the_number_that_the_engine_takes(name: str) -> None:
    """MuJoCo gets the same rate, whether it is written as a formula or worked out at the lane's time step."""
    lane, ends = sample_lane(2), []
    rate = repr(-0.95 / lane.time_step)
    for value in ("-0.95/h,-0.95/h", f"{rate},{rate}"):
        simulation = Variant.parse(f"{name}={value}").build([lane])
        ends.append(simulation.advance(State.at_rest(1, 2), 0, 50).positions)
        simulation.close()
    np.testing.assert_array_equal(*ends)
    assert np.any(ends[0])


def test_a_changed_preset_does_not_claim_to_be_the_scheme() -> None:
    preset = Variant.parse("mujoco:noslip_iterations=0").preset
    assert not preset.shares_scheme


def test_what_is_set_also_holds_where_the_normal_force_changes() -> None:
    preset = Variant.parse("ode:contact:surface_layer=0.5").preset
    assert preset.modulated()["surface_layer"] == 0.5
    assert preset.modulated()["depth"] == Variant.parse("ode:contact").preset.modulated()["depth"]


def test_a_slower_regularisation_moves_the_engine() -> None:
    """The zone is what the engine gets: ten times as wide, the same chain moves otherwise."""
    ends = []
    for name in ("exudyn-regularised", "exudyn-regularised:zone=0.0025:zone_per_kick=5"):
        simulation = Variant.parse(name).build([sample_lane(2)])
        ends.append(simulation.advance(State.at_rest(1, 2), 0, 20).positions)
        simulation.close()
    assert not np.array_equal(*ends)
