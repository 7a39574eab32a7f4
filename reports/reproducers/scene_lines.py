"""What a script of a scene says: the adapter's own lines, and those that read its number."""

import math
from collections.abc import Mapping
from typing import Any

from multibody_xval.engines.interface.presets import Formulation
from multibody_xval.engines.interface.registry import engine
from multibody_xval.engines.interface.scene import GRAVITY, ContactScene, SceneSetting
from multibody_xval.reports.formatting import environment
from multibody_xval.reports.reproducers.own_lines import Lines
from multibody_xval.reports.reproducers.questions import Number, Reproduction
from multibody_xval.scenarios.cases.scene_motion import SceneMotion
from multibody_xval.scenarios.catalogue.scenes import sliding_boxes, spinning_box
from multibody_xval.scenarios.compute.scenes import in_world, kept_rows, plane_axes
from multibody_xval.scenarios.model import Run

PARTS = {"torque": 1, "friction": 2, "time": 2}
"""What numbers are read from: orientations, or velocities; others from places, or coordinates of joints."""


def scene_lines(shown: Reproduction, number: Number) -> str:
    """Write the scene in the engine's own API, its motion, and what reads the number."""
    run, case = shown.run, shown.run.of(SceneMotion)
    config, time_step = run.config, case.time / run.steps
    templates = environment("multibody_xval.reports.reproducers", markup=False)
    frame = templates.get_template("scene.py.jinja").render(
        quantity=shown.quantity, exact=f"{number.exact:g}", **_numbers(run)
    )
    lines = Lines()
    build = engine(config.engine).scene_worlds[Formulation(config.formulation)]
    lines.add(
        build, PARTS.get(shown.quantity.name, 0), scene=case.scene, setting=SceneSetting(config.preset, time_step)
    )
    lines.imports["import numpy as np"] = None
    lines.imports["import math"] = None
    settling = round(case.settling / time_step)
    named = ("TIME_STEP, SETTLING, STEPS", f"{time_step!r}, {settling}, {run.steps}  # s, 1, 1")
    if not settling:
        named = ("TIME_STEP, STEPS", f"{time_step!r}, {run.steps}  # s, 1")
    return lines.text(" = ".join(named), frame)


def _numbers(run: Run) -> Mapping[str, Any]:
    """Give the numbers of a scene by which its motion is followed, and read."""
    case = run.of(SceneMotion)
    scene = case.scene
    launched = any(case.launch) or case.spin
    numbers: dict[str, Any] = {
        "settling": bool(case.settling), "time": case.time, "kept": kept_rows(run.steps), "spin": case.spin,
        "boxes": False, "launch": in_world(scene, case.launch) if launched else None,
        "tones": [(tone.force, tone.frequency) for tone in case.shake],
    }  # fmt: skip
    if not isinstance(scene, ContactScene):
        return numbers
    axes = plane_axes(scene)[[2, 1] if scene.grip else [0, 1]].tolist()
    numbers |= {"boxes": True, "axes": axes, "bound": repr(scene.friction * GRAVITY * math.cos(scene.slope)),
                "pull": repr(GRAVITY * math.sin(scene.slope))}  # fmt: skip
    if any(case.launch):
        time_step = case.time / run.steps
        stop = next(row for row in kept_rows(run.steps) if time_step * (row + 1) >= case.time - sliding_boxes.REST)
        numbers |= {"stop": stop, "distance": repr(sliding_boxes.way_to_stop(case))}
    if scene.belt:
        reached, expected = sliding_boxes.REACHED, sliding_boxes.time_with_belt(case)
        numbers |= {"reached": reached, "aim": repr(reached * scene.belt), "expected": repr(expected)}
    if case.spin:
        numbers |= {"braking": repr(spinning_box.braking(scene, spinning_box.CORNERS))}
    return numbers
