"""Where a model starts, and what drives it: a keyframe, and a file of controls."""

import csv
import io
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from multibody_xval.engines.interface.texts import is_number, text_of_file
from multibody_xval.engines.mujoco.probe.load import Loaded
from reference_lcp.errors import ParameterError, checked_choice, shown
from reference_lcp.validation import FloatArray

NONE = "none"
"""Instead of a keyframe: the model's own pose."""


@dataclass(frozen=True)
class Start:
    """A state to start from, and controls."""

    key: int
    """Number of the keyframe; -1 for none."""
    hold: bool
    """Position actuators hold the pose of the keyframe, since it names no controls."""
    times: FloatArray
    """Since the start [s]; empty without a file of controls."""
    controls: FloatArray
    notes: tuple[str, ...]

    def data(self, model: Any) -> Any:
        """Give the state, with all that follows from it."""
        import mujoco

        data = mujoco.MjData(model)
        if self.key >= 0:
            mujoco.mj_resetDataKeyframe(model, data, self.key)
            data.time = 0.0
        mujoco.mj_forward(model, data)
        if self.hold:
            _hold(model, data)
        return data

    def drive(self, model: Any, data: Any) -> None:
        """Set the controls of the next step: those of the last row whose time has come."""
        if len(self.times):
            row = np.searchsorted(self.times, data.time + 1e-6 * model.opt.timestep, side="right") - 1
            data.ctrl[:] = self.controls[max(row, 0)]


def _hold(model: Any, data: Any) -> None:
    """Let actuators that are servos of position want the position that they have."""
    import mujoco

    servos = (model.actuator_biasprm[:, 1] < 0) & (model.actuator_gainprm[:, 0] == -model.actuator_biasprm[:, 1])
    wanted = servos & (model.actuator_dyntype != mujoco.mjtDyn.mjDYN_INTEGRATOR)  # of which the control is a velocity
    data.ctrl[wanted] = data.actuator_length[wanted]
    kept = servos & (model.actuator_actadr >= 0)
    data.act[model.actuator_actadr[kept]] = data.actuator_length[kept]


def started(loaded: Loaded, keyframe: str | None, ctrl: Path | None, until: float) -> Start:
    """Choose the first keyframe of a model or the one that is named, and read the controls."""
    names = [loaded.model.key(number).name or str(number) for number in range(loaded.model.nkey)]
    if keyframe is not None:
        checked_choice("keyframe", keyframe, [*names, NONE])
    key = -1 if keyframe == NONE or not names else names.index(keyframe or names[0])
    times, controls = (np.empty(0), np.empty((0, 0))) if ctrl is None else _controls(loaded.model, ctrl)
    hold = key >= 0 and loaded.model.nu > 0 and not loaded.controls_in_key[key] and ctrl is None
    notes = [_pose(names, key)]
    if ctrl is not None:
        notes.append(f"Controls: {ctrl.name}; each row holds until the time of the next one.")
        if times[-1] < until:
            notes.append(f"The last row, at {times[-1]:g} s, holds until the end.")
    elif hold:
        notes.append("The keyframe names no controls: position actuators hold its pose.")
    elif loaded.model.nu:
        notes.append("Controls: those of the keyframe." if key >= 0 else "Controls: zero.")
    return Start(key, hold, times, controls, tuple(notes))


def ways_to_load(model: Any) -> Iterator[str]:
    """Say how the friction of a model may be loaded that nothing loads."""
    yield 'tilt gravity to load a free box, such as <option gravity="3 0 -9.3"/>'
    if model.nkey:
        yield "--keyframe NAME to start elsewhere"
    if model.nu:
        yield "--ctrl FILE to drive it"


def _pose(names: list[str], key: int) -> str:
    if key < 0:
        return "Start: the pose of the model" + (f", not its keyframes {', '.join(names)}." if names else ".")
    others = [name for number, name in enumerate(names) if number != key]
    return f"Start: keyframe {names[key]}" + (f" of {len(names)}; --keyframe names another." if others else ".")


def _controls(model: Any, file: Path) -> tuple[FloatArray, FloatArray]:
    """Read times and controls of a CSV file; a first row of names may be there."""
    if not model.nu:
        raise ParameterError(f"ctrl = {shown(file.name)}: the model has 0 actuators; allowed: without --ctrl")
    try:
        rows = list(_rows(file, model))
    except (OSError, UnicodeDecodeError, csv.Error) as problem:
        reason = getattr(problem, "strerror", None) or problem
        raise ParameterError(f"ctrl = {shown(file.name)} cannot be read: {reason}; allowed: a CSV file") from None
    if not rows:
        raise ParameterError(f"ctrl = {shown(file.name)} has 0 rows of numbers; allowed: 1 or more")
    table = np.array(rows)
    return table[:, 0], table[:, 1:]


def _rows(file: Path, model: Any) -> Iterator[list[float]]:
    """Give the rows of numbers, each checked."""
    last = -np.inf
    opened = io.StringIO(text_of_file("ctrl", file, encoding="utf-8-sig"), newline="")
    for number, texts in enumerate(csv.reader(opened), start=1):
        if not texts or (number == 1 and not any(map(is_number, texts))):
            continue
        where = f"ctrl = {shown(file.name)}, line {number}:"
        if len(texts) != 1 + model.nu:
            raise ParameterError(f"{where} {len(texts)} columns; allowed: {1 + model.nu}, time and {model.nu} controls")
        for text in texts:
            if not is_number(text) or not np.isfinite(float(text)):
                raise ParameterError(f"{where} {shown(text)} is no finite number; allowed: finite")
        row = [float(text) for text in texts]
        if row[0] <= last:
            raise ParameterError(f"{where} time = {row[0]:g} after {last:g}; allowed: ascending")
        last = row[0]
        yield row
