"""What an engine can do and how it is set up, as data: capabilities, formulations, presets, options."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace
from enum import StrEnum
from typing import Any

from engines.interface.law import Law, NotModelled
from reference_lcp.chain.simulation import Lane
from reference_lcp.observables.stick_slip import STICK_MARGIN
from reference_lcp.steady.limits import DEFAULT_RESIDUAL


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


@dataclass(frozen=True)
class Option:
    """One setting of an engine.

    Parameters
    ----------
    value
        What the preset sets, as the engine takes it.
    default
        What the engine does without it.
    reason
        Why it is set, in one sentence.
    fixed
        The engine has it, and lets nobody set it.
    """

    value: Any
    default: Any
    reason: str
    fixed: bool = False


@dataclass(frozen=True)
class Preset:
    """A named, documented set of options of one formulation.

    Parameters
    ----------
    description
        What it is for, in a sentence.
    options
        What it sets, by name.
    shares_scheme
        With these options the engine advances velocities, then positions, by the same semi-implicit Euler
        step as equation (5), so that at equal time step its trajectories equal the reference's.
    split_tolerance
        Largest difference between one run and the same run split in two, over the displacement scale.
    residual_slip_compliance
        Part of the relative velocity which a contact would gain in a step without its forces, along it when it
        sticks or across it, that is left to it, where no option of the engine makes it zero.
    known_deviation
        The law of the engine by which its motion departs from Coulomb's with these options, by more than its time
        step explains; empty where there is none. Reports print it beside a disagreement.
    law
        Gives the model that predicts its steps, with constants taken from its options, or the reason why there is
        none; ``None`` where it claims the reference's own step.
    stick_margin
        Part of the bound that the friction of a stick leaves at least, as `contact_modes` reads it: wider where the
        friction of a sliding contact only tends to its bound.
    normal_force
        How the normal force may change in time.
    modulated_options
        What it sets otherwise where it does.
    modulated_residual_slip_compliance
        `residual_slip_compliance` where it does.
    batch_lanes
        Lanes that one simulation takes at best, where that is another number than the engine's.
    versions
        Versions of the engine that have what it sets, as pip has them, such as ``>=4``; any without this.
    optional
        It takes part where it is named, and not where all presets of an engine are meant.
    turns
        The row may have any direction in the plane of the contacts.
    inclines
        The faces of contacts may be inclined to the row.
    static_friction
        Friction at rest may be larger than in motion, see `Lane.static_ratio`.
    inclined_law
        As `law`, where contacts are inclined to the row and other steps are taken there than the preset otherwise
        states.
    turned_bound
        Gives the bound of sliding friction over μ λ_N in a lane that is turned, at a slip velocity [m/s], where it is
        not 1 as Coulomb's law has it, and nothing else but this is another.
    varied
        Options that decide much, with other values of theirs: reports show the error over them, at a few points.
    unchanged
        The preset of the engine of which this is one with changed options; ``None`` of a preset of the engine.
    settings
        What is changed, as ``NAME=VALUE``, sorted.
    """

    description: str
    options: Mapping[str, Option] = field(default_factory=dict)
    shares_scheme: bool = False
    split_tolerance: float = 0.0
    residual_slip_compliance: float = 0.0
    known_deviation: str = ""
    law: "Callable[[Preset], Law | NotModelled] | None" = None
    stick_margin: float = STICK_MARGIN
    normal_force: NormalForce = NormalForce.CONSTANT
    modulated_options: Mapping[str, Option] = field(default_factory=dict)
    modulated_residual_slip_compliance: float = 0.0
    batch_lanes: int | None = None
    versions: str = ""
    optional: bool = False
    turns: bool = False
    inclines: bool = False
    static_friction: bool = False
    inclined_law: "Callable[[Preset], Law] | None" = None
    turned_bound: Callable[[Lane, float], float] | None = None
    varied: Mapping[str, tuple[float, ...]] = field(default_factory=dict)
    unchanged: "Preset | None" = None
    settings: tuple[str, ...] = ()

    def __getitem__(self, name: str) -> Any:
        return self.options[name].value

    def takes(self, version: str) -> bool:
        """Tell whether a version of the engine has what it sets."""
        from packaging.specifiers import SpecifierSet

        return not self.versions or SpecifierSet(self.versions).contains(version, prereleases=True)

    def stated_law(self) -> Law | NotModelled | None:
        """Give the model of its steps, or the reason why there is none; ``None`` where it states neither."""
        return None if self.law is None else self.law(self)

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
        """Say why a lane cannot be represented by what has this name: its direction, inclination or forces.

        ``None`` if it can.
        """
        if lane.direction and not self.turns:
            return f"direction = {lane.direction:g}: {name} cannot turn its row in the plane of contacts; allowed: 0"
        if lane.inclination and not self.inclines:
            return f"inclination = {lane.inclination:g}: {name} cannot incline its contacts to the row; allowed: 0"
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
class Capabilities:
    """What an engine can do, as data.

    Parameters
    ----------
    title
        The name that reports print.
    package
        The distribution that holds the engine, by its name for pip.
    licence
        Licence of the engine.
    terms
        Where the terms stand that its user agrees to, if it is not free software: they are said before it is installed.
    friction_law
        How it represents Coulomb friction.
    presets
        Presets by formulation, then by name; a formulation that is not listed is not supported.
    batch_lanes
        Lanes that one simulation takes at best: few where lanes cost the same alone, many where they share work.
    precision
        Arithmetic of the engine.
    residual
        Periodicity residual that certifies a steady state: no engine repeats a motion closer than it computes.
    deterministic
        Repeated runs are bitwise equal.
    notes
        What matters of its friction, in a sentence or two.
    optional
        It comes with an extra or with the system and not with the suite: it takes part where it is named.
    """

    title: str
    package: str
    licence: str
    friction_law: FrictionLaw
    presets: Mapping[Formulation, Mapping[str, Preset]]
    batch_lanes: int = 4
    precision: str = "double"
    residual: float = DEFAULT_RESIDUAL
    deterministic: bool = True
    notes: str = ""
    optional: bool = False
    terms: str = ""
