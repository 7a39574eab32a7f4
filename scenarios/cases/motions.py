"""Motions from a state: of a chain under any drive, and of one block on a carrier."""

import dataclasses
import hashlib
import json
from collections.abc import Mapping
from dataclasses import dataclass, fields
from functools import cached_property, lru_cache
from typing import Any, ClassVar

import numpy as np

from multibody_xval.scenarios.cases.carrier_drives import GrowingAcceleration, Vibration
from multibody_xval.scenarios.cases.chain_ratios import ChainRatios
from reference_lcp import defaults
from reference_lcp.chain import transient
from reference_lcp.chain.drives import Drive, HarmonicBase, HarmonicForce, StillBase
from reference_lcp.chain.mass_in_mass import Chain
from reference_lcp.chain.preload import CONSTANT
from reference_lcp.chain.simulation import Lane
from reference_lcp.chain.trajectory import State
from reference_lcp.chain.transient import RecordedBase
from reference_lcp.errors import ParameterError, checked_choice
from reference_lcp.validation import FloatArray, checked_count, checked_scalar

SHAPES = ("undeformed", "stretched", "inner masses displaced")
"""Where a motion may start, always from rest.

``stretched``: every chain spring by the same length, as far as the last cell is moved by the displacement
scale, inner springs unstretched. ``inner masses displaced``: all of them by the displacement scale, outer ones not.
"""

RECORDED = ("response", "decay", "slip")
"""What may be recorded of a motion: see `multibody_xval.scenarios.compute.motions`."""

STRETCH = 4096
"""Steps that are in memory at once."""

DRIVES: Mapping[str, type[Any]] = {
    own.kind: own
    for own in (
        HarmonicBase, HarmonicForce, StillBase, GrowingAcceleration, Vibration, transient.RickerPulse,
        transient.SweptSine, transient.FilteredNoise,
    )
}  # fmt: skip
"""Drives that plain data describe in full, by kind."""


@dataclass(frozen=True)
class RecordElsewhere:
    """A base that follows a record of which only the hash is known: it is told apart, and cannot be run."""

    data: tuple[tuple[str, Any], ...]

    def displacement_scale(self, chain: Chain) -> float:
        """Give the amplitude [m]."""
        return float(dict(self.data)["amplitude"])

    def load(self, chain: Chain, time: FloatArray) -> FloatArray:
        """Refuse."""
        raise ParameterError(f"record with SHA-256 {dict(self.data)['sha256'][:12]} is not here; allowed: its file")


def drive_data(drive: Any) -> dict[str, Any]:
    """Give the kind and the parameters of a drive; of a record, how many samples there are, and their hash."""
    if isinstance(drive, RecordElsewhere):
        return dict(drive.data)
    if isinstance(drive, RecordedBase):
        samples = np.array([drive.times, drive.displacements], dtype="<f8").tobytes()
        known = {"amplitude": drive.amplitude, "duration": drive.duration, "samples": len(drive.times)}
        return {"kind": drive.kind, **known, "sha256": hashlib.sha256(samples).hexdigest()}
    return {"kind": drive.kind} | {own.name: getattr(drive, own.name) for own in fields(drive)}


def drive_of(data: dict[str, Any]) -> Drive:
    """Read what `drive_data` gives."""
    if data["kind"] == RecordedBase.kind:
        return RecordElsewhere(tuple(data.items()))
    kind = checked_choice("drive", data["kind"], list(DRIVES))
    drive: Drive = DRIVES[kind](**{name: value for name, value in data.items() if name != "kind"})
    return drive


@dataclass(frozen=True, kw_only=True)
class Motion:
    """What motions have in common: how they are driven, and how long they are followed."""

    kind: ClassVar[str]
    drive: Drive
    """How the base moves, or which force acts on the first cell."""
    time: float
    """How long the motion is followed [s]."""
    rows: int
    """Rows that are kept, at equal distances; it divides the steps."""
    recorded: str = RECORDED[0]
    stretch: int = STRETCH
    """Most steps that an engine takes at once: the motion is put together of as many stretches as it needs."""

    def __post_init__(self) -> None:
        checked_scalar("time", self.time, "> 0")
        checked_count("rows", self.rows)
        checked_count("stretch", self.stretch)
        checked_choice("recorded", self.recorded, RECORDED)

    def __hash__(self) -> int:
        return hash(self._text)

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Motion) and self._text == other._text

    @cached_property
    def _text(self) -> str:
        return json.dumps(self.as_data())

    @property
    def chain(self) -> Chain:
        """Build the chain."""
        raise NotImplementedError

    @property
    def scale(self) -> float:
        """Length that displacements are given over [m]."""
        return self.drive.displacement_scale(self.chain)

    def every(self, steps: int) -> int:
        """Give the number of steps from one row to the next."""
        if checked_count("steps", steps) % self.rows:
            raise ParameterError(f"steps = {steps} are no multiple of rows = {self.rows}; allowed: multiples")
        return steps // self.rows

    @property
    def row_times(self) -> FloatArray:
        """Times of the rows [s], shape (rows,)."""
        return self.time / self.rows * np.arange(1, self.rows + 1, dtype=np.float64)

    def lane(self, steps: int, *, pressed: bool = False) -> Lane:
        """Build the chain under its drive; `pressed`: by a force, where a contact can be free across the row."""
        self.every(steps)
        step = self.time / steps
        largest = defaults.LARGEST_PHASE_STEP / self.chain.highest_natural_frequency
        if step > largest * (1 + 1e-12):
            raise ParameterError(
                f"steps = {steps} in {self.time:g} s are too few; allowed: >= {int(np.ceil(self.time / largest))}, "
                f"for {defaults.LARGEST_PHASE_STEP} over the highest natural frequency"
            )
        if isinstance(self.drive, RecordedBase):
            shortest = float(np.min(np.diff(self.drive.times)))
            if step > shortest * (1 + 1e-9):
                raise ParameterError(
                    f"time_step = {step:g} s would leave out samples of the record; allowed: <= {shortest:g} s, "
                    "the shortest time between two of them"
                )
        return Lane(self.chain, self.drive, step)

    def initial_state(self) -> State:
        """Give the state that the motion starts from, a batch of one lane."""
        raise NotImplementedError

    def as_data(self) -> dict[str, Any]:
        """Give plain data, without what is as it usually is."""
        data: dict[str, Any] = {"kind": self.kind}
        for own in fields(self):
            value = getattr(self, own.name)
            if own.name == "drive":
                value = drive_data(self.drive)
            elif dataclasses.is_dataclass(value):
                value = dataclasses.asdict(value)  # type: ignore[arg-type]
            if value != own.default:
                data[own.name] = value
        return data

    @property
    def title(self) -> str:
        """What drives it, and for how long."""
        return f"{self.kind}, {drive_data(self.drive)['kind']}, {self.time:.4g} s"


@dataclass(frozen=True, kw_only=True, eq=False)
class ChainMotion(Motion, ChainRatios):
    """The motion of one chain from an initial state; its friction ratio refers to `displacement`."""

    kind: ClassVar[str] = "motion of a chain"
    shape: str = SHAPES[0]
    """Where it starts."""

    def __post_init__(self) -> None:
        Motion.__post_init__(self)
        ChainRatios.__post_init__(self)
        checked_choice("shape", self.shape, SHAPES)

    @property
    def chain(self) -> Chain:
        """Build the chain."""
        return ChainRatios.chain.fget(self)  # type: ignore[attr-defined]

    def initial_state(self) -> State:
        """Give the state that the motion starts from, a batch of one lane."""
        still = np.zeros(self.cells)
        row = np.arange(1, self.cells + 1) / self.cells
        places = {"stretched": (row, row), "inner masses displaced": (still, np.ones(self.cells))}
        positions = self.scale * np.concatenate(places.get(self.shape, (still, still)))
        return State(positions[None], np.zeros((1, positions.size)))


CARRIER_MASSES = 20.0
"""Masses of the block that the carrier has: it moves by 4e-4 of the way in which a block stops in 0.25 s."""

CARRIER_FREQUENCY = 80.0
"""√(k_c / m_o) of the carrier on its base [rad/s]: far above what moves it, and resolved by steps of 5 ms."""

CARRIER_DAMPING = 0.1
"""c_c / (2 √(k_c m_o)) of the carrier: what begins to shake it dies out in a few tenths of a second."""


@dataclass(frozen=True, kw_only=True)
class Block:
    """A block on a carrier: the inner mass of a chain of one cell, and its outer mass, which stands on the base."""

    mass: float
    """Of the block [kg]."""
    normal_force: float
    """λ_N that presses it on the carrier [N]."""
    stiffness: float
    """Of the spring k_i that pulls it to its place on the carrier [N/m]."""
    carrier_frequency: float = CARRIER_FREQUENCY
    """√(k_c / m_o) of the carrier on its base [rad/s]."""
    carrier_damping: float = CARRIER_DAMPING
    """c_c / (2 √(k_c m_o)) of the carrier."""

    @property
    def bound(self) -> float:
        """Largest friction μ λ_N [N]."""
        return defaults.FRICTION_COEFFICIENT * self.normal_force


@lru_cache(maxsize=1000)
def _block_chain(block: Block) -> Chain:
    carrier = CARRIER_MASSES * block.mass
    return Chain(
        cells=1,
        outer_mass=np.asarray(carrier),
        inner_mass=np.asarray(block.mass),
        chain_stiffness=np.asarray(carrier * block.carrier_frequency**2),
        chain_damping=np.asarray(2 * block.carrier_damping * carrier * block.carrier_frequency),
        inner_stiffness=np.asarray(block.stiffness),
        normal_force=np.asarray(block.normal_force),
        friction_coefficient=np.asarray(defaults.FRICTION_COEFFICIENT),
    )


@dataclass(frozen=True, kw_only=True, eq=False)
class BlockMotion(Motion):
    """The motion of a block on its carrier; its slip is recorded."""

    kind: ClassVar[str] = "motion of a block"
    cells: ClassVar[int] = 1
    block: Block
    slip: float = 0.0
    """By how much the block is moved on the carrier at first [m]."""
    slip_velocity: float = 0.0
    """Velocity of the block on the carrier at first [m/s]."""
    carrier_velocity: float = 0.0
    """Velocity of the carrier at first [m/s]."""
    static_ratio: float = 1.0
    """μ_s / μ_k >= 1 of the contact; μ λ_N of the block is the friction of a slip."""
    recorded: str = "slip"

    @property
    def chain(self) -> Chain:
        """Build the chain of one cell."""
        return _block_chain(self.block)

    def lane(self, steps: int, *, pressed: bool = False) -> Lane:
        """Build the chain under its drive; see `Motion.lane`."""
        preload = CONSTANT if pressed else None
        return dataclasses.replace(super().lane(steps), preload=preload, static_ratio=self.static_ratio)

    def initial_state(self) -> State:
        """Give the state that the motion starts from, a batch of one lane."""
        velocities = [self.carrier_velocity, self.carrier_velocity + self.slip_velocity]
        return State(np.array([[0.0, self.slip]]), np.array([velocities]))


def motion_of(data: dict[str, Any]) -> ChainMotion | BlockMotion:
    """Read what `Motion.as_data` gives, out of JSON."""
    values: dict[str, Any] = {
        name: tuple(own) if isinstance(own, list) else own for name, own in data.items() if name != "kind"
    }
    values["drive"] = drive_of(values["drive"])
    if data["kind"] == ChainMotion.kind:
        return ChainMotion(**values)
    return BlockMotion(**values | {"block": Block(**values["block"])})
