"""The blocks of a problem, one by one, for plain scripts of engines. Standard library only, any Python 3.

A script is run as ``python mujoco_blocks.py KIND PROBLEM.json [OPTION …] > motion.csv``, with its engine alone.
"""

import json
import math
import sys

SETTLED = 0.5
"""Seconds for which a box rests before the motion: when DART, for one, puts to sleep what does not move."""


class Block:
    """One body of a problem without springs, on the ground or on a rail."""

    def __init__(self, problem, body):
        if problem["spring_first"]:
            sys.exit("error: a problem with springs; allowed: blocks without")
        contact, pulls = problem["contact_first"].index(body), problem["force_body"]
        self.mass, self.velocity = problem["masses"][body], problem["start_velocity"][body]
        self.friction, self.step = problem["contact_kinetic"][contact], problem["time_step"]
        self.steps, self.settling = round(problem["times"][-1] / self.step), round(SETTLED / self.step)
        self._omega = problem["angular_frequency"]
        self._normal = problem["contact_normal_force"][contact], problem["contact_normal_amplitude"][contact]
        pull = pulls.index(body) if body in pulls else None
        self._pull = (0.0, 0.0) if pull is None else (problem["force_mean"][pull], problem["force_amplitude"][pull])

    @property
    def bound(self):
        """Friction of a joint in an engine that fixes it when the model is made [N]."""
        if self._normal[1]:
            sys.exit("error: friction of this joint is fixed when the model is made; allowed: a constant normal force")
        return self.friction * self._normal[0]

    def pull(self, step):
        """Give the force along the ground at the start of a step [N]."""
        return self._pull[0] + self._pull[1] * math.sin(self._omega * step * self.step)

    def normal(self, step):
        """Give the force that presses at the start of a step [N]."""
        return self._normal[0] + self._normal[1] * math.sin(self._omega * step * self.step)

    @property
    def gravity(self):
        """Gravity that presses as the mean of that force does [m/s²]."""
        return self._normal[0] / self.mass

    def forces(self, step):
        """Give what acts on a box on the ground beside gravity, along it and up [N]; nothing before the motion."""
        return (self.pull(step), self._normal[0] - self.normal(step)) if step >= 0 else (0.0, 0.0)


def run(simulations):
    """Write the motion of a problem by one of the simulations, which give position and velocity after every step."""
    words = sys.argv[1:]
    if len(words) < 2 or words[0] not in simulations:
        sys.exit("error: allowed: {} PROBLEM.json [OPTION …]".format(" or ".join(simulations)))
    with open(words[1], encoding="utf-8") as text:
        problem = json.load(text)
    bodies = range(len(problem["masses"]))
    motions = [list(simulations[words[0]](Block(problem, body), words[2:])) for body in bodies]
    print(",".join(["time"] + ["x%d" % body for body in bodies] + ["v%d" % body for body in bodies]))
    for step, states in enumerate(zip(*motions), 1):
        values = [step * problem["time_step"]] + [x for x, _ in states] + [v for _, v in states]
        print(",".join(repr(float(value)) for value in values))
