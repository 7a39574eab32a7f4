"""The law of DART's own springs: an implicit Euler step, then Coulomb friction under the bare masses."""

from collections.abc import Mapping

from engines.interface.law import Constant, Law
from engines.interface.presets import Preset
from reference_lcp.chain.simulation import Lane
from reference_lcp.stepping.linear_implicit import FrictionLaw, LinearImplicitLane, LinearStep


def own_springs(preset: Preset) -> Law:
    """Give the law of the joints' own springs."""
    mixing = Constant(preset["constraint force mixing"], "", "constraint force mixing", too_small_to_see=True)
    return Law(
        formula=(
            "(M + h C + h² K) q̇_free = M q̇ − h K q + h f(t) e_1; q̇⁺ = q̇_free + M⁻¹ W p; "
            "Coulomb's law, softened by the part ε of (Wᵀ M⁻¹ W)_ii"
        ),
        constants={"ε": mixing},
        model=_own_springs,
        modulated=True,
    )


def _own_springs(lane: Lane, constants: Mapping[str, float]) -> LinearImplicitLane:
    chain, h = lane.chain, lane.time_step
    mass = chain.mass_matrix
    implicit = mass + h * chain.damping_matrix + h**2 * chain.stiffness_matrix
    step = LinearStep.of(chain, h, implicit, mass, (1.0, 0.0), response_matrix=mass)
    return LinearImplicitLane(lane, step, FrictionLaw.coulomb(chain.cells, constants["ε"] * step.coupling.diagonal()))
