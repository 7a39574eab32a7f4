"""What an engine can do and how it is set up, as data: capabilities, formulations, presets, options."""

from collections.abc import Callable, Mapping
from dataclasses import InitVar, dataclass, field, replace
from enum import StrEnum
from typing import Any, Self

from reference_lcp.chain.preload import CONSTANT
from reference_lcp.chain.simulation import Lane
from reference_lcp.defaults import DEFAULT_RESIDUAL
from reference_lcp.errors import ParameterError, checked_choice
from reference_lcp.observables.stick_slip import STICK_MARGIN


class FrictionLaw(StrEnum):
    """How an engine represents Coulomb friction."""

    COULOMB = "Coulomb"
    REGULARISED = "regularised"
    BRISTLE = "bristle"


class Formulation(StrEnum):
    """Where the friction acts: in a joint's own dry friction, or between two pressed bodies."""

    JOINT = "joint"
    CONTACT = "contact"


class NormalForce(StrEnum):
    """How a normal force may change in time, from the least that a preset can represent to the most."""

    CONSTANT = "constant"
    MODULATED = "modulated"
    LIFTING = "modulated until contacts open"

    @classmethod
    def of(cls, lane: Lane) -> "NormalForce":
        """Give what a lane needs."""
        if lane.preload is None:
            return cls.CONSTANT
        return cls.LIFTING if lane.opens else cls.MODULATED


ACROSS = "across"
"""Option of adapters whose tuned contacts are held: what masses do across the row."""

FREE, HELD = "free", "held"


@dataclass(frozen=True)
class OfStep:
    """A value that depends on the time step."""

    text: str
    """As the engine writes it, with h for the time step, such as ``2h 1``."""
    at: Callable[[float], Any] = field(repr=False, compare=False)
    """Gives the value at a time step, in the units of that step."""

    def __repr__(self) -> str:
        """Give the text: reports print it, and results are stored under it."""
        return self.text


@dataclass(frozen=True)
class Option:
    """One setting of an engine."""

    value: Any
    """What the preset sets, as the engine takes it; an `OfStep` where that depends on the time step."""
    default: Any
    """What the engine does without it."""
    reason: str
    """Why it is set, in one sentence."""
    fixed: bool = False
    """The engine has it, and lets nobody set it."""
    held: bool = False
    """It acts only where the masses of a cell are held across the row, see `ACROSS`."""

    @classmethod
    def own(cls, value: Any, meaning: str, *, fixed: bool = False, held: bool = False) -> Self:
        """Give a setting as the engine comes: its own value, and in one sentence what that does."""
        return cls(value, value, meaning, fixed, held)


LARGEST_ACCURACY = 0.015
"""Part of an amplitude that a preset may state as its accuracy: a mass or a bound off by a hundredth would hide in
more."""

JUDGED = ("chain", "blocks", "scenes")
"""Kinds of problems whose numbers a preset may let be judged."""

ADAPTERS_UNITS = "units"
"""A setting of adapters, beside the options of engines: in which units a lane is built."""


@dataclass(frozen=True)
class Preset:
    """A named, documented set of options of one formulation."""

    description: str
    """What it is for, in a sentence."""
    options: Mapping[str, Option] = field(default_factory=dict)
    """The settings of its formulation, by name: the engine's own values, see `Option.own`."""
    changes: InitVar[Mapping[str, tuple[Any, str]] | None] = None
    """What it sets otherwise: value and reason, by name. `options` then has all settings with these."""
    shares_scheme: bool = False
    """With these options the engine advances velocities, then positions, by the same semi-implicit Euler step as
    equation (5), so that at equal time step its trajectories equal the reference's."""
    split_tolerance: float = 0.0
    """Largest difference between one run and the same run split in two, over the displacement scale."""
    residual_slip_compliance: float = 0.0
    """Part of the relative velocity which a contact would gain in a step without its forces, along it when it sticks
    or across it, that is left to it, where no option of the engine makes it zero."""
    known_deviation: str = ""
    """How its motion deviates from Coulomb's law or from Euler's step with these options, by more than its time step
    explains; empty where there is none. Reports print it beside a disagreement."""
    stick_margin: float = STICK_MARGIN
    """Part of the bound that the friction of a stick leaves at least, as `contact_modes` reads it: wider where the
    friction of a sliding contact only tends to its bound."""
    passes_bound: str = ""
    """Why its friction may pass μ λ_N for some time, as by the damping of a bristle; empty where it may not."""
    normal_force: NormalForce = NormalForce.CONSTANT
    """How the normal force may change in time."""
    modulated_options: Mapping[str, Option] = field(default_factory=dict)
    """What it sets otherwise where it does."""
    modulated_residual_slip_compliance: float = 0.0
    """`residual_slip_compliance` where it does."""
    batch_lanes: int | None = None
    """Lanes that one simulation takes at best, where that is another number than the engine's."""
    optional: bool = False
    """It takes part where it is named, and not where all presets of an engine are meant."""
    scenes_only: bool = False
    """It runs scenes, and neither chains nor blocks: of a solver that has no adapter for them."""
    static_friction: bool = False
    """Friction at rest may be larger than in motion, see `Lane.static_ratio`."""
    varied: Mapping[str, tuple[float, ...]] = field(default_factory=dict)
    """Options that a recipe changes, with other values of theirs: `run recipes` measures them too."""
    judged: tuple[str, ...] = ()
    """What of it is judged, of ``chain``, ``blocks`` (a single mass that friction holds, stops or lets go) and
    ``scenes``; of the rest, errors are measured and no run fails by them."""
    accuracy: Mapping[str, float] = field(default_factory=dict)
    """By how much its numbers may be off, where that is more than the error of Euler's step, by quantity:
    ``transmittance`` as a part of the amplitude, at most `LARGEST_ACCURACY`; ``stuck fraction``; ``time`` over the
    period; ``drift`` of blocks and scenes [µm/s], [µrad/s]; in scenes ``share`` of a number, and ``creep`` of a loaded
    joint over its velocity without friction. Set on one half of measured points, checked on the other:
    ``tests/golden``, and in scenes variations that are held out."""
    accuracy_reason: str = ""
    """Why: regularised friction, a bristle, single precision."""
    settles: bool = True
    """Whether its search usually ends in a steady state on the paper's chain: not of a preset that has one at no more
    than one of the five headline points. Reports measure what does not settle at one point alone."""
    settings: tuple[str, ...] = ()
    """What is changed, as ``NAME=VALUE``, sorted."""

    def __post_init__(self, changes: Mapping[str, tuple[Any, str]] | None) -> None:
        if changes:
            own = self.options
            changed = {
                name: replace(own[name], value=value, reason=reason) for name, (value, reason) in changes.items()
            }
            object.__setattr__(self, "options", {**changed, **own, **changed})
        stated = self.accuracy_of("transmittance")
        if not 0 <= stated <= LARGEST_ACCURACY:
            raise ParameterError(f"accuracy = {stated:g} of transmittance; allowed: 0 to {LARGEST_ACCURACY:g}")
        for name in self.judged:
            checked_choice("judged", name, JUDGED[2:] if self.scenes_only else JUDGED)
        if self.accuracy and not self.accuracy_reason:
            raise ParameterError("accuracy_reason is empty; allowed: why numbers may be off, in a sentence")

    def __getitem__(self, name: str) -> Any:
        return self.options[name].value

    @property
    def engine_options(self) -> Mapping[str, Option]:
        """Give the options of the engine that act: without the adapter's own, on which results depend too."""
        adapters = {ADAPTERS_UNITS, ACROSS}
        own = {name: option for name, option in self.options.items() if name not in adapters}
        return {name: option for name, option in own.items() if not (option.held and self.is_free)}

    @property
    def is_free(self) -> bool:
        """Whether a constant force presses masses together that are free across the row."""
        return ACROSS in self.options and self[ACROSS] == FREE

    def accuracy_of(self, quantity: str) -> float:
        """Give by how much a number may be off beside the error of a step; 0 where nothing is stated."""
        return self.accuracy.get(quantity, 0.0)

    def value(self, name: str, time_step: float) -> Any:
        """Give the value of an option at a time step, in the units of that step if it depends on it."""
        own = self[name]
        return own.at(time_step) if isinstance(own, OfStep) else own

    def changed_from(self, other: "Preset") -> dict[str, Any]:
        """Give what another preset has of the options that are otherwise here, the engine's own where it has none."""
        values = {name: other.options.get(name) for name in self.options}
        before = {name: own.default if (of := values[name]) is None else of.value for name, own in self.options.items()}
        return {name: value for name, value in before.items() if self[name] != value}

    def pressed(self, lane: Lane) -> Lane:
        """Give a lane as it is built: where masses are free across the row, a constant force presses them together."""
        return replace(lane, preload=CONSTANT) if self.is_free and lane.preload is None else lane

    def modulated(self) -> "Preset":
        """Give the options, and the residual slip compliance, that hold where the normal force changes in time."""
        options = {**self.options, **self.modulated_options}
        return replace(
            self,
            options=options,
            residual_slip_compliance=max(self.residual_slip_compliance, self.modulated_residual_slip_compliance),
        )

    def represents(self, needed: NormalForce) -> bool:
        """Say whether the normal force may change like this."""
        order = list(NormalForce)
        return order.index(needed) <= order.index(self.normal_force)

    def unsupported_reason(self, lane: Lane, name: str) -> str | None:
        """Say why a lane cannot be represented by what has this name.

        ``None`` if it can.
        """
        if self.scenes_only:
            return f"{name} runs scenes only; allowed for chains and blocks: another preset"
        if lane.static_ratio != 1 and not self.static_friction:
            return f"static_ratio = {lane.static_ratio:g}: {name} cannot set static friction of its own; allowed: 1"
        if lane.preload is None or self.represents(NormalForce.of(lane)):
            return None
        allowed = {
            NormalForce.CONSTANT: "a constant one, without a preload",
            NormalForce.MODULATED: "up to 1, where contacts stay closed",
        }[self.normal_force]
        problem = f"{name} cannot represent a modulated normal force like this; allowed: {allowed}"
        return f"modulation = {lane.preload.modulation:g}: {problem}"


@dataclass(frozen=True)
class Preparation:
    """What an engine does before its first run in a process; the first time on a machine, it takes long."""

    what: str
    """What it does, for a reader, such as ``compiles its kernels``."""
    limit: float
    """Seconds after which it is given up."""


@dataclass(frozen=True)
class Capabilities:
    """What an engine can do, as data."""

    title: str
    """The name that reports print."""
    package: str
    """The distribution that holds the engine, by its name for pip."""
    licence: str
    """Licence of the engine."""
    friction_law: FrictionLaw
    """How it represents Coulomb friction."""
    presets: Mapping[Formulation, Mapping[str, Preset]]
    """Presets by formulation, then by name; a formulation that is not listed is not supported."""
    batch_lanes: int = 4
    """Lanes that one simulation takes at best: few where lanes cost the same alone, many where they share work."""
    precision: str = "double"
    """Arithmetic of the engine."""
    residual: float = DEFAULT_RESIDUAL
    """Periodicity residual that certifies a steady state: no engine repeats a motion closer than it computes."""
    deterministic: bool = True
    """Repeated runs are bitwise equal."""
    notes: str = ""
    """What matters of its friction, in a sentence or two."""
    optional: bool = False
    """It comes with an extra or with the system and not with the suite: it takes part where it is named."""
