"""Mutants of engines with a law of their own: one constant of it is wrong."""

from dataclasses import replace

from engines.interface.variant import Variant
from engines.mutants.altered import Built
from engines.mutants.mutant import Mutant, Original
from reference_lcp.chain.simulation import Lane, Simulation

LARGE = (9.0, 1.0, 0.1, 1e-2, 1e-3, 1e-4, 1e-5)
"""From ten times as much."""

ZONES = LARGE[:3]
"""Of Exudyn's zone, whose steps take the longest."""

SMALL = (0.1, 1e-2, 1e-3, 1e-4, 1e-5, 1e-6, 1e-7)
"""Of a constant that may not be twice as large."""


def _with_constant(symbol: str) -> Built:
    """Build lanes by the law with a constant × (1 + s)."""

    def build(original: Original, lanes: tuple[Lane, ...], size: float) -> Simulation:
        law = original.law
        assert law is not None, "the original states a law"
        constant = law.constants[symbol]
        wrong = replace(constant, value=(1 + size) * constant.value)
        return replace(law, constants={**law.constants, symbol: wrong}).build(lanes)

    return build


def _off(name: str, what: str, symbol: str, of: Variant, sizes: tuple[float, ...] = LARGE) -> Mutant:
    return Mutant(name=name, error=f"{what} {symbol} × (1 + s)", build=_with_constant(symbol), of=of, sizes=sizes)


MUJOCO, BULLET = Variant("mujoco", "joint", "default"), Variant("pybullet", "joint", "default")

CONSTANTS = (
    _off("mujoco-time-constant", "MuJoCo's time constant", "τ", MUJOCO),
    _off("mujoco-impedance", "MuJoCo's impedance", "d_0", MUJOCO, SMALL),
    _off("pybullet-damping", "Bullet's damping", "k", BULLET),
    _off("pybullet-quadratic-damping", "Bullet's quadratic damping", "k_2", BULLET),
    _off("exudyn-zone", "Exudyn's zone", "z", Variant("exudyn-regularised", "joint", "default"), ZONES),
    _off("drake-gain", "Drake's gain", "d", Variant("drake", "joint", "default")),
    _off("drake-stiction", "Drake's stiction speed", "v_s", Variant("drake", "contact", "default")),
    _off("ode-softness", "ODE's softness", "cfm", Variant("ode", "joint", "stops")),
    _off("siconos-theta", "Siconos'", "θ", Variant("siconos"), SMALL),
)
