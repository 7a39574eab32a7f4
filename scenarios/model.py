"""What is run and what comes of it: `Case`, `Config`, `Run`, `Result`; everything else is a table.

A case is the steady state of a chain (`Case`), a motion from a state (`ChainMotion`, `BlockMotion`) or a scene
(`SceneMotion`).
"""

import cmath
import json
import math
from dataclasses import dataclass, field, fields
from enum import StrEnum
from functools import cached_property, lru_cache
from typing import Any, ClassVar, TypeVar

from multibody_xval.engines.interface.variant import Variant
from multibody_xval.scenarios.cases.chain_ratios import ChainRatios
from multibody_xval.scenarios.cases.motions import BlockMotion, ChainMotion, motion_of
from multibody_xval.scenarios.cases.scene_motion import SceneMotion, scene_motion_of
from reference_lcp import defaults
from reference_lcp.chain.drives import HarmonicBase, HarmonicForce, PeriodicDrive
from reference_lcp.chain.linear_response import frictionless_response, stuck_response
from reference_lcp.chain.mass_in_mass import Chain
from reference_lcp.chain.preload import Preload
from reference_lcp.chain.simulation import Lane, steps_per_period_for
from reference_lcp.errors import checked_choice
from reference_lcp.validation import (
    LARGEST_PARAMETER,
    LARGEST_UNIT,
    checked_count,
    checked_scalar,
)

Config = Variant
"""An engine, a formulation and a preset, with changed options."""

REFERENCE = Config("reference")
EXACT = Config("reference", preset_name="exact")
"""The motion without an error of a time step."""

DRIVES = ("base", "force")

LARGEST_DECIBEL = 1000.0
"""Largest difference of levels [dB] that is understood: 50 orders of magnitude in amplitude."""

SINGLE = {
    "frequency_ratio": ("> 0", LARGEST_PARAMETER),
    "friction_coefficient": ("> 0", LARGEST_PARAMETER),
    "displacement": ("> 0", LARGEST_UNIT),
    "modulation": (">= 0", LARGEST_PARAMETER),
    "modulation_phase": ("finite", LARGEST_PARAMETER),
}
"""Parameters of a case that have one value, what is allowed, and the largest."""


@dataclass(frozen=True, kw_only=True)
class Case(ChainRatios):
    """The physics of one steady state of a chain, in ratios; the defaults are the chain of the paper's figure 3.

    Raises
    ------
    ParameterError
        If a value is outside its range, or a list has not one value a cell.
    """

    kind: ClassVar[str] = "steady state"
    frequency_ratio: float
    """ω / ω_r > 0, with ω_r of the first cell."""
    drive: str = "base"
    """``base``: the base moves; ``force``: a force acts on the outer mass of cell 1."""
    modulation: float = 0.0
    """a >= 0 of the normal force N0 (1 + a sin(Ω t + φ)); above 1 contacts open."""
    modulation_multiple: int = 1
    """Ω / ω >= 1, a whole number."""
    modulation_phase: float = 0.0
    """φ [rad]."""

    def __hash__(self) -> int:
        return self._hash

    @cached_property
    def _hash(self) -> int:
        return hash(tuple(getattr(self, name) for name in CASE))

    def __getstate__(self) -> dict[str, Any]:
        return {name: getattr(self, name) for name in CASE}  # hashes of texts differ from process to process

    def __post_init__(self) -> None:
        super().__post_init__()
        checked_count("modulation_multiple", self.modulation_multiple)
        checked_choice("drive", self.drive, DRIVES)
        for name, (requirement, largest) in SINGLE.items():
            checked_scalar(name, getattr(self, name), requirement, largest)

    @property
    def setting(self) -> tuple[Chain, PeriodicDrive]:
        """Build the chain and its drive."""
        return _setting(self)

    def lane(self, steps: int) -> Lane:
        """Build the chain with so many steps per period."""
        chain, drive = _setting(self)
        preload = None
        if self.modulation:
            preload = Preload.at_multiple(drive, self.modulation, self.modulation_multiple, self.modulation_phase)
        return Lane.periodic(chain, drive, steps, preload)

    def steps(self, minimum: int = defaults.MINIMUM_STEPS_PER_PERIOD) -> int:
        """Give the steps per period that the chain needs, at least `minimum`."""
        return steps_per_period_for(*_setting(self), minimum)

    def as_data(self) -> dict[str, Any]:
        """Give plain data, without what is as in the paper's chain."""
        data = {name: getattr(self, name) for name in CASE}
        return {name: value for name, value in data.items() if name not in DEFAULTS or value != DEFAULTS[name]}

    @property
    def title(self) -> str:
        """Every value that is not the paper's, with its name: ``friction 0.3, frequency 0.9, cells 3``."""
        return ", ".join(f"{name.removesuffix(' ratio')} {text}" for name, text in self.words.items())

    @property
    def words(self) -> dict[str, str]:
        """Every value that is not the paper's by its name, as people read both; an amplitude has its unit."""
        texts = {name.replace("_", " "): value_text(value) for name, value in self.as_data().items()}
        if texts.pop("displacement", None) is not None:
            value, unit = amplitude_of(self.drive, self.displacement)
            texts["amplitude"] = f"{value:.6g} {unit}"
        return texts


CASE = ["friction_ratio", "frequency_ratio"]
CASE += [own.name for own in fields(Case) if own.name not in CASE]
"""Columns of tables that say what case a row belongs to."""

DEFAULTS = {name: Case.__dataclass_fields__[name].default for name in CASE[2:]}
"""The paper's chain, by the names of parameters."""


def amplitude_of(drive: str, displacement: float) -> tuple[float, str]:
    """Give the amplitude of a drive with its unit: U0 of a base, P0 of a force, as a sweep file has it."""
    if drive == "base":
        return displacement, "m"
    return float(f"{defaults.CHAIN_STIFFNESS * displacement:.15g}"), "N"


def value_text(value: Any) -> str:
    """Give a value of a case as people read it."""
    if isinstance(value, tuple):
        return "[" + " ".join(f"{part:.6g}" for part in value) + "]"
    return value if isinstance(value, str) else f"{value:.6g}"


AnyCase = Case | ChainMotion | BlockMotion | SceneMotion
"""Everything that may be run."""

Kind = TypeVar("Kind")


def case_of(data: dict[str, Any]) -> Case:
    """Read what `Case.as_data` gives, out of JSON."""
    values: dict[str, Any] = {name: tuple(own) if isinstance(own, list) else own for name, own in data.items()}
    return Case(**values)


def any_case_of(data: dict[str, Any]) -> AnyCase:
    """Read what ``as_data`` of any kind of case gives, out of JSON."""
    kind = data.get("kind", Case.kind)
    checked_choice("kind", kind, [own.kind for own in (Case, ChainMotion, BlockMotion, SceneMotion)])
    if kind == Case.kind:
        return case_of(data)
    return scene_motion_of(data) if kind == SceneMotion.kind else motion_of(data)


@lru_cache(maxsize=4096)
def _setting(case: Case) -> tuple[Chain, PeriodicDrive]:
    chain = case.chain
    base = HarmonicBase.from_ratio(chain, case.frequency_ratio, case.displacement)
    if case.drive == "base":
        return chain, base
    return chain, HarmonicForce(defaults.CHAIN_STIFFNESS * case.displacement, base.angular_frequency)


@lru_cache(maxsize=4096)
def linear_limits(case: Case) -> tuple[complex, complex]:
    """Give T of the chain with contacts that slide without friction, and with contacts that never slide."""
    chain, drive = _setting(case)
    scale = drive.displacement_scale(chain)
    free, stuck = frictionless_response(chain, drive), stuck_response(chain, drive)
    return complex(free[chain.cells - 1]) / scale, complex(stuck[chain.cells - 1]) / scale


@dataclass(frozen=True)
class Run:
    """One case by one configuration of an engine, with so many steps in its period, or in all of a motion."""

    config: Config
    case: AnyCase
    steps: int

    def of(self, kind: type[Kind]) -> Kind:
        """Give the case, which is of a kind."""
        assert isinstance(self.case, kind), f"{self.case.title} is no {kind.__name__}"
        return self.case

    @cached_property
    def text(self) -> str:
        """Give the run as JSON, one text for equal runs."""
        return json.dumps({"config": str(self.config), "case": self.case.as_data(), "steps": self.steps})

    @classmethod
    def from_text(cls, text: str) -> "Run":
        """Read `text`; the engine need not be installed."""
        data = json.loads(text)
        return cls(Config.parse(data["config"]), any_case_of(data["case"]), data["steps"])


class Status(StrEnum):
    """How a run has ended."""

    PERIODIC = "periodic"
    """A certified steady state."""
    FINISHED = "finished"
    """A motion to its end."""
    NOT_PERIODIC = "not periodic"
    """The search for a steady state gave up."""
    FAILED = "failed"
    """The engine crashed, hung, diverged or gave numbers that are not finite; the reason says which."""
    UNSUPPORTED = "unsupported"
    """The engine is not installed, or cannot represent the case; the reason says what is missing."""


@dataclass(frozen=True, kw_only=True)
class Result:
    """What comes of a run: plain numbers."""

    status: Status
    transmittance: complex = complex(math.nan, math.nan)
    """Fundamental of the last outer mass over the displacement scale."""
    residual: float = math.nan
    """Periodicity residual of the orbit."""
    amplification: float = math.nan
    """How many times farther from the steady state than its residual the motion may be; of the reference alone."""
    periods: int = 0
    """Periods that the search took."""
    multiple: int = 1
    """Periods after which the motion repeats: more than one of a subharmonic response, 0 where none was found."""
    stuck: tuple[float, ...] = ()
    """Part of the period that each contact sticks."""
    transitions: tuple[tuple[int, float, str], ...] = ()
    """Cell, time over the period and new mode of every change between stick and slip."""
    stick_velocity: float = math.nan
    """Largest |ġ_T| within a stick over ω U0."""
    open_fraction: tuple[float, ...] = ()
    """Part of the period that each contact is open; empty where the normal force is constant."""
    largest_gap: tuple[float, ...] = ()
    """Largest gap of each contact over U0; likewise."""
    series: dict[str, tuple[float, ...]] = field(default_factory=dict)
    """Numbers of a motion by name, such as one period in full."""
    seconds: float = 0.0
    """Of a processor; those of a batch are shared by its runs."""
    reason: str = ""
    """Why there is no steady state, or what is known of one that need not attract."""
    circumstance: bool = False
    """Whether it failed by no fault of its engine, such as a worker that was killed: it is not stored."""

    @property
    def level_db(self) -> float:
        """20 log10 |T| [dB]."""
        size = abs(self.transmittance)
        return 20 * math.log10(size) if size else -math.inf

    @property
    def phase_deg(self) -> float:
        """By which the fundamental of the last outer mass is ahead of the drive's [°], in (−180, 180]."""
        return math.degrees(cmath.phase(self.transmittance))

    def to_json(self) -> str:
        """Give text that `from_json` reads; what is as in an empty result is left out."""
        data = {own.name: getattr(self, own.name) for own in fields(self)}
        data["transmittance"] = [self.transmittance.real, self.transmittance.imag]
        return json.dumps({name: value for name, value in data.items() if value != EMPTY.get(name)})

    @classmethod
    def from_json(cls, text: str) -> "Result":
        """Read a stored result."""
        data = json.loads(text)
        data["status"], data["transmittance"] = Status(data["status"]), complex(*data["transmittance"])
        data["transitions"] = tuple((cell, time, mode) for cell, time, mode in data.get("transitions", ()))
        for name in ("stuck", "open_fraction", "largest_gap"):
            data[name] = tuple(data.get(name, ()))
        data["series"] = {name: tuple(own) for name, own in data.get("series", {}).items()}
        return cls(**data)


EMPTY = {own.name: getattr(Result(status=Status.FAILED), own.name) for own in fields(Result) if own.name != "status"}


def failed(reason: str, *, circumstance: bool = False) -> Result:
    """Give the result of a run whose engine has given nothing."""
    return Result(status=Status.FAILED, reason=reason, circumstance=circumstance)


def unsupported(reason: str) -> Result:
    """Give the result of a run that an engine cannot represent, or that is not installed."""
    return Result(status=Status.UNSUPPORTED, reason=reason)
