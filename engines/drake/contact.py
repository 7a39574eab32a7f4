"""Drake's contact formulation: in every cell a sphere, the inner mass, pressed on a plane, the outer one.

Contacts are compliant. A sphere is free to move across its plane, λ_N presses both together, and at rest the sphere
is so deep in the plane that the contact carries λ_N. Where friction acts back on the normal force, a sphere leaves
this depth: its place across the plane, and the place a step later at the velocity that it has, are the internal state.
Two places are as large as the depth; the velocity itself is zero but for round-off where nothing moves across, and
would have no size by which a change of it could be judged.
"""

from collections.abc import Mapping
from typing import Any

import numpy as np

from multibody_xval.engines.drake.joint import DrakeLane, add_mass, weightless
from multibody_xval.engines.interface.presets import Preset
from multibody_xval.engines.shared.units import power_of_two
from reference_lcp.chain.simulation import Lane
from reference_lcp.chain.trajectory import State
from reference_lcp.validation import FloatArray

RADIUS = 4.0
"""Radius of a sphere over the displacement scale of the drive; it enters round-off only."""

WIDTH = 2.0**20
"""Width of a plane over that scale: no sphere slides off; motions are bitwise those on a half space."""


def contact_scale(lane: Lane) -> float:
    """Give the power of two near the displacement scale [m]: depths are then exact."""
    return power_of_two(lane.drive.displacement_scale(lane.chain))


def stiction_tolerance(lane: Lane, preset: Preset) -> float:
    """Give the relative velocity [m/s] at which friction is near its bound."""
    if "v_stiction" in preset.options:
        return float(preset["v_stiction"])
    return float(preset["stiction"]) * lane.drive.displacement_scale(lane.chain) * lane.chain.resonator_frequency


def script_numbers(lane: Lane, preset: Preset, _start: State) -> Mapping[str, Any]:
    """Give what a script prints beside options: the stiffness of the spheres [N/m], and the stiction velocity [m/s]."""
    chain = lane.chain
    if "point_stiffness" in preset.options:
        stiffness = np.full(chain.cells, preset["point_stiffness"])
    else:
        stiffness = 2 * chain.normal_force / (preset["depth"] * contact_scale(lane))  # of two equal springs in series
    return {"stiffness": stiffness, "stiction": stiction_tolerance(lane, preset)}


class DrakeContactLane(DrakeLane):
    """Friction of compliant contacts, regularised within a tolerance of velocity."""

    def _build(self, builder: Any) -> tuple[Any, Any, FloatArray]:
        from pydrake import all as drake

        preset = self._preset
        plant, scene = drake.AddMultibodyPlantSceneGraph(builder, self._time_step)
        weightless(plant)
        plant.set_contact_model(getattr(drake.ContactModel, preset["contact_model"]))
        plant.set_discrete_contact_approximation(getattr(drake.DiscreteContactApproximation, preset["approximation"]))
        planes, spheres = self._add_bodies(plant)
        plant.Finalize()
        plant.set_stiction_tolerance(stiction_tolerance(self.lane, preset) / self._units.velocity)
        _keep_to_pairs(scene, planes, spheres)
        pressing = np.zeros(3 * self._chain.cells)
        for cell in self._rubbing:
            pressing[plant.GetJointByName(f"across {cell}").position_start()] = -self._chain.normal_force[cell]
        forces = plant.get_generalized_contact_forces_output_port(drake.default_model_instance())
        return plant, forces if self._rubbing.size else None, pressing

    def _add_bodies(self, plant: Any) -> tuple[list[Any], list[Any]]:
        """Add all masses; give the planes of the outer and the spheres of the inner ones that rub.

        A carriage without mass slides on the outer mass, and on it the inner one, free to move across.
        """
        from pydrake import all as drake

        planes, spheres, upwards = [], [], [0.0, 0.0, 1.0]
        scale = contact_scale(self.lane) / self._units.length
        radius, width = RADIUS * scale, WIDTH * scale
        for cell, outer, carriage in self._cells(plant, np.zeros(self._chain.cells)):
            inner = add_mass(plant, f"sphere {cell}", self._chain.inner_mass[cell])
            plant.AddJoint(drake.PrismaticJoint(f"across {cell}", carriage.body_frame(), inner.body_frame(), upwards))
            if self._chain.friction_bound[cell] > 0:
                # Of half spaces, which have no end, Drake's search for contacts takes thirteen at most.
                planes.append(self._add_shape(plant, outer, drake.Box(width, width, radius), -radius / 2, cell))
                spheres.append(self._add_shape(plant, inner, drake.Sphere(radius), radius, cell))
        return planes, spheres

    def _add_shape(self, plant: Any, body: Any, shape: Any, height: float, cell: int) -> Any:
        """Add a shape above a body; at a coordinate across of zero, a sphere touches its plane."""
        from pydrake import all as drake

        coefficient, properties = float(self._chain.friction_coefficient[cell]), drake.ProximityProperties()
        drake.AddContactMaterial(
            properties,
            # Equal springs in series are half as stiff; two equal coefficients are combined to the same one.
            point_stiffness=2 * self._chain.normal_force[cell] / self._depth[cell],
            dissipation=self._preset["hunt_crossley_dissipation"] * self._units.velocity,
            friction=drake.CoulombFriction(coefficient, coefficient),
        )
        if "relaxation_time" in self._preset.options:
            properties.AddProperty("material", "relaxation_time", self._preset["relaxation_time"] / self._units.time)
        place, name = drake.RigidTransform([0.0, 0.0, height]), f"{type(shape).__name__} {cell}"
        return plant.RegisterCollisionGeometry(body, place, shape, name, properties)

    @property
    def _depth(self) -> FloatArray:
        """Depth of every sphere at rest; zero where nothing presses."""
        chain, preset = self._chain, self._preset
        if "depth" in preset.options:
            depths = np.full(chain.cells, preset["depth"] * contact_scale(self.lane) / self._units.length)
        else:
            depths = chain.normal_force / (preset["point_stiffness"] / 2)
        return np.where(chain.friction_bound > 0, depths, 0.0)

    def _coordinates_across(self, state: State) -> FloatArray:
        if state.internal_state is None:
            return np.stack([-self._depth, np.zeros(self._chain.cells)])
        place, later = np.split(state.internal_state[0], 2)
        return np.stack([place / self._units.length, (later - place) / self.lane.time_step / self._units.velocity])

    def _internal_state(self, position: FloatArray, velocity: FloatArray) -> FloatArray:
        place, speed = position[self._across] * self._units.length, velocity[self._across] * self._units.velocity
        return np.concatenate([place, place + self.lane.time_step * speed])

    def _contact_forces(self, rows: FloatArray, pressing: FloatArray) -> tuple[FloatArray, FloatArray]:
        normal_force = np.where(self.lane.chain.friction_bound > 0, rows[:, self._across], pressing)
        return rows[:, self._inner], normal_force


def _keep_to_pairs(scene: Any, planes: list[Any], spheres: list[Any]) -> None:
    """Let every sphere touch its own plane only: planes lie in each other, under all spheres."""
    from pydrake.geometry import CollisionFilterDeclaration, GeometrySet

    declaration = CollisionFilterDeclaration().ExcludeWithin(GeometrySet(spheres)).ExcludeWithin(GeometrySet(planes))
    for own, plane in enumerate(planes):
        declaration.ExcludeBetween(GeometrySet([plane]), GeometrySet(spheres[:own] + spheres[own + 1 :]))
    scene.collision_filter_manager().Apply(declaration)
