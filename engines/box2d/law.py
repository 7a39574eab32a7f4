"""The law of Box2D's own springs: an implicit Euler step, solved together with friction, in single precision."""

from collections.abc import Mapping

from engines.interface.law import Law
from engines.interface.presets import NormalForce, Preset
from reference_lcp.chain.simulation import Lane
from reference_lcp.stepping.linear_implicit import LinearImplicitLane, LinearStep, ScalarFriction

SINGLE_PRECISION_PERIOD = 3e-5
"""Of U0: the stretch of a spring is the difference of two lengths of 64 U0, rounded to 64 U0 · 2^-24 = 4e-6 U0; a
period makes one to three of them."""


def own_springs(preset: Preset) -> Law:
    """Give the law of distance joints as springs; it has no constants beside the chain's."""
    return Law(
        formula="(M + h C + h² K) q̇⁺ = M q̇ − h K q + h f(t) e_1 + W p; Coulomb's law",
        model=_own_springs,
        period_bound=SINGLE_PRECISION_PERIOD,
        bound_growth=0.5,
        bound_reason="single precision: a spring of 64 U0 is rounded to 4e-6 U0",
        modulated=preset.represents(NormalForce.MODULATED),
    )


def _own_springs(lane: Lane, _: Mapping[str, float]) -> LinearImplicitLane:
    return LinearImplicitLane(
        lane, LinearStep.implicit(lane.chain, lane.time_step), ScalarFriction.coulomb(lane.chain.cells)
    )
