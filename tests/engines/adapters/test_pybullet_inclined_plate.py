"""Why Bullet's contacts are not inclined: a plate that nothing guides gives way across the row."""

import math

import pytest

pybullet = pytest.importorskip("pybullet")

INCLINATION = math.radians(12)
PRESSING, PULL = 20.0, 1.0
"""Forces [N] along the normal and along the row, of the box and against the plate; both weigh 1 kg."""

STEP, SETTLING, MEASURED = 1e-3, 100, 100


def slip_acceleration() -> float:
    """Let a box slide on a free plate, both inclined, without friction; the acceleration of v − u [m/s²]."""
    client = pybullet.connect(pybullet.DIRECT)
    try:
        pybullet.setTimeStep(STEP, physicsClientId=client)
        pybullet.setPhysicsEngineParameter(contactSlop=0.0, solverResidualThreshold=0, physicsClientId=client)
        normal = (-math.sin(INCLINATION), 0.0, math.cos(INCLINATION))
        bodies = {-1: _body(client, [50, 1, 1], [-x for x in normal]), 1: _body(client, [1, 1, 1], list(normal))}
        speeds = []
        for step in range(SETTLING + MEASURED + 1):
            if step >= SETTLING:
                speeds.append(_speed(client, bodies[1]) - _speed(client, bodies[-1]))
            for sign, body in bodies.items():
                place, _ = pybullet.getBasePositionAndOrientation(body, physicsClientId=client)
                force = [sign * (PULL - PRESSING * normal[0]), 0.0, -sign * PRESSING * normal[2]]
                pybullet.applyExternalForce(body, -1, force, place, pybullet.WORLD_FRAME, physicsClientId=client)
            pybullet.stepSimulation(physicsClientId=client)
        return (speeds[-1] - speeds[0]) / (MEASURED * STEP)
    finally:
        pybullet.disconnect(client)


def _body(client: int, sizes: list[float], place: list[float]) -> int:
    turned = pybullet.getQuaternionFromEuler([0.0, -INCLINATION, 0.0])
    shape = pybullet.createCollisionShape(pybullet.GEOM_BOX, halfExtents=sizes, physicsClientId=client)
    body = pybullet.createMultiBody(1, shape, -1, place, turned, useMaximalCoordinates=1, physicsClientId=client)
    for properties in (
        {"lateralFriction": 0.0},
        {"linearDamping": 0.0, "angularDamping": 0.0},
        {"mass": 1.0, "localInertiaDiagonal": [1e6] * 3},
    ):
        pybullet.changeDynamics(body, -1, **properties, physicsClientId=client)
    return body


def _speed(client: int, body: int) -> float:
    return pybullet.getBaseVelocity(body, physicsClientId=client)[0][0]


def test_plate_that_flies_free_lets_the_box_slip_faster_than_a_guided_one() -> None:
    """The slip has the inertia m/2 (1 + tan² α), and m/2 + m tan² α on a plate that is guided along the row."""
    measured, tangent = slip_acceleration(), math.tan(INCLINATION) ** 2
    assert measured == pytest.approx(PULL / (0.5 * (1 + tangent)), rel=1e-4)
    assert measured / (PULL / (0.5 + tangent)) == pytest.approx(1.043, abs=1e-3)
