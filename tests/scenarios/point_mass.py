"""Engines of scenes that are Coulomb's law of one mass in semi-implicit Euler steps, and wrong by little."""

import math

import numpy as np

from multibody_xval.engines.interface.scene import GRAVITY, ArmScene, ContactScene, SteppedWorld, turned_about
from multibody_xval.engines.interface.variant import Variant
from multibody_xval.scenarios.catalogue.scenes.base import SceneScenario
from multibody_xval.scenarios.catalogue.scenes.spin import CORNERS, braking
from multibody_xval.scenarios.runs.evaluator import Evaluator
from multibody_xval.scenarios.runs.executor import InProcessExecutor
from multibody_xval.scenarios.runs.scene import SceneTask, followed
from multibody_xval.scenarios.runs.store import opened_store
from multibody_xval.scenarios.verdicts.finding import Finding

CONTACT, JOINT = Variant("mujoco", "contact", "default"), Variant("mujoco", "joint", "default")
"""Variants with scenes, under whose names they are judged."""


class PointMass:
    """The truth in semi-implicit Euler steps: Coulomb's law of one mass along and across its plane."""

    def __init__(
        self, task: SceneTask, *, friction: float = 1.0, normal: float = 1.0, creep: float = 0.0, fall: float = 0.0
    ):
        scene, self.step_size, self.creep = task.scene, task.time_step, creep
        self.axes, self.load, self.bound = np.eye(3), np.zeros(3), math.inf
        self.start, self.belt = np.zeros(3), np.zeros(3)
        if isinstance(scene, ContactScene):
            self.axes = np.array([scene.downhill, (0.0, 1.0, 0.0), scene.normal])
            self.start, self.belt = np.array(scene.places[-1]), np.array([scene.belt, 0.0, 0.0])
            if not scene.grip:
                self.load = np.array([GRAVITY * math.sin(scene.slope), 0.0, 0.0])
                self.bound = friction * normal * scene.friction * GRAVITY * math.cos(scene.slope)
        self.mass, self.pushed = scene.boxes[-1].mass if isinstance(scene, ContactScene) else 1.0, 0.0
        self.shaker = scene.shaker if isinstance(scene, ContactScene) else None
        self.inside, self.carried = np.zeros(2), self.shaker.mass if self.shaker else 0.0
        self.bound *= 1 + self.carried / self.mass
        self.links = scene.links if isinstance(scene, ArmScene) else 1
        self.box = isinstance(scene, ContactScene)
        self.way, self.velocity = np.full(3, fall), np.zeros(3)
        self.angle = self.spin = 0.0
        self.braking = friction * normal * braking(scene, CORNERS) if self.box else 0.0

    def launch(self, velocity, spin) -> None:
        self.velocity, self.spin = self.axes @ velocity, spin

    def push(self, force) -> None:
        """Push the mass or its shaker, whose way from its place and rate are those while the mass is at rest."""
        self.pushed = force / self.mass
        if self.shaker:
            spring = self.shaker.stiffness * self.inside[0] + self.shaker.damping * self.inside[1]
            self.inside[1] += self.step_size * ((force - spring) / self.shaker.mass + self.load[0])
            self.inside[0] += self.step_size * self.inside[1]
            self.pushed = (spring - force) / self.mass

    def step(self) -> None:
        free = self.velocity - self.belt + self.step_size * (self.load + np.array([self.pushed, 0.0, 0.0]))
        speed = math.sqrt(free @ free)
        self.velocity = self.belt + free * max(0.0, 1 - self.step_size * self.bound / speed if speed else 0.0)
        self.way = self.way + self.step_size * (self.velocity + self.creep)
        self.spin = max(0.0, self.spin - self.step_size * self.braking)
        self.angle += self.step_size * self.spin

    def state(self):
        if not self.box:
            return ([self.way[0]] * self.links,)
        return self.start + self.way @ self.axes, turned_about(2, self.angle), self.velocity @ self.axes


def judged(scenario: SceneScenario, **wrong: float) -> list[Finding]:
    """Judge an engine whose worlds are point masses, wrong by factors, or creeping [m/s]."""

    class Twin(Evaluator):
        def evaluate(self, tasks):
            worlds = [(task, PointMass(task, **wrong)) for task in tasks]
            return [
                followed(task, SteppedWorld(one.step, one.state, one.launch, push=one.push)) for task, one in worlds
            ]

    with opened_store(None) as store, Twin(store, InProcessExecutor()) as twin:
        return scenario.run([JOINT if scenario.formulation == "joint" else CONTACT], twin)
