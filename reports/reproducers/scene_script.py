"""The script of a scene: the scene in the engine's own API, and the number that the suite has."""

import math
import textwrap
from collections.abc import Mapping
from dataclasses import dataclass, replace
from importlib.resources import files
from types import MappingProxyType
from typing import Any

from jinja2 import DictLoader

from multibody_xval.engines.interface.presets import Formulation
from multibody_xval.engines.interface.registry import engine, engine_names
from multibody_xval.engines.interface.scene import GRAVITY, ContactScene, JointScene, SceneSetting
from multibody_xval.engines.interface.variant import Variant
from multibody_xval.reports.formatting import environment
from multibody_xval.reports.reproducers.questions import QUESTIONS
from multibody_xval.reports.reproducers.script import (
    WIDTH,
    Reproduction,
    beside,
    check_not_blocked,
    checked,
    docstring,
    script,
)
from multibody_xval.scenarios.catalogue.registry import CATALOGUE
from multibody_xval.scenarios.catalogue.scenes.base import SceneCase, SceneScenario
from multibody_xval.scenarios.catalogue.scenes.slide import REST
from multibody_xval.scenarios.runs.evaluator import Evaluator
from multibody_xval.scenarios.runs.result import Result
from multibody_xval.scenarios.runs.scene import SceneTask, in_world, kept_rows, plane_axes
from multibody_xval.scenarios.verdicts.finding import Metric
from reference_lcp.errors import ParameterError, checked_choice

TEMPLATE = "scene.py.jinja"
"""File beside an adapter: the blocks ``imports`` and ``simulation`` of jinja2. The second gives the functions ``step``
and ``state``, which gives the place of the last box [m] or the coordinates of joints; a block ``launch`` gives that
box a VELOCITY. They read TIME_STEP and, where there is no text of the model, FRICTION, GRAVITY, BOXES, TILT, TURNED
and NORMAL."""

ON_A_PLANE = MappingProxyType({
    "slope-hold": "load 0.5", "stack-hold": "3 boxes, 12°", "heavy-on-light": "100 kg on 1 kg, 12°",
    "slide-to-stop": "3 m/s",
})  # fmt: skip
"""Scenarios of boxes on a plane, which every template has, with the case that is shown unless another is named."""

SCENES = MappingProxyType({
    **ON_A_PLANE, "grip": "1 kg, 15 N", "held-while-shaken": "slope, mass inside, 60 Hz",
    "joint-hold": "hinge, load 0.9", "arm-hold": "6 hinges, load 0.9",
})  # fmt: skip
"""All that can be reproduced: with an engine that writes the whole scene as a text."""


@dataclass(frozen=True)
class SceneReproduction:
    """What is shown: a number of a variant; see `checked_scene`."""

    variant: Variant
    scenario: SceneScenario
    case: SceneCase

    @property
    def metric(self) -> Metric:
        """The first number of the scenario."""
        return self.scenario.metrics[0]

    @property
    def task(self) -> SceneTask:
        """The scene, with the engine's own time step."""
        ((_, task), *_) = self.scenario.tasks(self.variant, [self.case]).values()
        return task

    def number(self, result: Result) -> tuple[Metric, float]:
        """Give the first number of the scenario; NaN without a motion."""
        if not result.series:
            return self.metric, math.nan
        ((metric, read), *_) = self.scenario.numbers(self.case, self.task, result.series).items()
        return metric, read.value


def checked_scene(name: str, scenario: str, case: str | None = None) -> SceneReproduction:
    """Check what is to be shown, before any work."""
    variant, shown = Variant.parse(name), CATALOGUE[scenario]
    assert isinstance(shown, SceneScenario), "scripts of scenes are of scenarios of scenes"
    cases = {each.name: each for each in shown.cases if not each.sleeping}
    chosen = SCENES[scenario] if case is None else checked_choice("case", case, list(cases))
    reproduction = SceneReproduction(variant, shown, cases[chosen])
    reason = reproduction.task.unsupported_reason()
    if reason is not None:
        raise ParameterError(reason)
    if not has_scene_script(variant.engine, scenario):
        allowed = ", ".join(each for each in engine_names() if has_scene_script(each, scenario))
        raise ParameterError(f"engine = {variant.engine} has no script of {scenario}; allowed: {allowed}")
    return reproduction


def reproduction(variant: str, scenario: str, case: str | None = None) -> Reproduction | SceneReproduction:
    """Check what is to be shown, of the chain, a block or a scene, before any work."""
    checked_choice("scenario", scenario, [*QUESTIONS, *SCENES])
    return (checked_scene if scenario in SCENES else checked)(variant, scenario, case)


def reproduction_script(shown: Reproduction | SceneReproduction, evaluator: Evaluator) -> str:
    """Write the script of what `reproduction` gives."""
    return script(shown, evaluator) if isinstance(shown, Reproduction) else scene_script(shown, evaluator)


def has_scene_script(name: str, scenario: str) -> bool:
    """Whether there is a template for a scenario in an engine."""
    adapter = engine(name) if name in engine_names() else None
    if adapter is None or not beside(adapter, TEMPLATE).is_file():
        return False
    return scenario in (SCENES if adapter.scene_models else ON_A_PLANE)


def scene_script(shown: SceneReproduction, evaluator: Evaluator) -> str:
    """Write the script of one number; the suite's own is in its header, computed where the store lacks it."""
    (result,) = evaluator.evaluate([shown.task])
    check_not_blocked(shown.variant, shown.case.name, result)
    metric, value = shown.number(result)
    templates = environment(markup=False)
    frame = files("multibody_xval.reports.reproducers").joinpath("templates", TEMPLATE).read_text(encoding="utf-8")
    own = beside(engine(shown.variant.engine), TEMPLATE).read_text(encoding="utf-8")
    templates.loader = DictLoader({"engine": own, "scene": frame})
    suite = f"{value:.6g} {metric.unit}" if math.isfinite(value) else f"no number ({result.reason or result.status})"
    text = templates.get_template("engine").render(
        header=_header(shown, metric, suite), metric=metric, **_numbers(shown)
    )
    return text.rstrip() + "\n"


def _header(shown: SceneReproduction, metric: Metric, suite: str) -> str:
    variant, adapter = shown.variant, engine(shown.variant.engine)
    version = "" if adapter.unavailable_reason() is not None else f" {adapter.version()}"
    title = f"{adapter.capabilities.title}{version}: {shown.scenario.question}"
    told = (
        f"{variant.formulation}, {variant.preset_name}: {variant.preset.description} {shown.scenario.name}: "
        f"{shown.case.name}. Exact: 0 {metric.unit}; the cross-validation suite has {suite}."
    )
    return docstring(title, told)


def _numbers(shown: SceneReproduction) -> Mapping[str, Any]:
    """Give what the templates print of the scene and of its run."""
    task, scene, variant = shown.task, shown.task.scene, shown.variant
    setting = SceneSetting(variant.preset, task.time_step)
    model = engine(variant.engine).scene_models.get(Formulation(variant.formulation))
    numbers: dict[str, Any] = {
        "preset": variant.preset,
        "changed": lambda name: _literal(setting.changed(name)),
        "model": _broken(model(scene, setting)) if model else "",
        "time_step": repr(task.time_step),
        "settling": round(task.settling / task.time_step),
        "steps": task.steps,
        "time": task.time,
        "launch": (),
        "tones": [(tone.force, tone.frequency) for tone in task.shake],
    }
    if not isinstance(scene, ContactScene):
        load = scene.load if isinstance(scene, JointScene) else 0.0
        return {**numbers, "contact": False, "force": load}
    numbers |= {"contact": True, "force": scene.grip, "gravity": GRAVITY, "scene": scene}
    numbers["axes"] = plane_axes(scene)[[2, 1] if scene.grip else [0, 1]].tolist()
    heights = [place[2] for place in replace(scene, slope=0.0).places]
    numbers["stack"] = [(box.mass, box.side, height) for box, height in zip(scene.boxes, heights, strict=True)]
    if any(task.launch):
        rows = kept_rows(task.steps)
        stop = next(row for row in rows if (row + 1) * task.time_step >= task.time - REST)
        distance = math.hypot(*task.launch) ** 2 / (2 * scene.friction * GRAVITY)
        numbers |= {"steps": stop + 1, "launch": in_world(scene, task.launch), "distance": repr(distance)}
    return numbers


def _literal(value: Any) -> Any:
    """Give a value as Python writes it; ``None`` of an option that is not changed."""
    return None if value is None else repr(value)


def _broken(model: str) -> str:
    """Give a text of XML with a line an element, or more."""
    elements = model.replace("><", ">\n<").replace(" />", "/>").replace(" >", ">").split("\n")
    return "\n".join(line for element in elements for line in textwrap.wrap(element, WIDTH))
