"""Scenarios as data: a question with its cases, and the quantities that answer it."""

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from enum import StrEnum
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np

from multibody_xval.engines.interface.presets import Formulation
from multibody_xval.engines.interface.registry import engine, engine_names, installed_engine_names
from multibody_xval.engines.interface.tolerances import SINGLE
from multibody_xval.engines.interface.variant import (
    EVERY_VARIANT,
    GENERAL,
    check_installed,
    name_parts,
    variants_named,
    variants_of,
)
from multibody_xval.scenarios.cases.scene_motion import SceneMotion
from multibody_xval.scenarios.model import EXACT, REFERENCE, AnyCase, Case, Config, Result, Run
from multibody_xval.scenarios.ruler.exact_values import LADDER, has_exact_motion, needs_exact_motion
from reference_lcp.validation import FloatArray

Number = float | complex | FloatArray
"""What is read of a result; of an array, the largest difference counts."""

Steps = Callable[[Config, Any], Mapping[str, int]]
"""Gives the numbers of steps with which a configuration runs a case, by what is added to the case's name."""


class Exact(StrEnum):
    """Where an exact value is from that is not a closed form."""

    MOTION = "exact"
    """The motion from event to event."""
    LADDER = "extrapolated"
    """The reference at ever finer steps, extrapolated."""


@dataclass(frozen=True, kw_only=True)
class Quantity:
    """A number of a result, and the parts of its judgement in its unit: numbers, or functions that give them.

    Functions of a case name the kind of case that their scenario has.
    """

    name: str
    unit: str
    meaning: str
    """In a sentence."""
    read: Callable[[Result, Run], Number] | None = None
    """Gives it; without it, it is read together with others: level and phase, stick and slip."""
    exact: Exact | float | Callable[[Any], Number] = Exact.MOTION
    """Where the exact value is from, or its closed form."""
    bar: float | Callable[[Any], float] = 0.0
    """Error bar of a closed form: what it leaves out."""
    between: tuple[float, float] | None = None
    """Limits, where theory gives no more than these; the exact value is then the nearest number between them."""
    step_error: float | Callable[[Run], float] | None = None
    """Error of Euler's step in closed form; all are then compared with the exact value, which no ladder gives. Without
    it, the reference at finer steps shows that error."""
    resolution: float | Callable[[Run], float] = 0.0
    """What cannot be told from the exact value, beside round-off and contacts that give way."""
    over_exact: bool = False
    """It is given over its exact value, and so are all its parts but `resolution` and `effect`, which are of that."""
    per_amplitude: float = 1.0
    """What a change of positions makes of it, over the displacement scale; of dB, that follows from the level."""
    effect: float | Callable[[Any, Number], float] | None = None
    """How much friction changes it at all; without it, its size, and where `step_error` is known, any."""
    accuracy: str = ""
    """Name of the accuracy that presets may state, see `Preset.accuracy`."""
    group: str = ""
    """Quantities of one group share the largest error of the step: shares of one energy, for example."""
    of: Callable[[Any], bool] | None = None
    """Whether a case has it; without it, all have."""


ROUND_OFF = {"double": 2.0**-53, "single": SINGLE}
"""Largest rounding of a number, as a part of it."""

ROUNDINGS = 8
"""Of a position in a step: in forces, velocities and positions, and in as many substeps."""


def round_off(run: Run) -> float:
    """Give the largest rounding of a number in a run, as a part of it."""
    return ROUND_OFF[run.config.capabilities.precision]


at_rest = partial(Quantity, exact=0.0, step_error=0.0)
"""A number of what friction should hold: whatever the step, nothing slips."""

TRANSMITTANCE = Quantity(
    name="transmittance", unit="U0", accuracy="transmittance",
    meaning="Fundamental of the last outer mass over that of the drive; its phase counts in what it is off by.",
)  # fmt: skip

STICK_SLIP = (
    Quantity(name="missed", unit="", meaning="Transitions of the exact motion that are not there."),
    Quantity(name="spurious", unit="", meaning="Transitions that the exact motion does not have."),
    Quantity(name="time", unit="% T", meaning="Error of the worst transition, of the period.", accuracy="time"),
    Quantity(name="stuck fraction", unit="", meaning="Of the worst contact.", accuracy="stuck fraction"),
)
"""See `multibody_xval.scenarios.catalogue.stick_slip`."""


@dataclass(frozen=True, kw_only=True)
class Scenario:
    """A question whose answer is known, asked of every configuration."""

    name: str
    """As the command line knows it: lower case, hyphens."""
    question: str
    expects: str
    """What numbers are compared with."""
    source: str
    """Where the cases are from: paper, equation, book."""
    cases: Mapping[str, AnyCase]
    """By what tables print of them."""
    quantities: tuple[Quantity, ...]
    steps: Steps
    details: Sequence[str] = ()
    """Parameters of the cases that their names leave out, in lines."""
    held_out: Mapping[str, AnyCase] = field(default_factory=dict)
    """Variations that no recipe is found with."""
    exact_refinement: int = 1
    """Rows of the exact motion to a step: sums over them need many."""
    of_record: Callable[[Path], "Scenario"] | None = None
    """Gives the same question of a base that follows a user's file, see ``run NAME --record``."""

    def own_runs(self, config: Config) -> dict[str, Run]:
        """Give the runs of a configuration by the name of the case."""
        return {
            f"{name}, {label}" if label else name: Run(config, case, steps)
            for name, case in self.cases.items()
            for label, steps in self.steps(config, case).items()
        }

    def runs(self, configs: Sequence[Config]) -> list[Run]:
        """Give all runs of configurations, those of the ruler first."""
        own = [run for config in dict.fromkeys(configs) for run in self.own_runs(config).values()]
        return list(dict.fromkeys([*self._ruler(own), *own]))

    def _ruler(self, own: Sequence[Run]) -> list[Run]:
        """Give the reference at ever finer steps, and the exact motions."""
        stepped = any(quantity.step_error is None for quantity in self.quantities)
        finer = [Run(REFERENCE, run.case, run.steps * factor) for run in own for factor in LADDER if stepped]
        first = {run.case: run.steps for run in reversed(own)}
        exact = [Run(EXACT, case, steps * self.exact_refinement) for case, steps in first.items() if self._exact(case)]
        return [*finer, *exact]

    def _exact(self, case: AnyCase) -> bool:
        """Whether the exact motion of a case is run: it has one, and a quantity is read from it."""
        asked = [own for own in self.quantities if own.exact is Exact.MOTION]
        if isinstance(case, Case):
            return bool(asked) and (needs_exact_motion if asked == [TRANSMITTANCE] else has_exact_motion)(case)
        return bool(asked)

    def configs(self, names: Sequence[str]) -> list[Config]:
        """Give the configurations that names stand for; of scenes those of `GENERAL`, as engines come first.

        Raises
        ------
        ParameterError
            If a name is unknown, or an engine that is named is not installed.
        """
        case = next(iter(self.cases.values()))
        if not isinstance(case, SceneMotion):
            return variants_named(names or [EVERY_VARIANT])
        asked = names or installed_engine_names()
        found = [config for name in asked for config in _of_scenes(name, case, named=bool(names))]
        own = [config for config in dict.fromkeys(found) if config.formulation == case.formulation]
        return own or list(dict.fromkeys(found))


def _of_scenes(name: str, case: SceneMotion, *, named: bool) -> list[Config]:
    """Give the configurations of a name in a scene: of a bare engine, its presets for any model, and for scenes."""
    parts, settings = name_parts(name)
    if len(parts) > 1 or settings or name not in engine_names():
        return variants_named([name], scenes_only=True)
    if named:
        check_installed(name, engine(name).unavailable_reason())
    elif engine(name).scene_gap(Formulation(case.formulation)):
        return []
    formulation = Formulation(case.formulation)
    return [*general_configs(name, formulation), *scenes_only_configs(name, formulation)]


def general_configs(name: str, formulation: Formulation) -> list[Config]:
    """Give the configurations of an engine whose options hold in any model: default options, then its recipe."""
    presets = engine(name).capabilities.presets.get(formulation, {})
    return [Config(name, str(formulation), preset) for preset in GENERAL if preset in presets]


def scenes_only_configs(name: str, formulation: Formulation) -> list[Config]:
    """Give the configurations of an engine that run nothing but scenes."""
    own = variants_of(name, optional=True, scenes_only=True)
    return [each for each in own if each.formulation == formulation and each.preset.scenes_only]


COMMON_STEP = 0.001
"""Time step at which all engines run scenes, beside their own [s]."""

OWN_STEP = "own step"
"""Said of cases at the engine's own time step, where that is another one."""


def scene_steps(config: Config, case: SceneMotion, common: Sequence[float] = (COMMON_STEP,)) -> dict[str, int]:
    """Give the steps of a scene: those of the engine's own time step, and those of common ones [s]."""
    own = engine(config.engine).scene_step
    named = {} if math.isnan(own) or own == COMMON_STEP else {OWN_STEP: own}
    named |= {f"{1e3 * step:g} ms": step for step in common if step not in named.values()}
    return {name: round(case.time / step) for name, step in named.items()}


def steps_a_row(count: int = 1) -> Steps:
    """Give what divides motions of chains and blocks into so many steps to each of their rows."""
    return lambda _config, case: {"": count * case.rows}


def steady_steps(_config: Config, case: Case) -> dict[str, int]:
    """Give the steps per period of a steady state."""
    return {"": case.steps()}


def largest(number: Any) -> float:
    """Give the size of a number; of an array, of the largest one."""
    return float(np.max(np.abs(number)))


def given(part: Any, *about: Any) -> Any:
    """Give a number that stands for itself, or that a function gives of a run or a case."""
    return part(*about) if callable(part) else part
