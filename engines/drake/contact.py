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

from multibody_xval.engines.drake.joint import Diagram, DrakeLane, add_mass, set_options
from multibody_xval.engines.drake.step_model import contact_scale, stiction_speed
from multibody_xval.engines.interface.presets import Preset
from reference_lcp.chain.simulation import Lane
from reference_lcp.chain.trajectory import State
from reference_lcp.validation import FloatArray

RADIUS = 4.0
"""Radius of a sphere over the displacement scale of the drive; it enters round-off only."""

WIDTH = 2.0**20
"""Width of a plane over that scale: no sphere slides off; motions are bitwise those on a half space."""


def stiction_tolerance(lane: Lane, preset: Preset) -> float:
    """Give the relative velocity [m/s] at which friction is near its bound."""
    if "v_stiction" in preset.options:
        return float(preset["v_stiction"])
    return stiction_speed(lane, preset["stiction"])


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
        from pydrake.multibody.plant import AddMultibodyPlantSceneGraph, ContactModel, DiscreteContactApproximation
        from pydrake.multibody.tree import default_model_instance

        plant, scene = AddMultibodyPlantSceneGraph(builder, self._time_step)
        set_options(plant, self._preset)
        plant.set_contact_model(getattr(ContactModel, self._preset["contact_model"]))
        plant.set_discrete_contact_approximation(getattr(DiscreteContactApproximation, self._preset["approximation"]))
        planes, spheres = self._add_bodies(plant)
        plant.Finalize()
        plant.set_stiction_tolerance(stiction_tolerance(self.lane, self._preset) / self._units.velocity)
        _keep_to_pairs(scene, planes, spheres)
        pressing = np.zeros(3 * self._chain.cells)
        for cell in self._rubbing:
            pressing[plant.GetJointByName(f"across {cell}").position_start()] = -self._chain.normal_force[cell]
        forces = plant.get_generalized_contact_forces_output_port(default_model_instance())
        return plant, forces if self._rubbing.size else None, pressing

    def _add_bodies(self, plant: Any) -> tuple[list[Any], list[Any]]:
        """Add all masses; give the planes of the outer and the spheres of the inner ones that rub.

        A carriage without mass slides on the outer mass, and on it the inner one, free to move across.
        """
        from pydrake.geometry import Box, Sphere
        from pydrake.multibody.tree import PrismaticJoint

        planes, spheres, upwards = [], [], [0.0, 0.0, 1.0]
        radius, width = RADIUS * self._scale, WIDTH * self._scale
        for cell, outer, carriage in self._cells(plant, np.zeros(self._chain.cells)):
            inner = add_mass(plant, f"sphere {cell}", self._chain.inner_mass[cell])
            plant.AddJoint(PrismaticJoint(f"across {cell}", carriage.body_frame(), inner.body_frame(), upwards))
            if self._chain.friction_bound[cell] > 0:
                # Of half spaces, which have no end, Drake's search for contacts takes thirteen at most.
                planes.append(self._add_shape(plant, outer, Box(width, width, radius), -radius / 2, cell))
                spheres.append(self._add_shape(plant, inner, Sphere(radius), radius, cell))
        return planes, spheres

    def _add_shape(self, plant: Any, body: Any, shape: Any, height: float, cell: int) -> Any:
        """Add a shape above a body; at a coordinate across of zero, a sphere touches its plane."""
        from pydrake.math import RigidTransform

        place, name = RigidTransform([0.0, 0.0, height]), f"{type(shape).__name__} {cell}"
        return plant.RegisterCollisionGeometry(body, place, shape, name, self._material(cell))

    def _material(self, cell: int) -> Any:
        """Make the properties of either body; Drake combines two equal coefficients to the same one."""
        from pydrake.geometry import AddContactMaterial, ProximityProperties
        from pydrake.multibody.plant import CoulombFriction

        coefficient = float(self._chain.friction_coefficient[cell])
        properties = ProximityProperties()
        AddContactMaterial(
            properties,
            # Equal springs in series are half as stiff.
            point_stiffness=2 * self._chain.normal_force[cell] / self._depth[cell],
            dissipation=self._preset["hunt_crossley_dissipation"] * self._units.velocity,
            friction=CoulombFriction(coefficient, coefficient),
        )
        if "relaxation_time" in self._preset.options:
            relaxation_time = self._preset["relaxation_time"] / self._units.time
            properties.AddProperty("material", "relaxation_time", relaxation_time)
        return properties

    @property
    def _scale(self) -> float:
        return contact_scale(self.lane) / self._units.length

    @property
    def _depth(self) -> FloatArray:
        """Depth of every sphere at rest; zero where nothing presses."""
        chain, preset = self._chain, self._preset
        if "depth" in preset.options:
            depths = np.full(chain.cells, preset["depth"] * contact_scale(self.lane) / self._units.length)
        else:
            depths = chain.normal_force / (preset["point_stiffness"] / 2)
        return np.where(chain.friction_bound > 0, depths, 0.0)

    def _across(self, state: State) -> FloatArray:
        if state.internal_state is None:
            return np.stack([-self._depth, np.zeros(self._chain.cells)])
        place, later = np.split(state.internal_state[0], 2)
        return np.stack([place / self._units.length, (later - place) / self.lane.time_step / self._units.velocity])

    def _internal_state(self, diagram: Diagram, vector: FloatArray) -> FloatArray:
        place, velocity = (half[diagram.across] for half in np.split(vector, 2))
        place, velocity = place * self._units.length, velocity * self._units.velocity
        return np.concatenate([place, place + self.lane.time_step * velocity])

    def _contact_forces(self, diagram: Diagram, rows: FloatArray) -> tuple[FloatArray, FloatArray]:
        steps = rows.shape[0]
        given = self.lane.preloads(0, steps)
        if not self._rubbing.size:
            return np.zeros((steps, self._chain.cells)), given
        forces = rows * self._units.force
        measured = forces[:, diagram.across]
        return forces[:, diagram.inner], np.where(self.lane.chain.friction_bound > 0, measured, given)


def _keep_to_pairs(scene: Any, planes: list[Any], spheres: list[Any]) -> None:
    """Let every sphere touch its own plane only: planes lie in each other, under all spheres."""
    from pydrake.geometry import CollisionFilterDeclaration, GeometrySet

    declaration = CollisionFilterDeclaration().ExcludeWithin(GeometrySet(spheres)).ExcludeWithin(GeometrySet(planes))
    for own, plane in enumerate(planes):
        declaration.ExcludeBetween(GeometrySet([plane]), GeometrySet(spheres[:own] + spheres[own + 1 :]))
    scene.collision_filter_manager().Apply(declaration)
