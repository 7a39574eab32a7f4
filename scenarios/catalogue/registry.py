"""Every scenario, as an object."""

from collections.abc import Mapping
from types import MappingProxyType

from multibody_xval.scenarios.catalogue.base import Scenario
from multibody_xval.scenarios.catalogue.block.breakaway import Breakaway
from multibody_xval.scenarios.catalogue.block.direction import Direction
from multibody_xval.scenarios.catalogue.block.published import Published
from multibody_xval.scenarios.catalogue.block.static_above_kinetic import StaticAboveKinetic
from multibody_xval.scenarios.catalogue.block.static_hold import Ratchet, StaticHold
from multibody_xval.scenarios.catalogue.block.stopping_distance import StoppingDistance
from multibody_xval.scenarios.catalogue.scenes.hold import Grip, HeavyOnLight, SlopeHold, StackHold
from multibody_xval.scenarios.catalogue.scenes.joints import ArmHold, JointHold
from multibody_xval.scenarios.catalogue.scenes.shaken import HeldWhileShaken
from multibody_xval.scenarios.catalogue.scenes.slide import Conveyor, SlideToStop, SlopeSlide
from multibody_xval.scenarios.catalogue.scenes.spin import Spin
from multibody_xval.scenarios.catalogue.steady.den_hartog import DenHartog
from multibody_xval.scenarios.catalogue.steady.figure3 import Figure3Points
from multibody_xval.scenarios.catalogue.steady.linear_limits import FrictionlessLimit, LockedLimit
from multibody_xval.scenarios.catalogue.steady.long_chain import LongChain
from multibody_xval.scenarios.catalogue.steady.modulated_normal_force import ModulatedNormalForce
from multibody_xval.scenarios.catalogue.steady.unequal_cells import DisorderedChain, GradedChain
from multibody_xval.scenarios.catalogue.steady.unit_cell import UnitCell
from multibody_xval.scenarios.catalogue.steady.wide_range import WideRange
from multibody_xval.scenarios.catalogue.transient.filtered_noise import FilteredNoiseScenario
from multibody_xval.scenarios.catalogue.transient.free_decay import FreeDecay
from multibody_xval.scenarios.catalogue.transient.long_run import LongRun
from multibody_xval.scenarios.catalogue.transient.record import Record
from multibody_xval.scenarios.catalogue.transient.ricker_pulse import RickerPulseScenario
from multibody_xval.scenarios.catalogue.transient.swept_sine import SweptSineScenario

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
    HeldWhileShaken(),
    Conveyor(),
    Spin(),
    JointHold(),
    ArmHold(),
)

CATALOGUE: Mapping[str, Scenario] = MappingProxyType({scenario.name: scenario for scenario in SCENARIOS})
"""Every scenario by its name, in the order in which they are listed and run."""
