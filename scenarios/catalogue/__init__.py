"""The catalogue: every scenario by its name."""

from collections.abc import Mapping
from types import MappingProxyType

from scenarios.catalogue.base import Scenario
from scenarios.catalogue.den_hartog import DenHartog
from scenarios.catalogue.figure3 import Figure3Points
from scenarios.catalogue.filtered_noise import FilteredNoiseScenario
from scenarios.catalogue.free_decay import FreeDecay
from scenarios.catalogue.linear_limits import FrictionlessLimit, LockedLimit
from scenarios.catalogue.long_chain import LongChain
from scenarios.catalogue.modulated_normal_force import ModulatedNormalForce
from scenarios.catalogue.record import Record
from scenarios.catalogue.ricker_pulse import RickerPulseScenario
from scenarios.catalogue.swept_sine import SweptSineScenario
from scenarios.catalogue.unequal_cells import DisorderedChain, GradedChain
from scenarios.catalogue.unit_cell import UnitCell

SCENARIOS: tuple[Scenario, ...] = (
    UnitCell(),
    Figure3Points(),
    DenHartog(),
    FrictionlessLimit(),
    LockedLimit(),
    FreeDecay(),
    RickerPulseScenario(),
    SweptSineScenario(),
    FilteredNoiseScenario(),
    Record(),
    DisorderedChain(),
    GradedChain(),
    LongChain(),
    ModulatedNormalForce(),
)

ALL_SCENARIOS = "all"
"""Name of all scenarios together."""

CATALOGUE: Mapping[str, Scenario] = MappingProxyType({scenario.name: scenario for scenario in SCENARIOS})
"""Every scenario by its name, in the order in which they are listed and run."""
