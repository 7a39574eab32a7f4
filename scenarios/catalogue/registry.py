"""Every scenario, as an object."""

from collections.abc import Mapping
from types import MappingProxyType

from scenarios.catalogue.base import Scenario
from scenarios.catalogue.block.breakaway import Breakaway
from scenarios.catalogue.block.direction import Direction
from scenarios.catalogue.block.published import Published
from scenarios.catalogue.block.static_above_kinetic import StaticAboveKinetic
from scenarios.catalogue.block.static_hold import Ratchet, StaticHold
from scenarios.catalogue.block.stopping_distance import StoppingDistance
from scenarios.catalogue.scenes.hold import Grip, HeavyOnLight, SlopeHold, StackHold
from scenarios.catalogue.scenes.joints import ArmHold, JointHold
from scenarios.catalogue.scenes.slide import Conveyor, SlideToStop, SlopeSlide
from scenarios.catalogue.scenes.spin import Spin
from scenarios.catalogue.steady.den_hartog import DenHartog
from scenarios.catalogue.steady.figure3 import Figure3Points
from scenarios.catalogue.steady.linear_limits import FrictionlessLimit, LockedLimit
from scenarios.catalogue.steady.long_chain import LongChain
from scenarios.catalogue.steady.modulated_normal_force import ModulatedNormalForce
from scenarios.catalogue.steady.unequal_cells import DisorderedChain, GradedChain
from scenarios.catalogue.steady.unit_cell import UnitCell
from scenarios.catalogue.steady.wide_range import WideRange
from scenarios.catalogue.transient.filtered_noise import FilteredNoiseScenario
from scenarios.catalogue.transient.free_decay import FreeDecay
from scenarios.catalogue.transient.long_run import LongRun
from scenarios.catalogue.transient.record import Record
from scenarios.catalogue.transient.ricker_pulse import RickerPulseScenario
from scenarios.catalogue.transient.swept_sine import SweptSineScenario

SCENARIOS: tuple[Scenario, ...] = (
    UnitCell(),
    Figure3Points(),
    DenHartog(),
    FrictionlessLimit(),
    LockedLimit(),
    FreeDecay(),
    StaticHold(),
    Ratchet(),
    Breakaway(),
    StoppingDistance(),
    StaticAboveKinetic(),
    Direction(),
    Published(),
    RickerPulseScenario(),
    SweptSineScenario(),
    FilteredNoiseScenario(),
    Record(),
    DisorderedChain(),
    GradedChain(),
    LongChain(),
    ModulatedNormalForce(),
    WideRange(),
    LongRun(),
    SlopeHold(),
    SlopeSlide(),
    SlideToStop(),
    StackHold(),
    HeavyOnLight(),
    Grip(),
    Conveyor(),
    Spin(),
    JointHold(),
    ArmHold(),
)

CATALOGUE: Mapping[str, Scenario] = MappingProxyType({scenario.name: scenario for scenario in SCENARIOS})
"""Every scenario by its name, in the order in which they are listed and run."""
