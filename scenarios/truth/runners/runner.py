"""Read the problems, and say how far the motions of an engine are from the exact ones. Needs NumPy."""

import json
import sys

import numpy as np


def judge(problem, rows):
    """Give the largest error over what is allowed, of positions and velocities at the times of a problem.

    `rows` yields time, positions and velocities after every step.
    """
    quantities = [
        (np.array(problem[many]), np.array(problem[f"{one}_error"]) + problem[f"{one}_uncertainty"])
        for one, many in (("position", "positions"), ("velocity", "velocities"))
    ]
    worst, number, times = 0.0, 0, problem["times"]
    for time, *motion in rows:
        if time < times[number] - problem["time_step"] / 2:
            continue
        for own, (exact, allowed) in zip(motion, quantities):
            part = np.max(np.abs(np.asarray(own) - exact[number]) / allowed)
            worst = np.inf if np.isnan(part) else max(worst, part)
        number += 1
        if number == len(times):
            return worst
    return np.inf  # the motion ended too early


def run(simulate, files=None):
    """Judge the motions of an engine; gives the exit code: 0 if all pass, 1 if one does not, 2 for another file."""
    code = 0
    for file in files or sys.argv[1:]:
        with open(file, encoding="utf-8") as text:
            problem = json.load(text)
        if problem.get("format") != 1:
            print(f"{file} is no problem of format 1", file=sys.stderr)
            return 2
        part = judge(problem, simulate(problem))
        print(f"{'ok    ' if part <= 1 else 'FAILED'} {file}: {part:.3f} of what is allowed")
        code = code if part <= 1 else 1
    return code
