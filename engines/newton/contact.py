"""Newton's contact formulation: in every cell a sphere, the inner mass, pressed on a plane, which is the outer one."""

from collections.abc import Sequence
from typing import Any, ClassVar

import numpy as np

from engines.interface.presets import NormalForce, Option, Preset
from engines.newton.law import friction_anchors
from engines.newton.worlds import NewtonWorlds, import_newton
from engines.shared.warp_worlds import import_warp
from reference_lcp.chain.mass_in_mass import Chain

CONTACT_TUNED = Preset(
    "Spheres pressed on planes, with friction in one point; springs, dashpots and load as forces at the step's start.",
    {
        "units": Option("lane", "SI", "Numbers near one, and the time step as the unit of time: worlds share it."),
        "friction_anchor_beta": Option(0.0, 0.2, "Point friction: nothing is drawn back to where it once stuck."),
    },
    shares_scheme=True,
    normal_force=NormalForce.MODULATED,
)

CONTACT_DEFAULT = Preset(
    "The same spheres and forces in SI units, a lane at a time, with SolverSteel's own anchors.",
    {
        "units": Option("SI", "SI", "The chain in SI units."),
        "friction_anchor_beta": Option(0.2, 0.2, "SolverSteel's own: a fifth of what has slipped is taken back."),
    },
    known_deviation=(
        "a contact that slips by less than 1e-5 of its sphere's radius in a step is taken to stick there, and is drawn "
        "back by a fifth of it in every step that follows"
    ),
    law=friction_anchors,
    split_tolerance=1e-4,
    normal_force=NormalForce.MODULATED,
    batch_lanes=4,
)


class ContactWorlds(NewtonWorlds):
    """Chains whose inner masses slide in the outer ones along and across, each a sphere on a plane."""

    joints: ClassVar[int] = 3
    rows_of_a_cell: ClassVar[int] = 3
    solver_options: ClassVar[tuple[str, ...]] = ("friction_anchor_beta",)

    def __init__(self, chains: Sequence[Chain], time_step: float, preset: Preset, radius: float):
        """As `NewtonWorlds`, with the radius of all spheres in their units."""
        self._radius = radius
        super().__init__(chains, time_step, preset)

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
        from engines.newton import kernels

        super()._set_forces()
        inputs = [self._step, self._pressing, self.joints, self._forces]
        import_warp().launch(kernels.press, self._pressing.shape[1:], inputs)

    def _take_step(self) -> None:
        self._pipeline.collide(self._before, self._contacts)
        states = self._before, self._after
        self._solver.step(*states, self._control, self._contacts, self._time_step, observables=self._observables)

    def _read_forces(self) -> None:
        from engines.newton import kernels

        self._friction.zero_()
        self._normal_force.zero_()
        contacts, forces = self._contacts, self._observables.contact_f
        inputs = [contacts.rigid_contact_count, contacts.rigid_contact_shape0, forces]
        import_warp().launch(kernels.read_contacts, len(forces), [*inputs, self._friction, self._normal_force])
