"""The script of a scene: the scene in the engine's own API, and the number that the suite has."""

import math
import textwrap
from collections.abc import Mapping
from dataclasses import replace
from importlib.resources import files
from types import MappingProxyType
from typing import Any

from jinja2 import DictLoader

from multibody_xval.engines.interface.presets import Formulation
from multibody_xval.engines.interface.registry import engine, engine_names
from multibody_xval.engines.interface.scene import GRAVITY, ContactScene, JointScene, SceneSetting
from multibody_xval.reports.formatting import environment
from multibody_xval.reports.reproducers.questions import Number, Reproduction
from multibody_xval.reports.reproducers.script import WIDTH, beside, header
from multibody_xval.scenarios.cases.scene_motion import SceneMotion
from multibody_xval.scenarios.catalogue.all_scenarios import SCENARIOS
from multibody_xval.scenarios.catalogue.scenes.sliding_boxes import REST
from multibody_xval.scenarios.compute.scenes import in_world, kept_rows, plane_axes, unsupported_reason
from multibody_xval.scenarios.model import Config, Run
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


def checked_scene(name: str, scenario: str, case: str | None = None) -> Reproduction:
    """Check what is to be shown, before any work; a bare engine stands for its recipe, or else its default options."""
    shown = SCENARIOS[scenario]
    config = [Config.parse(name), *(shown.configs([name]) if name in engine_names() else ())][-1]
    allowed = [each for each, own in shown.cases.items() if isinstance(own, SceneMotion) and not own.sleeping]
    chosen = SCENES[scenario] if case is None else checked_choice("case", case, allowed)
    run = Run(config, shown.cases[chosen], next(iter(shown.steps(config, shown.cases[chosen]).values())))
    reason = unsupported_reason(config, run.of(SceneMotion).scene)
    if reason is not None:
        raise ParameterError(reason)
    if not has_scene_script(config.engine, scenario):
        engines = ", ".join(each for each in engine_names() if has_scene_script(each, scenario))
        raise ParameterError(f"engine = {config.engine} has no script of {scenario}; allowed: {engines}")
    return Reproduction(shown, chosen, run)


def has_scene_script(name: str, scenario: str) -> bool:
    """Whether there is a template for a scenario in an engine."""
    adapter = engine(name) if name in engine_names() else None
    if adapter is None or not beside(adapter, TEMPLATE).is_file():
        return False
    return scenario in (SCENES if adapter.scene_models else ON_A_PLANE)


def scene_script(shown: Reproduction, number: Number) -> str:
    """Write the script of one number; the suite's own is in its header."""
    templates = environment(markup=False)
    frame = files("multibody_xval.reports.reproducers").joinpath("templates", TEMPLATE).read_text(encoding="utf-8")
    own = beside(engine(shown.run.config.engine), TEMPLATE).read_text(encoding="utf-8")
    templates.loader = DictLoader({"engine": own, "scene": frame})
    text = templates.get_template("engine").render(
        header=header(shown, number), quantity=shown.quantity, **_numbers(shown.run)
    )
    return text.rstrip() + "\n"


def _numbers(run: Run) -> Mapping[str, Any]:
    """Give what the templates print of the scene and of its run."""
    config, case = run.config, run.of(SceneMotion)
    scene, time_step = case.scene, case.time / run.steps
    setting = SceneSetting(config.preset, time_step)
    model = engine(config.engine).scene_models.get(Formulation(config.formulation))
    numbers: dict[str, Any] = {
        "preset": config.preset,
        "changed": lambda name: _literal(setting.changed(name)),
        "model": _broken(model(scene, setting)) if model else "",
        "time_step": repr(time_step),
        "settling": round(case.settling / time_step),
        "steps": run.steps,
        "time": case.time,
        "launch": (),
        "tones": [(tone.force, tone.frequency) for tone in case.shake],
    }
    if not isinstance(scene, ContactScene):
        load = scene.load if isinstance(scene, JointScene) else 0.0
        return {**numbers, "contact": False, "force": load}
    numbers |= {"contact": True, "force": scene.grip, "gravity": GRAVITY, "scene": scene}
    numbers["axes"] = plane_axes(scene)[[2, 1] if scene.grip else [0, 1]].tolist()
    heights = [place[2] for place in replace(scene, slope=0.0).places]
    numbers["stack"] = [(box.mass, box.side, height) for box, height in zip(scene.boxes, heights, strict=True)]
    if any(case.launch):
        rows = kept_rows(run.steps)
        stop = next(row for row in rows if (row + 1) * time_step >= case.time - REST)
        distance = math.hypot(*case.launch) ** 2 / (2 * scene.friction * GRAVITY)
        numbers |= {"steps": stop + 1, "launch": in_world(scene, case.launch), "distance": repr(distance)}
    return numbers


def _literal(value: Any) -> Any:
    """Give a value as Python writes it; ``None`` of an option that is not changed."""
    return None if value is None else repr(value)


def _broken(model: str) -> str:
    """Give a text of XML with a line an element, or more."""
    elements = model.replace("><", ">\n<").replace(" />", "/>").replace(" >", ">").split("\n")
    return "\n".join(line for element in elements for line in textwrap.wrap(element, WIDTH))
