"""An engine of thirty lines: the symplectic Euler scheme, with friction as impulses.

python example.py problems/*.json
"""

import sys

import numpy as np
from runner import run


def simulate(problem):
    """Yield time, positions and velocities after every step."""
    p = {name: np.array(value) for name, value in problem.items() if isinstance(value, (list, float))}
    h, omega, n = problem["time_step"], problem["angular_frequency"], len(problem["masses"])
    s1, s2, c1, c2, pulled = (
        np.array(problem[name], int) % (n + 1)  # the base is body n
        for name in ("spring_first", "spring_second", "contact_first", "contact_second", "force_body")
    )
    x, v = np.append(p["start_position"], 0.0), np.append(p["start_velocity"], 0.0)
    w = np.append(1 / p["masses"], 0.0)
    slip = v[c1] - v[c2]
    for step in range(round(problem["times"][-1] / h)):
        phase, force = omega * step * h, np.zeros(n + 1)
        x[n], v[n] = problem["base_amplitude"] * np.array([np.sin(phase), omega * np.cos(phase)])
        pull = p["spring_stiffness"] * (x[s1] - x[s2]) + p["spring_damping"] * (v[s1] - v[s2])
        np.add.at(force, s1, -pull)
        np.add.at(force, s2, pull)
        np.add.at(force, pulled, p["force_mean"] + np.sin(phase) * p["force_amplitude"])
        v[n] = 0.0  # contacts with the base are those with the ground: it stands still in these problems
        v += h * force * w
        normal = h * (p["contact_normal_force"] + np.sin(phase) * p["contact_normal_amplitude"])
        wanted = -(v[c1] - v[c2]) / (w[c1] + w[c2])  # would stop each contact
        held = np.abs(wanted) <= np.where(slip == 0, p["contact_static"], p["contact_kinetic"]) * normal
        impulse = np.where(held, wanted, np.sign(wanted) * p["contact_kinetic"] * normal)
        np.add.at(v, c1, w[c1] * impulse)
        np.add.at(v, c2, -w[c2] * impulse)
        slip = np.where(held, 0.0, v[c1] - v[c2])
        x += h * v
        yield (step + 1) * h, x[:n], v[:n]


if __name__ == "__main__":
    sys.exit(run(simulate))
