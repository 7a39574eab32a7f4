"""Newton's contact formulation: in every cell a sphere, the inner mass, pressed on a plane, the outer one."""

from typing import Any, ClassVar

import numpy as np

from multibody_xval.engines.newton.worlds import NewtonWorlds, import_newton, launch
from multibody_xval.engines.shared.warp_worlds import import_warp


class ContactWorlds(NewtonWorlds):
    """Chains whose inner masses slide in the outer ones along and across."""

    joints: ClassVar[int] = 3
    rows_of_a_cell: ClassVar[int] = 3
    solver_option: ClassVar[str] = "friction_anchor_beta"
    pressed: ClassVar[bool] = True

    def _add_inner(self, builder: Any, outer: int, inner: int, cell: int) -> int:
        newton, warp = import_newton(), import_warp()
        # Cells lie in each other's place: they are groups of shapes that do not meet.
        surface = newton.ModelBuilder.ShapeConfig(density=0.0, collision_group=cell + 1)
        builder.add_shape_plane(body=outer, width=0.0, length=0.0, cfg=surface)
        builder.add_shape_sphere(inner, radius=self._radius, cfg=surface)
        return builder.add_joint_d6(
            outer,
            inner,
            linear_axes=[newton.ModelBuilder.JointDofConfig(axis=axis) for axis in (newton.Axis.X, newton.Axis.Z)],
            parent_xform=warp.transform(warp.vec3(0.0, 0.0, self._radius), warp.quat_identity()),
            collision_filter_parent=False,
        )

    def _new_model(self) -> Any:
        model = super()._new_model()
        # Of a plane and its sphere, whose mean is taken.
        model.shape_material_mu.assign(np.repeat(self._numbers("friction_coefficient").ravel(), 2))
        return model

    def _allocate_forces(self) -> tuple[Any, Any]:
        newton, size = import_newton(), (len(self._chains), self._chains[0].cells)
        self._pipeline = newton.CollisionPipeline(self._model)
        self._contacts = self._pipeline.contacts()
        kind = newton.solvers.SolverBase.ObservableKind.CONTACT_F
        self._observables = self._solver.observables([kind], contacts=self._contacts)
        self._friction, self._normal_force = (import_warp().zeros(size, dtype=float) for _ in range(2))
        return self._friction, self._normal_force

    def _set_forces(self) -> None:
        super()._set_forces()
        launch("press", self._pressing.shape[1:], self._step, self._pressing, self.joints, self._forces)

    def _take_step(self) -> None:
        self._pipeline.collide(self._before, self._contacts)
        states = self._before, self._after
        self._solver.step(*states, self._control, self._contacts, self._time_step, observables=self._observables)

    def _read_forces(self) -> None:
        self._friction.zero_()
        self._normal_force.zero_()
        contacts, forces = self._contacts, self._observables.contact_f
        inputs = contacts.rigid_contact_count, contacts.rigid_contact_shape0, forces
        launch("read_contacts", len(forces), *inputs, self._friction, self._normal_force)
