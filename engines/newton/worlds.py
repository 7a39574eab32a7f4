"""Lanes of Newton as worlds of one model, stepped by SolverSteel."""

import functools
import importlib
from abc import abstractmethod
from collections.abc import Sequence
from typing import Any, ClassVar, Self

import numpy as np
from numpy.typing import NDArray

from multibody_xval.engines.interface.presets import Preset
from multibody_xval.engines.shared.box_geometry import PressedBoxes
from multibody_xval.engines.shared.units import Units
from multibody_xval.engines.shared.warp_worlds import PROCESSOR, Rows, WarpWorlds, import_warp
from multibody_xval.engines.shared.worlds_simulation import WorldsSimulation
from reference_lcp.chain.mass_in_mass import Chain
from reference_lcp.chain.simulation import Lane
from reference_lcp.validation import FloatArray

NO_GRAVITY = (0.0, 0.0, 0.0)

STATE = ("joint_q", "joint_qd", "body_q", "body_qd")
"""What a step advances."""


@functools.cache
def import_newton() -> Any:
    """Import Newton, once Warp is silent."""
    import_warp()
    return importlib.import_module("newton")


def launch(kernel: str, shape: Any, *inputs: Any) -> None:
    """Launch a kernel of `multibody_xval.engines.newton.kernels`."""
    from multibody_xval.engines.newton import kernels

    import_warp().launch(getattr(kernels, kernel), shape, list(inputs))


class NewtonWorlds(WarpWorlds):
    """Chains of one length, in units in which they have one time step, as worlds.

    Each cell's outer mass slides on the ground, and carries the inner one.
    """

    joints: ClassVar[int]
    """Coordinates of a cell."""

    rows_of_a_cell: ClassVar[int]
    """Constraints of a cell."""

    solver_option: ClassVar[str]
    """Option of the preset that SolverSteel takes by its name."""

    pressed: ClassVar[bool]
    """The normal force is the engine's, and not a bound of friction."""

    def __init__(self, chains: Sequence[Chain], time_step: float, preset: Preset, radius: float):
        """Take the radius of spheres in their units, too."""
        self._chains, self._time_step, self._preset, self._radius = chains, time_step, preset, radius
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
        options = {self.solver_option: self._preset[self.solver_option]}
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
        model = copies.finalize(device=PROCESSOR)
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
        inputs = self._loads, self._springs, self.joints, self._positions, self._velocities, self._forces
        launch("set_forces", self._pressing.shape[1:], self._step, *inputs)

    def _advance(self) -> None:
        self._take_step()
        for name in STATE:
            import_warp().copy(getattr(self._before, name), getattr(self._after, name))

    def _take_step(self) -> None:
        """Launch the step from one state to the other."""
        self._solver.step(self._before, self._after, self._control, None, self._time_step)


class NewtonSimulation(WorldsSimulation):
    """Lanes as the worlds of one model; in their units, all have the same time step."""

    def __init__(self, lanes: Sequence[Lane], kind: type[NewtonWorlds], preset: Preset):
        units = [Units.in_steps(preset["units"], lane) for lane in lanes]
        self._kind, self._preset = kind, preset
        chains = [own.scaled(lane.chain) for lane, own in zip(lanes, units, strict=True)]
        radius = PressedBoxes.of(lanes[0], units[0]).box
        worlds = kind(chains, lanes[0].time_step / units[0].time, preset, radius)
        super().__init__(lanes, units, worlds.joints, worlds)

    def subset(self, lanes: Sequence[int] | NDArray[np.intp]) -> Self:
        """Give the lanes of these indices."""
        return type(self)([self.lanes[lane] for lane in lanes], self._kind, self._preset)

    def _pressing(self, start: int, steps: int) -> FloatArray:
        return self._preloads(start, steps) if self._kind.pressed else self._bounds(start, steps)

    def _contact_forces(
        self, index: int, friction: FloatArray, normal_force: FloatArray, given: FloatArray
    ) -> tuple[FloatArray, FloatArray]:
        """Give forces as the solver found them; a drive without a bound to speak of has no friction."""
        rubs, force = self.lanes[index].chain.friction_bound > 0, self._units[index].force
        return np.where(rubs, friction * force, 0.0), normal_force * force if self._kind.pressed else given
