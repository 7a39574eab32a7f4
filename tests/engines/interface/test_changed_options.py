"""Options of presets that are changed by name: what they are called, what is refused, and that the engine gets them."""

from collections import UserDict
from dataclasses import replace

import numpy as np
import pytest

from multibody_xval.engines.interface.engine import sample_lane
from multibody_xval.engines.interface.presets import Formulation, Option
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
        ("mujoco:joint:tuned:noslip_iterations=03", "mujoco:noslip_iterations=3"),
        ("mujoco:noslip_iterations=3:iterations=2", "mujoco:iterations=2:noslip_iterations=3"),
        ("mujoco:joint:default:solref_friction=1e-2,1", "mujoco:joint:default:solref_friction=0.01,1.0"),
        ("mujoco:solref_friction=-0.95/h,-0.95/h", "mujoco"),
        ("rapier:can_sleep=True", "rapier:can_sleep=true"),
    ],
)
def test_a_configuration_has_one_name_however_it_is_written(written: str, name: str) -> None:
    assert str(Variant.parse(written)) == name
    assert Variant.parse(name) == Variant.parse(written)


@pytest.mark.parametrize(
    ("written", "message"),
    [
        ("mujoco:noslip=3", "option 'noslip' cannot be set in mujoco:joint:tuned; allowed: iterations, "),
        ("mujoco:joint:default:solreffriction=1,1", r"; allowed: .*; did you mean solref_friction\?$"),
        ("mujoco:solver=CG", "solver = 'CG' of mujoco:joint:tuned; allowed: Newton or PGS"),
        ("mujoco:disable=all", "allowed: any of autoreset, eulerdamp"),
        ("mujoco:solref_friction=1", "values with commas between, or -0.95/h,-0.95/h or 2h,1, such as -0.95/h,-0.95/h"),
        ("rapier:can_sleep=1", "allowed: true or false"),
        ("mujoco:cone=elliptic:cone=elliptic", "is set twice; allowed: once"),
        ("mujoco:units=SI", "option 'units' cannot be set in mujoco:joint:tuned"),
    ],
)
def test_a_wrong_option_is_refused_in_a_line(written: str, message: str) -> None:
    with pytest.raises(ParameterError, match=message) as refused:
        Variant.parse(written)
    assert "\n" not in str(refused.value)


def test_a_changed_option_is_another_run_and_not_the_scheme() -> None:
    runs = [
        Run(Variant.parse(name), Case(friction_ratio=0.3, frequency_ratio=0.9), 400)
        for name in ("mujoco", "mujoco:noslip_iterations=3")
    ]
    assert runs[0].text != runs[1].text
    assert Run.from_text(runs[1].text) == runs[1]
    assert not runs[1].config.preset.shares_scheme


@pytest.mark.parametrize(
    ("name", "values", "alike"),
    [
        ("mujoco:joint:default:solref_friction", ("-0.95/h,-0.95/h", "{0!r},{0!r}"), True),
        ("exudyn-regularised:zone", ("0.00025", "0.0025:zone_per_kick=5"), False),
    ],
)
def test_the_engine_gets_the_number_that_is_written(name: str, values: tuple[str, ...], alike: bool) -> None:
    """A formula of the step is the number that it has there; another number moves the chain otherwise."""
    lane, ends = sample_lane(2), []
    for value in values:
        simulation = Variant.parse(f"{name}={value.format(-0.95 / lane.time_step)}").build([lane])
        ends.append(simulation.advance(State.at_rest(1, 2), 0, 50).positions)
        simulation.close()
    assert np.array_equal(*ends) == alike
    assert np.any(ends[0])
