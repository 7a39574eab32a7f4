"""Lanes of Newton as worlds of one model, stepped by SolverSteel: joints with drives, or spheres on planes."""

import functools
import importlib
from abc import abstractmethod
from collections.abc import Sequence
from typing import Any, ClassVar, Self

import numpy as np
from numpy.typing import NDArray

from multibody_xval.engines.interface.presets import Formulation, Preset
from multibody_xval.engines.shared.box_geometry import PressedBoxes
from multibody_xval.engines.shared.units import Units
from multibody_xval.engines.shared.warp_worlds import Rows, WarpWorlds, import_warp
from multibody_xval.engines.shared.worlds_simulation import WorldsSimulation
from reference_lcp.chain.mass_in_mass import Chain
from reference_lcp.chain.simulation import Lane
from reference_lcp.validation import FloatArray

NO_GRAVITY = (0.0, 0.0, 0.0)


class NewtonWorlds(WarpWorlds):
    """Chains of one length, in units in which they have one time step, as worlds.

    Each cell's outer mass slides on the ground, and carries the inner one.
    """

    joints: ClassVar[int]
    """Coordinates of a cell."""

    rows_of_a_cell: ClassVar[int]
    """Constraints of a cell."""

    solver_options: ClassVar[tuple[str, ...]] = ()
    """Options of the preset that SolverSteel takes by their names."""

    def __init__(self, chains: Sequence[Chain], time_step: float, preset: Preset):
        self._chains, self._time_step, self._preset = chains, time_step, preset
        super().__init__(len(chains), chains[0].cells)

    @abstractmethod
    def _add_inner(self, builder: Any, outer: int, inner: int, cell: int) -> int:
        """Add what is between an outer mass and its inner one, bodies of `builder`; give the joint."""

    @abstractmethod
    def _allocate_forces(self) -> tuple[Any, Any]:
        """Put what forces are read from into memory; give friction and normal force, shape (worlds, ...) each."""

    def _allocate(self) -> Rows:
        warp, newton = import_warp(), import_newton()
        self._model = self._new_model()
        options = {name: self._preset[name] for name in self.solver_options}
        rows = self.rows_of_a_cell * self._chains[0].cells
        self._solver = newton.solvers.SolverSteel(self._model, articulation_constraint_max=rows, **options)
        self._before, self._after = self._model.state(), self._model.state()
        self._control = self._model.control()
        names = ("chain_stiffness", "chain_damping", "inner_stiffness", "inner_damping")
        self._springs = warp.array(self._numbers(*names), dtype=float)
        self._forces = self._by_world(self._control.joint_f)
        self._positions, self._velocities = map(self._by_world, (self._before.joint_q, self._before.joint_qd))
        newton.eval_fk(self._model, self._before.joint_q, self._before.joint_qd, self._before)
        return Rows(self._positions, self._velocities, *self._allocate_forces())

    def _new_model(self) -> Any:
        """Make as many copies of the first chain, and give them their own masses."""
        newton, warp = import_newton(), import_warp()
        chain, copies = newton.ModelBuilder(gravity=NO_GRAVITY), newton.ModelBuilder(gravity=NO_GRAVITY)
        inertia = warp.mat33(*np.eye(3).ravel())  # nothing turns
        for cell in range(self._chains[0].cells):
            outer, inner = (chain.add_link(mass=1.0, inertia=inertia) for _ in range(2))
            slide = chain.add_joint_prismatic(-1, outer, axis=newton.Axis.X)
            chain.add_articulation([slide, self._add_inner(chain, outer, inner, cell)])
        copies.replicate(chain, len(self._chains))
        model = copies.finalize(device=self._device)
        masses = np.swapaxes(self._numbers("outer_mass", "inner_mass"), 1, 2).ravel()
        model.body_mass.assign(masses)
        model.body_inv_mass.assign(1 / masses)
        return model

    def _numbers(self, *names: str) -> FloatArray:
        """Give parameters of the chains, shape (worlds, names, n)."""
        return np.array([[getattr(chain, name) for name in names] for chain in self._chains])

    def _by_world(self, values: Any) -> Any:
        """Give an array of Warp's with a row a world."""
        return values.reshape((len(self._chains), -1))

    def _set(self, positions: FloatArray, velocities: FloatArray) -> None:
        self._positions.assign(positions)
        self._velocities.assign(velocities)
        self._solver.reset(self._before)
        import_newton().eval_fk(self._model, self._before.joint_q, self._before.joint_qd, self._before)

    def _set_forces(self) -> None:
        from multibody_xval.engines.newton import kernels

        inputs = [self._step, self._loads, self._springs, self.joints, self._positions, self._velocities, self._forces]
        import_warp().launch(kernels.set_forces, self._pressing.shape[1:], inputs)

    def _advance(self) -> None:
        self._take_step()
        for name in ("joint_q", "joint_qd", "body_q", "body_qd"):
            import_warp().copy(getattr(self._before, name), getattr(self._after, name))

    def _take_step(self) -> None:
        """Launch the step from one state to the other."""
        self._solver.step(self._before, self._after, self._control, None, self._time_step)


@functools.cache
def import_newton() -> Any:
    """Import Newton, once Warp is silent."""
    import_warp()
    return importlib.import_module("newton")


class JointWorlds(NewtonWorlds):
    """Chains whose inner masses slide in the outer ones, each with a drive."""

    joints: ClassVar[int] = 2
    rows_of_a_cell: ClassVar[int] = 1
    solver_options: ClassVar[tuple[str, ...]] = ("drive_mode",)

    def _add_inner(self, builder: Any, outer: int, inner: int, cell: int) -> int:
        newton = import_newton()
        return builder.add_joint_prismatic(
            outer,
            inner,
            axis=newton.Axis.X,
            target_kd=self._preset["target_kd"],
            actuator_mode=newton.JointTargetMode.VELOCITY,
        )

    def _allocate_forces(self) -> tuple[Any, Any]:
        zeros, size = import_warp().zeros, len(self._chains)
        self._effort_limits = self._by_world(self._model.joint_effort_limit)
        # Rows and impulses of drives are nowhere else: they are those of the version that the adapter takes.
        self._rows = self._by_world(self._solver._drive_slot)
        self._friction = zeros((size, self._chains[0].cells), dtype=float)
        return self._friction, zeros((size, 0), dtype=float)

    def _set_forces(self) -> None:
        from multibody_xval.engines.newton import kernels

        super()._set_forces()
        bounds = self._pressing
        inputs = [self._step, bounds, self.joints, self._effort_limits]
        import_warp().launch(kernels.set_effort_limits, bounds.shape[1:], inputs)

    def _read_forces(self) -> None:
        from multibody_xval.engines.newton import kernels

        inputs = [self._rows, self._solver._impulses, self.joints, 1 / self._time_step, self._friction]
        import_warp().launch(kernels.read_drives, self._friction.shape, inputs)


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
        from multibody_xval.engines.newton import kernels

        super()._set_forces()
        inputs = [self._step, self._pressing, self.joints, self._forces]
        import_warp().launch(kernels.press, self._pressing.shape[1:], inputs)

    def _take_step(self) -> None:
        self._pipeline.collide(self._before, self._contacts)
        states = self._before, self._after
        self._solver.step(*states, self._control, self._contacts, self._time_step, observables=self._observables)

    def _read_forces(self) -> None:
        from multibody_xval.engines.newton import kernels

        self._friction.zero_()
        self._normal_force.zero_()
        contacts, forces = self._contacts, self._observables.contact_f
        inputs = [contacts.rigid_contact_count, contacts.rigid_contact_shape0, forces]
        import_warp().launch(kernels.read_contacts, len(forces), [*inputs, self._friction, self._normal_force])


class NewtonSimulation(WorldsSimulation):
    """Lanes as the worlds of one model; in their units, all have the same time step."""

    def __init__(self, lanes: Sequence[Lane], formulation: Formulation, preset: Preset):
        units = [Units.in_steps(preset["units"], lane) for lane in lanes]
        self._formulation, self._preset = formulation, preset
        chains = [own.scaled(lane.chain) for lane, own in zip(lanes, units, strict=True)]
        time_step = lanes[0].time_step / units[0].time
        worlds: NewtonWorlds
        if formulation is Formulation.JOINT:
            worlds = JointWorlds(chains, time_step, preset)
        else:
            worlds = ContactWorlds(chains, time_step, preset, PressedBoxes.of(lanes[0], units[0]).box)
        super().__init__(lanes, units, worlds.joints, worlds)

    def subset(self, lanes: Sequence[int] | NDArray[np.intp]) -> Self:
        """Give the lanes of these indices."""
        return type(self)([self.lanes[lane] for lane in lanes], self._formulation, self._preset)

    def _pressing(self, start: int, steps: int) -> FloatArray:
        """Give what bounds friction: in joints μ λ_N, in contacts λ_N itself."""
        if self._formulation is Formulation.JOINT:
            return super()._pressing(start, steps)
        return self._preloads(start, steps)

    def _contact_forces(
        self, index: int, friction: FloatArray, normal_force: FloatArray, given: FloatArray
    ) -> tuple[FloatArray, FloatArray]:
        """Give forces as the solver found them; a drive without a bound to speak of has no friction."""
        rubs, force = self.lanes[index].chain.friction_bound > 0, self._units[index].force
        return np.where(rubs, friction * force, 0.0), normal_force * force if normal_force.shape[-1] else given
