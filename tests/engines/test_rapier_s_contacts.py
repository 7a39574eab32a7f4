"""What Rapier's recipe leaves of a box that is pushed at an angle to its own sides, in plain Rapier."""

import math

import numpy as np
import pytest

pytestmark = pytest.mark.needs("rapier")

SIZE, MASS, FRICTION, GRAVITY, STEP, STEPS = (0.16, 0.12, 0.08), 2.3, 0.6, 9.81, 1 / 60, 15
"""[m], [kg], 1, [m/s²], [s], and steps of the push: Rapier's own in a quarter of a second."""


def pushed(degrees: float) -> complex:
    """Push a box with 1.2 μ m g; gives the way along and aside over the exact one in steps."""
    import rapier3d

    world, vector, angle = rapier3d.PhysicsWorld(), rapier3d.Vec3, math.radians(degrees)
    world.integration_parameters.dt = STEP
    world.integration_parameters.num_internal_pgs_iterations = 4
    world.gravity = vector(0, 0, -GRAVITY)
    ground = rapier3d.Collider.cuboid(5.0, 5.0, 1.0).friction(FRICTION).restitution(0.0)
    world.add_body(rapier3d.RigidBody.fixed().translation(vector(0, 0, -1)), [ground])
    cube = rapier3d.Collider.cuboid(*(side / 2 for side in SIZE)).friction(FRICTION).restitution(0.0)
    free = rapier3d.RigidBody.dynamic().translation(vector(0, 0, SIZE[2] / 2)).can_sleep(False)
    box = world.rigid_bodies[world.add_body(free, [cube.density(MASS / float(np.prod(SIZE)))])]
    for _ in range(60):
        world.step()
    begin, force = box.translation, 1.2 * FRICTION * MASS * GRAVITY
    begin = complex(begin.x, begin.y)
    for _ in range(STEPS):
        box.reset_forces(True)
        box.add_force(vector(force * math.cos(angle), force * math.sin(angle), 0.0), True)
        world.step()
    exact = 0.2 * FRICTION * GRAVITY * STEP**2 * STEPS * (STEPS + 1) / 2
    end = complex(box.translation.x, box.translation.y)
    return (end - begin) / complex(math.cos(angle), math.sin(angle)) / exact


def test_box_that_is_pushed_at_an_angle_to_its_own_sides_goes_aside() -> None:
    """By a thirteenth of its way; along its sides it goes straight."""
    assert abs(pushed(0).imag) < 1e-4
    assert pushed(45).imag == pytest.approx(0.077, abs=0.005)
    assert pushed(45).real == pytest.approx(1, abs=0.02)
