"""A motion that any program wrote: judged beside the exact one, or refused with what is wrong."""

import re
from functools import cache

import numpy as np
import pytest

from multibody_xval.scenarios.truth import judged, problem_named, read_motion
from reference_lcp.errors import ParameterError
from reference_lcp.lcp.systems import simulate_system


@cache
def moved(name, refined, friction):
    """Simulate a problem with the symplectic Euler scheme, in `refined` times as many steps."""
    problem = problem_named(name)
    pressed = [force * friction for force in problem.contact_normal_force]
    step = problem.time_step / refined
    return simulate_system(
        problem.model_copy(update={"contact_normal_force": pressed}).system,
        position=problem.start_position,
        velocity=problem.start_velocity,
        time_step=step,
        steps=round(problem.times[-1] / step),
    )


def written(folder, problem, *, refined=1, scale=1.0, velocities=True, friction=1.0):
    """Write the motion that `moved` gives, in units of `scale`."""
    motion = moved(problem.name, refined, friction)
    bodies = range(len(problem.masses))
    names = ["time", *(f"x{body}" for body in bodies), *(f"v{body}" for body in bodies if velocities)]
    columns = [motion.time[:, None], scale * motion.positions, *([scale * motion.velocities] if velocities else [])]
    file = folder / "motion.csv"
    np.savetxt(file, np.hstack(columns), delimiter=",", header=",".join(names), comments="")
    return file


def passes(problem, file, time_step=None):
    return (judged(problem, read_motion(file, problem), time_step).verdict == "agrees").all()


def test_a_scheme_of_first_order_agrees_with_its_own_step_and_not_with_a_finer_one(tmp_path):
    problem = problem_named("cell-let-go")
    file = written(tmp_path, problem)
    assert passes(problem, file)
    assert not passes(problem, file, problem.time_step / 10)
    found = judged(problem, read_motion(file, problem))
    file = written(tmp_path, problem, refined=4, velocities=False)
    alone = judged(problem, read_motion(file, problem), problem.time_step / 4)
    assert alone.verdict.tolist() == ["agrees", "agrees"]
    assert (alone.position_allowed < found.position_allowed).all()
    assert alone.velocity_off.isna().all()


def test_a_held_block_that_creeps_deviates_and_has_slid(tmp_path):
    problem = problem_named("block-held")
    file = tmp_path / "motion.csv"
    file.write_text("\n".join(["time,x0", *(f"{time},{1e-9 * time}" for time in problem.times)]))
    row = judged(problem, read_motion(file, problem)).iloc[0]
    assert (row.verdict, row.exact, row.motion) == ("deviates", "held", "slid")
    assert (row.position_off, row.position_time) == (1e-9, 1.0)


@pytest.mark.parametrize("velocities", [True, False])
@pytest.mark.parametrize(
    ("name", "friction", "states"),
    [
        ("block-held", 1.0, ["held"]),
        ("block-breaks-away", 1.0, ["slid"]),
        ("block-stops", 1.0, ["stuck"]),
        ("block-stops", 0.9, ["stuck"]),
        ("pushed-up-a-slope", 0.9, None),
        ("slope-grid", 1.0, ["held", "held", "slid", "slid"] * 3),
        ("slope-grid", 1.1, ["held", "held", "held", "slid"] * 3),
        ("cell-let-go", 1.0, ["–", "stuck"]),
        ("chain-steady-0.6-0.7", 0.9, None),
    ],
)
def test_what_a_body_does_is_held_slid_or_stuck_and_a_tenth_of_friction_is_found(
    name, friction, states, velocities, tmp_path
):
    problem = problem_named(name)
    found = judged(problem, read_motion(written(tmp_path, problem, velocities=velocities, friction=friction), problem))
    assert states is None or found.motion.tolist() == states
    assert (found.verdict == "agrees").all() == (friction == 1)
    assert (found.verdict[found.motion != found.exact] == "deviates").all()


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("", r"columns of .*motion.csv = '' lack time; allowed: 'time, x0'"),
        ("time,x0\n0.1,nan", r"line 2 of motion.csv = '0.1,nan'; allowed: a finite number a column"),
        ("time,x0\n0.2,0\n0.1,0", r"2 that do not rise; allowed: two or more"),
        ("time,x0\n0.1,0\n0.2,0", r"no row at 0.3 s, but 2 from 0.1 to 0.2 s; allowed: one at each of the problem's"),
    ],
)
def test_a_file_that_says_something_else_is_refused(text, message, tmp_path):
    file = tmp_path / "motion.csv"
    file.write_text(text)
    problem = problem_named("block-held")
    with pytest.raises(ParameterError, match=message):
        judged(problem, read_motion(file, problem))


@pytest.mark.parametrize(("name", "scale", "unit"), [("block-stops", 1e3, "mm"), ("cell-let-go", 1e-3, "km")])
def test_other_units_are_named(name, scale, unit, tmp_path):
    problem = problem_named(name)
    motion = read_motion(written(tmp_path, problem, scale=scale), problem)
    message = re.escape(f"{scale:g} times the exact ones, as if in {unit}; allowed: m")
    with pytest.raises(ParameterError, match=message):
        judged(problem, motion)
    with pytest.raises(ParameterError, match=r"time_step = .*> 0"):
        judged(problem, motion, 0.0)
