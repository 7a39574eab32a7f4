"""Mutants that build another chain, drive or preload than is given, record something else, or have a wrong constant."""

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from multibody_xval.engines.interface.variant import Variant
from reference_lcp.chain.drives import Drive, HarmonicForce, MovingBase
from reference_lcp.chain.mass_in_mass import Chain
from reference_lcp.chain.simulation import Lane, Simulation
from reference_lcp.chain.trajectory import State, Trajectory
from reference_lcp.defaults import BASE_AMPLITUDE, CHAIN_STIFFNESS, FRICTION_COEFFICIENT
from reference_lcp.validation import FloatArray
from tests.mutations.altered import AlteredSimulation, Built, of_chains, of_lanes, of_records
from tests.mutations.mutant import SCHEME, Mutant, Original


@dataclass(frozen=True)
class AlteredDrive:
    """A drive whose load is another one: (1 + `gain`) times that of the time (1 + `drift`) t − `delay` [s]."""

    drive: Drive
    gain: float = 0.0
    delay: float = 0.0
    drift: float = 0.0

    def load(self, chain: Chain, time: FloatArray) -> FloatArray:
        return (1 + self.gain) * self.drive.load(chain, (1 + self.drift) * time - self.delay)

    def displacement_scale(self, chain: Chain) -> float:
        return self.drive.displacement_scale(chain)

    def parameters(self) -> dict[str, Any]:
        return self.drive.parameters()


@dataclass(frozen=True)
class _StiffDashpotlessBase(AlteredDrive):
    """A moving base that lacks a part of the force of its dashpot."""

    missing: float = 0.0

    def load(self, chain: Chain, time: FloatArray) -> FloatArray:
        load = self.drive.load(chain, time)
        if not isinstance(self.drive, MovingBase):
            return load
        return load - self.missing * chain.chain_damping[0] * self.drive.velocity(time)


def _driven(kind: type, **changes: Callable[[Lane, float], float]) -> Any:
    """Alter the drives of a kind, by fields of `AlteredDrive`."""

    def change(lane: Lane, size: float) -> Lane:
        if not isinstance(lane.drive, kind):
            return lane
        values = {name: value(lane, size) for name, value in changes.items()}
        return replace(lane, drive=AlteredDrive(lane.drive, **values))

    return of_lanes(change)


def _without_dashpot(lane: Lane, size: float) -> Lane:
    return replace(lane, drive=_StiffDashpotlessBase(lane.drive, missing=size))


def _preloaded(name: str, change: Callable[[float, float, float], float]) -> Any:
    """Alter a field of the preload, by its value, the size, and the phase of a time step."""

    def altered(lane: Lane, size: float) -> Lane:
        preload = lane.preload
        if preload is None:
            return lane
        step = lane.time_step * preload.angular_frequency
        return replace(lane, preload=replace(preload, **{name: change(getattr(preload, name), size, step)}))

    return of_lanes(altered)


def _restarted(original: Original, lanes: tuple[Lane, ...], size: float) -> AlteredSimulation:
    return AlteredSimulation(original.build(lanes), lanes, start=lambda start: 0 if size else start)


DRIVES = (
    Mutant(
        name="force-drive",
        error="a force that drives × (1 + s)",
        build=_driven(HarmonicForce, gain=lambda _, size: size),
    ),
    Mutant(
        name="force-late",
        error="a force that drives s steps late",
        build=_driven(HarmonicForce, delay=lambda lane, size: size * lane.time_step),
    ),
    Mutant(
        name="base-amplitude",
        error="a base that moves × (1 + s)",
        build=_driven(MovingBase, gain=lambda _, size: size),
    ),
    Mutant(
        name="base-late",
        error="a base that moves s steps late",
        build=_driven(MovingBase, delay=lambda lane, size: size * lane.time_step),
    ),
    Mutant(
        name="base-dashpot-force",
        error="c u̇_0 of the base × (1 − s)",
        build=of_lanes(_without_dashpot),
    ),
    Mutant(
        name="clock",
        error="every drive at the time (1 + s) t",
        build=_driven(object, drift=lambda _, size: size),
    ),
    Mutant(
        name="start-forgotten",
        error="a drive that begins anew with every run",
        build=_restarted,
    ),
    Mutant(
        name="preload-late",
        error="a normal force that changes s steps late",
        build=_preloaded("phase", lambda phase, size, step: phase - size * step),
    ),
    Mutant(
        name="preload-modulation",
        error="a normal force whose modulation is × (1 − s)",
        build=_preloaded("modulation", lambda modulation, size, _: modulation * (1 - size)),
    ),
)


CELL = 2
"""Cell that is not built as it is given where one alone is wrong, counted from zero."""


def _grown(name: str) -> Built:
    """Build a parameter × (1 + s)."""
    return of_chains(**{name: lambda chain, size: (1 + size) * getattr(chain, name)})


def _shrunk(name: str) -> Built:
    """Build a parameter × (1 − s)."""
    return of_chains(**{name: lambda chain, size: (1 - size) * getattr(chain, name)})


def _in_one_cell(name: str, cell: int, change: Callable[[float], float]) -> Built:
    """Build a parameter of one cell times `change(s)`; chains without this cell are built as given."""

    def changed(chain: Chain, size: float) -> FloatArray:
        return getattr(chain, name) * np.where(np.arange(chain.cells) == cell, change(size), 1.0)

    return of_chains(**{name: changed})


def _towards(name: str, other: Callable[[Chain], FloatArray]) -> Built:
    """Build a parameter p + s (other − p)."""
    return of_chains(**{name: lambda chain, size: getattr(chain, name) + size * (other(chain) - getattr(chain, name))})


def _of_a_given_unit(lane: Lane, size: float) -> Lane:
    """Take the displacement scale of figure 3 for the lane's."""
    factor = BASE_AMPLITUDE / lane.drive.displacement_scale(lane.chain)
    return with_bound(lane, 1 + size * (factor - 1))


def _of_a_given_stiffness(lane: Lane, size: float) -> Lane:
    """Take the chain stiffness of figure 3 for the lane's."""
    return with_bound(lane, 1 + size * (CHAIN_STIFFNESS / lane.chain.chain_stiffness - 1))


def with_bound(lane: Lane, factor: float | FloatArray) -> Lane:
    chain = lane.chain
    return replace(lane, chain=replace(chain, friction_coefficient=factor * chain.friction_coefficient))


def _swapped(chain: Chain, name: str, size: float) -> FloatArray:
    values: FloatArray = getattr(chain, name)
    if chain.cells <= CELL + 1:
        return values
    order = np.arange(chain.cells)
    order[[CELL, CELL + 1]] = CELL + 1, CELL
    return values + size * (values[order] - values)


def _chains_with_swapped_cells() -> Built:
    names = ("outer_mass", "inner_mass", "chain_stiffness", "inner_stiffness", "chain_damping", "inner_damping",
             "normal_force")  # fmt: skip
    return of_chains(**{name: lambda chain, size, own=name: _swapped(chain, own, size) for name in names})


def _named(name: str, error: str, build: Built, of: Variant = SCHEME) -> Mutant:
    return Mutant(name=name, error=error, build=build, of=of)


PARAMETERS = (
    _named("outer-mass", "outer masses × (1 + s)", _grown("outer_mass")),
    _named("inner-mass", "inner masses × (1 + s)", _grown("inner_mass")),
    _named("chain-spring", "chain springs × (1 + s)", _grown("chain_stiffness")),
    _named("inner-spring", "inner springs × (1 + s)", _grown("inner_stiffness")),
    _named("chain-damping", "chain dashpots × (1 + s)", _grown("chain_damping")),
    _named("inner-damping", "inner dashpots × (1 + s)", _grown("inner_damping")),
    _named("base-dashpot", "first chain dashpot × (1 − s)", _in_one_cell("chain_damping", 0, lambda size: 1 - size)),
    _named("inner-dashpots-missing", "inner dashpots × (1 − s)", _shrunk("inner_damping")),
    _named("mass-of-a-cell", "outer mass of cell 3 × (1 + s)", _in_one_cell("outer_mass", CELL, lambda size: 1 + size)),
    _named("cells-swapped", "parameters of cells 3 and 4, s of the way to each other's", _chains_with_swapped_cells()),
    _named("bound", "bound of friction × (1 + s)", _grown("friction_coefficient")),
    _named("normal-force", "normal force × (1 + s)", _grown("normal_force")),
    _named(
        "coefficient-of-cell-1",
        "μ of every cell, s of the way to that of cell 1",
        _towards("friction_coefficient", lambda chain: np.full(chain.cells, chain.friction_coefficient[0])),
    ),
    _named(
        "coefficient-mean",
        "μ of every cell, s of the way to their mean",
        _towards("friction_coefficient", lambda chain: np.full(chain.cells, np.mean(chain.friction_coefficient))),
    ),
    _named(
        "coefficient-ignored",
        "μ, s of the way to 0.5",
        _towards("friction_coefficient", lambda chain: np.full(chain.cells, FRICTION_COEFFICIENT)),
    ),
    _named("bound-of-amplitude", "bound, s of the way to that for U0 = 0.01 m", of_lanes(_of_a_given_unit)),
    _named("bound-of-stiffness", "bound, s of the way to that for k_c = 1000 N/m", of_lanes(_of_a_given_stiffness)),
    _named("siconos-bound", "Siconos' bound of friction × (1 + s)", _grown("friction_coefficient"), Variant("siconos")),
    _named(
        "siconos-base-dashpot",
        "Siconos' first chain dashpot × (1 − s)",
        _in_one_cell("chain_damping", 0, lambda size: 1 - size),
        Variant("siconos"),
    ),
    _named(
        "drake-base-dashpot",
        "Drake's first chain dashpot × (1 − s)",
        _in_one_cell("chain_damping", 0, lambda size: 1 - size),
        Variant("drake", "joint", "default"),
    ),
    _named(
        "mujoco-bound",
        "MuJoCo's bound of friction × (1 + s)",
        _grown("friction_coefficient"),
        Variant("mujoco", "joint", "default"),
    ),
    Mutant(
        name="excused",
        error="bound of friction × (1 + s), excused by a text alone",
        build=_grown("friction_coefficient"),
        of=Variant("mujoco", "joint", "default"),
        excuse="bad weather",
    ),
)


def _friction(run: Trajectory, size: float) -> Trajectory:
    return replace(run, friction=(1 - size) * run.friction)


def _late_friction(run: Trajectory, size: float) -> Trajectory:
    late = np.vstack([run.friction[:1], run.friction[:-1]])
    return replace(run, friction=run.friction + size * (late - run.friction))


def _velocities(run: Trajectory, size: float) -> Trajectory:
    return replace(run, velocities=(1 + size) * run.velocities)


def _normal_force(run: Trajectory, size: float) -> Trajectory:
    return replace(run, normal_force=(1 + size) * run.normal_force)


def _last_position(run: Trajectory, size: float) -> Trajectory:
    cell = np.arange(run.positions.shape[1]) == run.cells - 1
    return replace(run, positions=run.positions * np.where(cell, 1 + size, 1.0))


def _without_internal_state(original: Original, lanes: tuple[Lane, ...], size: float) -> AlteredSimulation:
    """Begin every run from a fresh friction: bristles undeformed, contacts closed."""

    def forgotten(state: State) -> State:
        return State(state.positions, state.velocities) if size else state

    return AlteredSimulation(original.build(lanes), lanes, state=forgotten)


RECORDS = (
    Mutant(name="recorded-friction", error="recorded friction × (1 − s)", build=of_records(_friction)),
    Mutant(
        name="recorded-friction-late",
        error="recorded friction, s of the way to that of the step before",
        build=of_records(_late_friction),
    ),
    Mutant(name="recorded-velocity", error="recorded velocities × (1 + s)", build=of_records(_velocities)),
    Mutant(name="recorded-position", error="recorded position of the last cell × (1 + s)",
           build=of_records(_last_position)),
    Mutant(name="recorded-normal-force", error="recorded normal force × (1 + s)", build=of_records(_normal_force)),
    Mutant(name="gaps-forgotten", error="contacts that are closed at the start of every run",
           build=_without_internal_state),
    Mutant(name="bristles-forgotten", error="bristles that are undeformed at the start of every run",
           build=_without_internal_state, of=Variant("exudyn-bristle")),
)  # fmt: skip


def _with_constant(symbol: str) -> Built:
    """Build lanes by the law with a constant × (1 + s)."""

    def build(original: Original, lanes: tuple[Lane, ...], size: float) -> Simulation:
        law = original.law
        assert law is not None, "the original states a law"
        constant = law.constants[symbol]
        wrong = replace(constant, value=(1 + size) * constant.value)
        return replace(law, constants={**law.constants, symbol: wrong}).build(lanes)

    return build


def _off(name: str, what: str, symbol: str, of: Variant, size: float = 1.0) -> Mutant:
    return Mutant(name=name, error=f"{what} {symbol} × (1 + s)", build=_with_constant(symbol), of=of, size=size)


MUJOCO, BULLET = Variant("mujoco", "joint", "default"), Variant("pybullet", "joint", "default")

CONSTANTS = (
    _off("mujoco-time-constant", "MuJoCo's time constant", "τ", MUJOCO),
    _off("mujoco-impedance", "MuJoCo's impedance", "d_0", MUJOCO, 0.1),
    _off("pybullet-damping", "Bullet's damping", "k", BULLET),
    _off("pybullet-quadratic-damping", "Bullet's quadratic damping", "k_2", BULLET),
    _off("exudyn-zone", "Exudyn's zone", "z", Variant("exudyn-regularised", "joint", "default")),
    _off("drake-gain", "Drake's gain", "d", Variant("drake", "joint", "default")),
    _off("drake-stiction", "Drake's stiction speed", "v_s", Variant("drake", "contact", "default")),
    _off("ode-softness", "ODE's softness", "cfm", Variant("ode", "joint", "stops")),
    _off("siconos-theta", "Siconos'", "θ", Variant("siconos"), 0.1),
)
