"""What an engine declares of itself, and its refusal of parameters that it does not take."""

import re

import pytest

from engines.contract.lanes import lane_of
from engines.interface.registry import engine
from engines.interface.tolerances import ROUND_OFF, STEPS
from reference_lcp.chain.harmonic import HarmonicBase
from reference_lcp.chain.mass_in_mass import Chain
from reference_lcp.chain.simulation import Lane
from reference_lcp.chain.trajectory import State
from reference_lcp.refusal import ParameterError


def test_capabilities_name_the_engine_and_every_option_has_a_reason(installed: str) -> None:
    """Reports print them."""
    abilities = engine(installed).capabilities
    assert abilities.title
    assert abilities.package
    assert abilities.licence
    assert engine(installed).version()
    assert abilities.precision in ROUND_OFF
    presets = [preset for named in abilities.presets.values() for preset in named.values()]
    assert all(option.reason for preset in presets for option in preset.options.values())
    assert all(preset.description for preset in presets)
    assert all("tuned" in named for named in abilities.presets.values())


def test_unknown_formulation_and_preset_are_refused(installed: str) -> None:
    """With the ones that there are."""
    formulation = next(iter(engine(installed).capabilities.presets))
    with pytest.raises(ParameterError, match=re.escape(f"formulation of {installed} = 'glue' is unknown; allowed: ")):
        engine(installed).build([lane_of(0.3, 0.6)], formulation="glue")
    with pytest.raises(ParameterError, match=re.escape(f"preset of {installed} = 'best' is unknown; allowed: tuned")):
        engine(installed).build([lane_of(0.3, 0.6)], formulation=formulation, preset="best")


def test_chains_of_different_lengths_and_states_of_another_shape_are_refused(installed: str) -> None:
    """Before any step."""
    formulation = next(iter(engine(installed).capabilities.presets))
    short = Chain.from_ratios(cells=2)
    mixed = [lane_of(0.3, 0.6), Lane.periodic(short, HarmonicBase.from_ratio(short, 0.9), STEPS)]
    with pytest.raises(ParameterError, match=r"chains of \[2, 7\] cells"):
        engine(installed).build(mixed, formulation=formulation)
    with pytest.raises(ParameterError, match=r"\(1, 6\)"):
        engine(installed).build([lane_of(0.3, 0.6)], formulation=formulation).run(State.at_rest(1, 3), 0, 10)
