"""A box that a force keeps at a speed: the force follows the friction, and makes up for the speed that is missing.

A box that slides steadily is then pushed with its friction, whatever law that follows, and its state is never set.
"""

import numpy as np

from multibody_xval.engines.interface.scene import GRAVITY, ContactScene, Scene, SceneWorld
from reference_lcp.validation import FloatArray

PHASES = ((1.0, 0.1), (0.1, 0.3))
"""By halves of the motion: the part of its difference from the friction in the last step that the force takes over, all
at first, and in the half that is read so little that a box that rattles is pushed with its mean friction; and the
part of the speed that is missing for which it makes up."""

BEGINS = 1.5
"""Force at first, over μ m g: more than a pyramid's √2, for a force that is too small grows by little in a step."""


def driven(
    scene: Scene, speed: float, step: float, world: SceneWorld, steps: int
) -> tuple[FloatArray, tuple[float, float, float]]:
    """Push a box on the flat along its own x axis so that it keeps a speed [m/s], and give its motion.

    And means of the second half: friction against the force over μ m g, and the speeds along it and across it over the
    one that is kept.
    """
    assert isinstance(scene, ContactScene), "a box is driven"
    mass, forward = scene.boxes[-1].mass, np.array(scene.forward)
    bound, axes = scene.friction * mass * GRAVITY, np.array([forward, np.cross((0.0, 0.0, 1.0), forward)])
    world.launch((speed * scene.forward[0], speed * scene.forward[1], 0.0), 0.0)
    rows, friction, before, push, half = [], [], speed, BEGINS * bound, steps // 2
    for number in range(steps):
        world.push(push)
        rows.append(world.run(1)[-1])
        now = float(forward @ rows[-1][7:10])
        friction.append(push - mass * (now - before) / step)
        follows, makes_up = PHASES[number >= half]
        push += follows * (friction[-1] - push + makes_up * mass * (speed - now) / step)
        before = now
    every = np.array(rows)
    along, aside = (np.mean(every[half:, 7:10], axis=0) @ axes.T / speed).tolist()
    return every, (float(np.mean(friction[half:])) / bound, along, aside)
