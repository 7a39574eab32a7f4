"""Models whose solver has few iterations: the recipe sets them, and three boxes on a slope of 12° hold."""

import math

import pytest

from multibody_xval.reports.reproducers.recipe import recipe_text
from multibody_xval.scenarios.catalogue.scenes.held_boxes import STACK_HOLD
from multibody_xval.scenarios.compute.batch import run_batch
from multibody_xval.scenarios.model import Config

SIDE, MASS, FRICTION, SLOPE, GRAVITY = 0.2, 1.0, 0.5, math.radians(12), 9.81
"""[m], [kg], 1, [rad], [m/s²]."""

SECOND = 240
"""Steps of PyBullet."""


def bullet_drift(*, iterations: int, recipe: bool) -> float:
    """Give the largest drift of three boxes over two seconds [m/s]."""
    import pybullet as bullet
    from pybullet_utils.bullet_client import BulletClient

    client = BulletClient(bullet.DIRECT)
    client.setGravity(GRAVITY * math.sin(SLOPE), 0, -GRAVITY * math.cos(SLOPE))
    client.setPhysicsEngineParameter(numSolverIterations=iterations)
    ground = client.createCollisionShape(client.GEOM_BOX, halfExtents=[5, 5, 1])
    cube = client.createCollisionShape(client.GEOM_BOX, halfExtents=[SIDE / 2] * 3)
    boxes = [client.createMultiBody(MASS, cube, basePosition=[0, 0, (n + 0.5) * SIDE]) for n in range(3)]
    for body in (client.createMultiBody(0, ground, basePosition=[0, 0, -1]), *boxes):
        client.changeDynamics(body, -1, lateralFriction=FRICTION**0.5)
        if recipe:
            client.changeDynamics(body, -1, linearDamping=0, angularDamping=0)
            client.changeDynamics(body, -1, frictionAnchor=1)
    if recipe:
        client.setPhysicsEngineParameter(solverResidualThreshold=0)
    places = []
    for steps in (SECOND, 2 * SECOND):
        for _ in range(steps):
            client.stepSimulation()
        places.append([client.getBasePositionAndOrientation(box)[0] for box in boxes])
    client.disconnect()
    return max(math.dist(begin[:2], end[:2]) for begin, end in zip(*places, strict=True)) / 2


@pytest.mark.needs("pybullet")
def test_pybullet_s_boxes_drift_with_two_iterations_and_hold_with_those_of_the_recipe() -> None:
    assert "numSolverIterations=50" in recipe_text("pybullet")
    assert bullet_drift(iterations=2, recipe=False) == pytest.approx(13e-3, rel=0.05)
    assert bullet_drift(iterations=2, recipe=True) == pytest.approx(37e-6, rel=0.05)
    assert bullet_drift(iterations=50, recipe=True) < 0.01e-6


def drift(name: str, **options: int) -> float:
    """Give the drift of three boxes with the recipe of an engine, but for its iterations [µm/s]."""
    config = Config(name, "contact", "recommended")
    for option, value in options.items():
        config = config.changed(option, value)
    run = STACK_HOLD.own_runs(config)["3 boxes, 12°, own step"]
    return STACK_HOLD.quantities[0].read(run_batch([run])[0], run)


@pytest.mark.parametrize(
    ("name", "option", "few"),
    [
        pytest.param("sapien", "solver_position_iterations", 2, marks=pytest.mark.needs("sapien")),
        pytest.param("rapier", "num_solver_iterations", 1, marks=pytest.mark.needs("rapier")),
    ],
)
def test_recipe_names_the_iterations_without_which_it_does_not_hold(name, option, few) -> None:
    own = Config(name, "contact", "recommended").preset[option]
    assert f"{option}={own}" in recipe_text(name).replace(" = ", "=")
    assert drift(name) < 1
    assert drift(name, **{option: few}) > 100
