"""Box2D: what only its skins, its largest step and its module do; more in `test_own_values.py`."""

import dataclasses
import subprocess
import sys

import numpy as np
import pytest

from reference_lcp.chain.trajectory import State
from tests.engines.scheme_oracle import AMPLITUDE, lane_of, run

pytestmark = pytest.mark.needs("box2d")


def test_small_boxes_do_not_touch_the_cell_beside_theirs() -> None:
    """In SI units Box2D's skins are as thick as boxes of a chain that moves by a millimetre."""
    lane = lane_of()
    small = dataclasses.replace(lane, drive=dataclasses.replace(lane.drive, amplitude=AMPLITUDE / 10))
    pressed = run("box2d:contact:default", small, State.at_rest(1, 7), 20).normal_force
    np.testing.assert_allclose(pressed, np.broadcast_to(lane.chain.normal_force, pressed.shape), rtol=1e-4)


def test_warnings_as_errors_do_not_end_the_interpreter() -> None:
    """Box2D's own module warns while it is loaded, and dies if that is raised."""
    program = "from multibody_xval.engines.box2d.joint import import_box2d; print(import_box2d().b2World().bodyCount)"
    done = subprocess.run([sys.executable, "-W", "error", "-c", program], capture_output=True, text=True, check=False)
    assert (done.returncode, done.stdout.strip(), done.stderr) == (0, "0", "")


def test_boxes_that_pass_the_largest_step_are_reported() -> None:
    fast = State(np.zeros((1, 14)), np.full((1, 14), 100 * AMPLITUDE / lane_of().time_step))
    with pytest.raises(RuntimeError, match="Box2D cuts off at"):
        run("box2d:contact", lane_of(0.0), fast, 1)
