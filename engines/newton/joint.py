"""Newton's joint formulation: in every cell a velocity drive of bounded effort that holds the slip velocity at zero."""

from typing import Any, ClassVar

from engines.interface.presets import NormalForce, Option, Preset
from engines.newton.worlds import NewtonWorlds, import_newton
from engines.shared.warp_worlds import import_warp

DRIVE_OPTIONS = {
    "drive_mode": Option(
        "rows",
        "augmented",
        "The default adds all damping to the mass matrix and bounds only the rest: the joint locks, without friction.",
    ),
    "target_kd": Option(1e20, 0.0, "Damping of the drive: a smaller one lets stuck contacts creep."),
}
"""What makes a drive a friction; SolverSteel has joint friction of its own on CUDA devices only."""

JOINT_TUNED = Preset(
    "Drives of bounded effort as rows of the solver; springs, dashpots and load as forces at the start of the step.",
    {
        "units": Option("lane", "SI", "Numbers near one, and the time step as the unit of time: worlds share it."),
        **DRIVE_OPTIONS,
    },
    shares_scheme=True,
    normal_force=NormalForce.MODULATED,
)

JOINT_DEFAULT = Preset(
    "The same drives and forces in SI units, a lane at a time; without the rows there is no friction to compare.",
    {"units": Option("SI", "SI", "The chain in SI units."), **DRIVE_OPTIONS},
    shares_scheme=True,
    normal_force=NormalForce.MODULATED,
    batch_lanes=4,
)


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
        from engines.newton import kernels

        super()._set_forces()
        bounds = self._pressing
        inputs = [self._step, bounds, self.joints, self._effort_limits]
        import_warp().launch(kernels.set_effort_limits, bounds.shape[1:], inputs)

    def _read_forces(self) -> None:
        from engines.newton import kernels

        inputs = [self._rows, self._solver._impulses, self.joints, 1 / self._time_step, self._friction]
        import_warp().launch(kernels.read_drives, self._friction.shape, inputs)
