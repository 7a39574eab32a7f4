"""Scenes in an engine that is Coulomb's law of one mass in semi-implicit Euler steps, and wrong by little."""

import math
from dataclasses import dataclass

import numpy as np
import pandas as pd

from multibody_xval.engines.interface.scene import (
    GRAVITY,
    ArmScene,
    ContactScene,
    JointScene,
    SteppedWorld,
    turned_about,
)
from multibody_xval.scenarios.cases.scene_motion import SceneMotion
from multibody_xval.scenarios.catalogue.numbers import numbers
from multibody_xval.scenarios.catalogue.scenario import Scenario
from multibody_xval.scenarios.catalogue.scenes.spinning_box import CORNERS, braking
from multibody_xval.scenarios.compute.scenes import followed
from multibody_xval.scenarios.model import Config
from multibody_xval.scenarios.store import Stored

CONTACT, JOINT = Config("mujoco", "contact", "default"), Config("mujoco", "joint", "default")
"""Under whose names scenes are judged: no accuracy is stated of these."""


@dataclass(frozen=True)
class Wrong:
    """What a copy of Coulomb's law does otherwise."""

    friction: float = 1.0
    damping: float = 1.0
    drift: float = 0.0
    """[m/s]."""
    fall: float = 0.0
    """At once [m]."""
    aside: float = 0.0
    """Part of friction that acts across the slip, beside the whole against it."""


class PointMass:
    """Coulomb's law of one mass along and across its plane, in steps of semi-implicit Euler."""

    def __init__(self, case: SceneMotion, step_size: float, wrong: Wrong):
        scene, self.step_size, self.drift, self.aside = case.scene, step_size, wrong.drift, wrong.aside
        self.axes, self.load, self.bound = np.eye(3), np.zeros(3), math.inf
        self.start, self.belt, self.forward = np.zeros(3), np.zeros(3), np.zeros(3)
        if isinstance(scene, ContactScene):
            self.axes = np.array([scene.downhill, (0.0, 1.0, 0.0), scene.normal])
            self.start, self.belt = np.array(scene.places[-1]), np.array([scene.belt, 0.0, 0.0])
            self.forward = self.axes @ scene.forward
            if not scene.grip:
                self.load = np.array([GRAVITY * math.sin(scene.slope), 0.0, 0.0])
                self.bound = wrong.friction * scene.friction * GRAVITY * math.cos(scene.slope)
        self.mass, self.pushed = scene.boxes[-1].mass if isinstance(scene, ContactScene) else 1.0, 0.0
        self.shaker = scene.shaker if isinstance(scene, ContactScene) else None
        self.inside, self.carried = np.zeros(2), self.shaker.mass if self.shaker else 0.0
        self.bound *= 1 + self.carried / self.mass
        self.links = scene.links if isinstance(scene, ArmScene) else 1
        self.box = isinstance(scene, ContactScene)
        self.way, self.velocity, self.damping = np.full(3, wrong.fall), np.zeros(3), 0.0
        if isinstance(scene, JointScene) and scene.velocity:  # others are held
            self.velocity = np.array([scene.velocity, 0.0, 0.0])
            self.bound, self.damping = wrong.friction * scene.friction, wrong.damping * scene.damping
        self.angle = self.spin = 0.0
        self.braking = wrong.friction * braking(scene, CORNERS) if self.box else 0.0

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
        free = self.velocity - self.belt + self.step_size * (self.load + self.pushed * self.forward)
        speed = math.sqrt(free @ free)
        part = self.step_size * self.bound / speed if speed else 1.0
        across = np.cross([0.0, 0.0, 1.0], free) * self.aside * part if part < 1 else np.zeros(3)
        self.velocity = self.belt + free * max(0.0, 1 - part) + across
        self.velocity = self.velocity / (1 + self.step_size * self.damping)
        self.way = self.way + self.step_size * (self.velocity + self.drift)
        self.spin = max(0.0, self.spin - self.step_size * self.braking)
        self.angle += self.step_size * self.spin

    def state(self):
        if not self.box:
            return ([self.way[0]] * self.links,)
        return self.start + self.way @ self.axes, turned_about(2, self.angle), self.velocity @ self.axes


def point_mass_numbers(scenario: Scenario, wrong: Wrong = Wrong()) -> pd.DataFrame:
    """Judge scenes that point masses play, under the name of an engine."""
    case = next(iter(scenario.cases.values()))
    config = JOINT if case.formulation == "joint" else CONTACT
    stored = []
    for run in scenario.own_runs(config).values():
        one = PointMass(run.of(SceneMotion), run.of(SceneMotion).time / run.steps, wrong)
        world = SteppedWorld(one.step, one.state, one.launch, push=one.push)
        stored.append(Stored(run, "1", followed(run.of(SceneMotion), run.steps, world)))
    return numbers(scenario, stored)
