"""The law of DART's own springs, which are implicit, with friction that is solved after them."""

from collections.abc import Mapping

from multibody_xval.engines.interface.laws import Constant, Law, Step
from multibody_xval.engines.interface.presets import Preset
from multibody_xval.engines.shared.linear_law import LinearStep, linear_law, soft_coulomb
from reference_lcp.chain.simulation import Lane

OWN_SPRINGS_PERIOD = 1e-12
"""Of U0: 400 steps of some ten roundings of 1e-16, each of U0. A hundredth of DART's softness is above it."""


def own_springs(preset: Preset) -> Law:
    """Give the law of the joints' own springs."""

    def step(lane: Lane, of: Mapping[str, float]) -> Step:
        implicit = LinearStep.implicit(lane.chain, lane.time_step, lane.chain.mass_matrix)
        return linear_law(lane, implicit, soft_coulomb(of["ε"] * implicit.coupling.diagonal()))

    return Law(
        formula=(
            "(M + h C + h² K) q̇_free = M q̇ − h K q + h f(t) e_1; q̇⁺ = q̇_free + M⁻¹ W p; "
            "Coulomb's law, softened by the part ε of (Wᵀ M⁻¹ W)_ii"
        ),
        constants={"ε": Constant(preset["constraint force mixing"], "", "constraint force mixing")},
        step=step,
        bound=OWN_SPRINGS_PERIOD,
    )


LAWS = {"joint:recommended": own_springs, "joint:default": own_springs}
"""By formulation and preset."""
