"""What a script of a scene says: the adapter's own lines, and those that read its number."""

import ast
import math
from collections.abc import Mapping, Sequence
from typing import Any

from multibody_xval.engines.interface.presets import Formulation
from multibody_xval.engines.interface.registry import engine
from multibody_xval.engines.interface.scene import GRAVITY, ContactScene, JointScene, SceneSetting
from multibody_xval.engines.isolated.out_of_process import OutOfProcessEngine, ServedScene
from multibody_xval.reports.formatting import environment
from multibody_xval.reports.reproducers.known import names_set
from multibody_xval.reports.reproducers.questions import Number, Reproduction
from multibody_xval.reports.reproducers.served import builder, given
from multibody_xval.reports.reproducers.specialise import specialised
from multibody_xval.reports.reproducers.tidy import imports_of, model_text, names_read, text_of, used
from multibody_xval.scenarios.cases.scene_motion import SceneMotion
from multibody_xval.scenarios.catalogue.scenes import pushed_box, sliding_boxes, spinning_box, stopping_joints
from multibody_xval.scenarios.compute.scenes import STOPPED, in_world, kept_rows, plane_axes
from multibody_xval.scenarios.model import Run

PARTS = {"torque": 1, "friction": 2, "time": 2}
"""What numbers are read from: orientations, or velocities; others from places, or coordinates of joints."""

UNITS = {
    "GRAVITY": "m/s²", "GROUND": "m", "FINGER": "m", "BELT": "m", "FINGER_MASS": "kg", "BELT_MASS": "kg",
    "BELT_FORCE": "N", "LINK_LENGTH": "m", "LINK_HALF": "m", "LINK_MASS": "kg", "LINK_INERTIA": "kg m²", "END": "s",
}  # fmt: skip
"""Of constants."""


def scene_lines(shown: Reproduction, number: Number) -> str:
    """Write the scene in the engine's own API, its motion, and what reads the number."""
    run, case = shown.run, shown.run.of(SceneMotion)
    config, time_step = run.config, case.time / run.steps
    build = engine(config.engine).scene_worlds[Formulation(config.formulation)]
    setting = SceneSetting(config.preset, time_step)
    if isinstance(engine(config.engine), OutOfProcessEngine):
        world = build(case.scene, setting)
        assert isinstance(world, ServedScene)
        own = specialised(builder(world.server), {"given": given(world.given)})
    else:
        own = specialised(build, {"scene": case.scene, "setting": setting})
    runs = "run" in names_set(*own.world)
    if not runs:
        _read_part(own.world, PARTS.get(shown.quantity.name, 0))
    templates = environment("multibody_xval.reports.reproducers", markup=False)
    frame = templates.get_template("scene.py.jinja").render(
        quantity=shown.quantity,
        exact=f"{number.exact:g}",
        closes="close" in names_set(*own.world),
        runs=runs,
        **_numbers(run),
    )
    constants = [ast.Assign([ast.Name(name, ast.Store())], value) for name, value in own.constants.items()]
    lines = used([*constants, *own.helpers.values(), *own.world], frame)
    read = names_read([*lines, ast.parse(frame)])
    settling = round(case.settling / time_step)
    parts = [
        *["\n".join(["import sys", "", *own.switches])] * bool(own.switches),
        "\n".join(imports_of(own.imports | {"import numpy as np", "import math"}, read)),
        "\n".join(own.starts),
        "\n".join(
            [
                f"TIME_STEP = {time_step!r}  # s",
                *[f"SETTLING = {settling}  # steps"] * (settling > 0),
                f"STEPS = {run.steps}",
                text_of([line for line in lines if line in constants], UNITS),
            ]
        ).strip(),
        *(model_text(text, name) for text, name in own.models.items()),
        text_of([line for line in lines if line not in constants], {}),
        frame.strip(),
    ]
    return "\n\n".join(part for part in parts if part) + "\n"


def _read_part(lines: Sequence[ast.stmt], part: int) -> None:
    """Leave one part of a state: its place, its orientation or its velocity."""
    (state,) = (line for line in lines if isinstance(line, ast.FunctionDef) and line.name == "state")
    last: Any = state.body[-1]
    last.value = last.value.elts[part]


def _numbers(run: Run) -> Mapping[str, Any]:
    """Give the numbers of a scene by which its motion is followed, and read."""
    case = run.of(SceneMotion)
    scene = case.scene
    launched = any(case.launch) or case.spin
    numbers: dict[str, Any] = {
        "settling": bool(case.settling), "time": case.time, "kept": kept_rows(run.steps), "spin": case.spin,
        "boxes": False, "launch": in_world(scene, case.launch) if launched else None,
        "push": case.push, "tones": [(tone.force, tone.frequency) for tone in case.shake],
    }  # fmt: skip
    if not isinstance(scene, ContactScene):
        if isinstance(scene, JointScene) and scene.velocity:
            numbers |= {"stopped": STOPPED, "exact_stop": repr(stopping_joints.exact_stop(scene)[0])}
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
    if case.push:
        numbers |= {"pushed": repr(pushed_box.way_pushed(case)), "straight": list(scene.forward[:2])}
    if case.spin:
        numbers |= {"braking": repr(spinning_box.braking(scene, spinning_box.CORNERS))}
    return numbers
