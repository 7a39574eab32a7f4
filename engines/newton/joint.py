"""Newton's joint formulation: inner masses slide in the outer ones, each with a drive of bounded effort."""

from typing import Any, ClassVar

from multibody_xval.engines.newton.worlds import NewtonWorlds, import_newton, launch
from multibody_xval.engines.shared.warp_worlds import import_warp


class JointWorlds(NewtonWorlds):
    """Chains whose drives hold slip velocities at zero, with at most the bound of friction."""

    joints: ClassVar[int] = 2
    rows_of_a_cell: ClassVar[int] = 1
    solver_option: ClassVar[str] = "drive_mode"
    pressed: ClassVar[bool] = False

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
        super()._set_forces()
        launch(
            "set_effort_limits", self._pressing.shape[1:], self._step, self._pressing, self.joints, self._effort_limits
        )

    def _read_forces(self) -> None:
        inputs = self._rows, self._solver._impulses, self.joints, 1 / self._time_step, self._friction
        launch("read_drives", self._friction.shape, *inputs)
