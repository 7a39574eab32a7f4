"""What scenes share: the variants and time steps that they are run with, and how their numbers are judged.

There is no chain, and nothing is chosen for one: a preset may only have options that can be copied into any model.
"""

import math
from abc import abstractmethod
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import ClassVar, NamedTuple

import numpy as np

from multibody_xval.engines.interface.presets import Formulation
from multibody_xval.engines.interface.registry import engine, engine_names
from multibody_xval.engines.interface.scene import Scene, Vector, formulation_of
from multibody_xval.engines.interface.variant import GENERAL, Variant, check_installed, name_parts, variants_named
from multibody_xval.scenarios.catalogue.base import Scenario
from multibody_xval.scenarios.catalogue.block.base import ROUND_OFF, ROUNDINGS
from multibody_xval.scenarios.runs.evaluator import Evaluator
from multibody_xval.scenarios.runs.result import NamedNumbers, Result, ResultStatus
from multibody_xval.scenarios.runs.scene import SceneTask, Tone
from multibody_xval.scenarios.verdicts.finding import Comparison, Finding, Metric, Tolerance, Verdict
from multibody_xval.scenarios.verdicts.judge import decide, missing
from reference_lcp.validation import FloatArray

COMMON_STEP = 0.001
"""Time step at which all engines are compared, beside their own [s]."""

OWN_STEP = "own step"
"""Ends the names of cases at the engine's own step, where that is another one."""

SETTLING = 1.0
"""How long bodies are left alone before they are measured [s]."""

HOLDING = 2.0
"""How long what should hold is watched [s]."""

CREEP_RESOLUTION = 0.1
"""Creep that counts as none [µm/s], [µrad/s]: a tenth of the slowest that has to be found, 1 mm in three hours."""

CREEP = Metric("creep", "µm/s", f"Mean velocity over {HOLDING:g} s of a body that friction should hold.")


SAG_RESOLUTION = 1.0
"""Way since a scene was built that counts as none [mm], [mrad]: bodies that are put in touch settle by less."""

SAG = Metric("sag", "mm", "Way of a body that friction should hold since the scene was built.")


class Measured(NamedTuple):
    """A number of a motion, what it should be, and what may be left of the difference."""

    value: float
    expected: float
    resolution: float
    """What cannot be told from nothing, in the number's unit."""
    own_step: float = 0.0
    """Error of semi-implicit Euler steps of this size in an exact solution of their contacts."""


@dataclass(frozen=True, kw_only=True)
class SceneCase:
    """One scene, with how long it is left alone, launched and followed; see `SceneTask`."""

    name: str
    scene: Scene
    time: float
    settling: float = SETTLING
    launch: Vector = (0.0, 0.0, 0.0)
    spin: float = 0.0
    sleeping: bool = False
    shake: tuple[Tone, ...] = ()

    def task(self, variant: Variant, time_step: float) -> SceneTask:
        """Give the task of a variant."""
        return SceneTask(
            variant=variant,
            scene=self.scene,
            time_step=time_step,
            time=self.time,
            settling=self.settling,
            launch=self.launch,
            spin=self.spin,
            sleeping=self.sleeping,
            shake=self.shake,
        )


class SceneScenario(Scenario):
    """A scenario of scenes: subclasses say which, and what is read of them."""

    source = "Coulomb's law for rigid bodies: closed forms."
    cases: ClassVar[Sequence[SceneCase]]
    held_out: ClassVar[Sequence[SceneCase]] = ()
    """Variations that no recipe is found with."""

    @property
    def formulation(self) -> Formulation:
        """Where the friction acts."""
        return formulation_of(self.cases[0].scene)

    @abstractmethod
    def numbers(self, case: SceneCase, task: SceneTask, series: NamedNumbers) -> Mapping[Metric, Measured]:
        """Read what is compared from the series of a motion."""

    def variants(self, names: Sequence[str]) -> list[Variant]:
        """Give variants: default and recommended of engines that are named alone, or of all that have such scenes."""
        chosen: list[Variant] = []
        for name in names or [each for each in engine_names() if not engine(each).scene_gap(self.formulation)]:
            parts, settings = name_parts(name)
            if len(parts) == 1 and not settings and name in engine_names():
                if names:
                    check_installed(name, engine(name).unavailable_reason())
                chosen += general_variants(name, self.formulation)
            else:
                chosen += variants_named([name])
        own = [variant for variant in dict.fromkeys(chosen) if variant.formulation == self.formulation]
        return own or list(dict.fromkeys(chosen))

    def law_variant(self, variant: Variant) -> None:
        """Give none: laws are of the chain."""

    def steps(self, variant: Variant) -> dict[str, float]:
        """Give the time steps that a variant is run with, by what is added to the names of cases [s]."""
        own = engine(variant.engine).scene_step
        steps = {f"{1e3 * COMMON_STEP:g} ms": COMMON_STEP}
        return steps if math.isnan(own) or own == COMMON_STEP else {OWN_STEP: own, **steps}

    def tasks(self, variant: Variant, cases: Sequence[SceneCase]) -> dict[str, tuple[SceneCase, SceneTask]]:
        """Give the cases and their tasks by name: at the engine's own step, then at the common one."""
        return {
            f"{case.name}, {label}": (case, case.task(variant, step))
            for label, step in self.steps(variant).items()
            for case in cases
        }

    def run(self, variants: Sequence[Variant], evaluator: Evaluator) -> list[Finding]:
        """Run every case with every variant; see `Scenario.run`."""
        return self.judged(variants, self.cases, evaluator)

    def judged(self, variants: Sequence[Variant], cases: Sequence[SceneCase], evaluator: Evaluator) -> list[Finding]:
        """Run cases with every variant, and judge their numbers."""
        named = [(variant, self.tasks(variant, cases)) for variant in variants]
        evaluator.evaluate([task for _, own in named for _, task in own.values()])
        return [
            finding
            for variant, own in named
            for name, (case, task) in own.items()
            for finding in self._findings(variant, name, case, task, evaluator)
        ]

    def _findings(
        self, variant: Variant, name: str, case: SceneCase, task: SceneTask, evaluator: Evaluator
    ) -> Iterator[Finding]:
        """Judge one case at one step; what explodes disagrees in everything."""
        (result,) = evaluator.evaluate([task])
        gap = _gap(result)
        if gap is not None:
            yield from Finding.without_numbers(variant, name, self.metrics, gap)
            return
        for metric, read in self.numbers(case, task, result.series).items():
            tolerance = Tolerance(scheme=read.own_step, resolution=read.resolution)
            comparison = decide(metric, read.value, read.expected, tolerance)
            yield Finding(variant, name, metric, read.value, read.expected, comparison)


def _gap(result: Result) -> Comparison | None:
    """Give the verdict of a result without numbers; ``None`` of one with."""
    if result.status is ResultStatus.DIVERGED:
        return Comparison(Verdict.DISAGREE, "the engine failed: the scene exploded")
    return missing("", [result])


def general_variants(name: str, formulation: Formulation) -> list[Variant]:
    """Give the variants of an engine whose options can be copied into any model, as it comes first."""
    presets = engine(name).capabilities.presets.get(formulation, {})
    return [Variant(name, str(formulation), preset) for preset in GENERAL if preset in presets]


def round_off(task: SceneTask, size: float = 1.0) -> float:
    """Give by how much roundings of positions of this `size` [m] or angles [rad] move a body at most."""
    return ROUNDINGS * ROUND_OFF[task.variant.capabilities.precision] * size


def creep(task: SceneTask, *ways: FloatArray) -> Measured:
    """Read how fast a body moves that should not, from its ways along some axes [m], or angles [rad]."""
    way = float(np.linalg.norm([own[-1] for own in ways]))
    resolution = CREEP_RESOLUTION + 1e6 * round_off(task) / task.time
    return Measured(1e6 * way / task.time, 0.0, resolution)


def sag(*ways: float) -> Measured:
    """Read how far a body has moved since it was let go that should not, along some axes [m], or angles [rad]."""
    return Measured(1e3 * float(np.linalg.norm(ways)), 0.0, SAG_RESOLUTION)
