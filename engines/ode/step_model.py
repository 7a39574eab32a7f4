"""The laws of ODE in SI units: its softness, and springs of its own in an implicit Euler step."""

import math
from collections.abc import Callable, Mapping
from dataclasses import replace

import numpy as np

from engines.interface.law import Constant, Law
from engines.interface.presets import Preset
from reference_lcp.chain.mass_in_mass import Chain
from reference_lcp.chain.simulation import Lane
from reference_lcp.chain.trajectory import State, Trajectory
from reference_lcp.schemes.linear_implicit import LinearImplicitLane, LinearStep, ScalarFriction
from reference_lcp.schemes.sequential import LaneModel
from reference_lcp.validation import FloatArray

TILTED_PERIOD = 1e-7
"""Of U0: measured are up to 7e-9, of chains of unequal masses, with coefficients of friction below `TIPPING`."""

TIPPING = 1.0
"""Coefficient of friction from which on a box is about to tip over its edge: friction times its height is then the
normal force times its width. Measured are up to 4e-6 U0 from the law with 1, and 3e-4 with 3."""


def soft_motors(preset: Preset) -> Law:
    """Give the law of motors as friction beside springs as forces."""
    formula = "equation (5), with Coulomb's law softened: (Wᵀ M⁻¹ W)_ii + cfm / h"
    return _softened(formula, preset, LinearStep.explicit)


def soft_stops(preset: Preset) -> Law:
    """Give the law of stops as springs: they are solved together with friction."""
    formula = (
        "(M + h C + h² K) q̇⁺ = M q̇ − h K q + h f(t) e_1 + W p; "
        "Coulomb's law, softened: (Wᵀ (M + h C + h² K)⁻¹ W)_ii + cfm / h"
    )
    return _softened(formula, preset, LinearStep.implicit)


def soft_boxes(preset: Preset) -> Law:
    """Give the law of boxes on plates: four points share the load, and friction."""
    formula = "equation (5), with Coulomb's law softened by four points: (Wᵀ M⁻¹ W)_ii + cfm / (4 h)"
    law = _softened(formula, preset, LinearStep.explicit, points=4)
    return replace(
        law,
        constants={"cfm": replace(law.constants["cfm"], too_small_to_see=True)},
        period_bound=TILTED_PERIOD,
        bound_reason="four soft points let round-off tilt a box, which opens one or the other of them for a step",
        unmodelled_reason=_unmodelled_box,
    )


def _unmodelled_box(lane: Lane) -> str | None:
    """Say why boxes do something else in a lane; ``None`` if they do not."""
    if lane.direction:
        return "both tangents of the world carry friction in a row that is turned"
    if np.any(lane.chain.friction_coefficient >= TIPPING):
        return f"boxes are about to tip over their edges from a friction coefficient of {TIPPING:g} on"
    return None


def _softened(formula: str, preset: Preset, step: Callable[[Chain, float], LinearStep], points: int = 1) -> Law:
    def model(lane: Lane, of: Mapping[str, float]) -> LinearImplicitLane:
        friction = ScalarFriction.coulomb(lane.chain.cells, of["cfm"] / points / lane.time_step)
        return LinearImplicitLane(lane, step(lane.chain, lane.time_step), friction)

    constants = {"cfm": Constant(preset["cfm"], "m/(s N)", "cfm")}
    return Law(formula=formula, constants=constants, model=model, modulated=True)


def normal_first(preset: Preset) -> Law:
    """Give the law of spheres on plates that are inclined to the row."""
    options = preset.modulated()
    return Law(
        formula=(
            "equation (7) with bounds that know no friction: 0 <= Λ⁰ ⟂ n·v_free + A_nn Λ⁰ − e (z − l)⁺ / h >= 0, then "
            "|Λ_T| <= μ Λ⁰ against the slip while 0 <= Λ_N ⟂ n·v⁺ − e (z − l)⁺ / h >= 0; contacts at depths z > 0"
        ),
        constants={
            "e": Constant(options["erp"], "", "erp"),
            "l": Constant(options["surface_layer"], "", "surface_layer, over s"),
            "z": Constant(options["depth"], "", "depth at no gap, over s"),
        },
        model=lambda lane, of: NormalFirstLane(lane, erp=of["e"], layer=of["l"], depth=of["z"]),
        modulated=True,
        lifting=True,
        inclines=True,
    )


class NormalFirstLane(LaneModel):
    """One chain of spheres on inclined plates, with a preload: friction is bounded by a normal force that knows none.

    The state has their gaps. `erp` is the part of a depth beyond the layer that is corrected in a step; `layer`, in
    which a depth is left alone, and `depth` at no gap are over the displacement scale.
    """

    def __init__(self, lane: Lane, *, erp: float, layer: float, depth: float):
        chain, self.lane = lane.chain, lane
        scale = lane.drive.displacement_scale(chain)
        self._erp, self._layer, self._depth = erp, layer * scale, depth * scale
        self._step = LinearStep.explicit(chain, lane.time_step)
        sine, cosine = math.sin(lane.inclination), math.cos(lane.inclination)
        self._normal, self._tangent = np.array([-sine, cosine]), np.array([cosine, sine])
        # inverse masses of a contact along the row and across it
        self._inverse_masses = np.vstack([1 / chain.outer_mass + 1 / chain.inner_mass, 1 / chain.inner_mass])

    def run(self, state: State, start: int, steps: int) -> Trajectory:
        """Advance from `state` at step index `start`."""
        lane, cells, h = self.lane, self.lane.chain.cells, self.lane.time_step
        loads, presses = lane.loads(start, steps), lane.preloads(start, steps)
        position, velocity = state.positions[0].copy(), state.velocities[0].copy()
        height, rate = self._heights(state)
        rows = np.empty((steps, 7 * cells))
        for step in range(steps):
            free = self._step.state @ np.concatenate([velocity, position]) + self._step.load[:, 0] * loads[step]
            gap = self._gap(height, position)
            press = -h * presses[step] * self._normal[:, None]
            motion = np.vstack([free[2 * cells :], rate]) + self._inverse_masses * press
            normal, friction = self._impulses(motion, self._depth - gap)
            along, across = press + self._normal[:, None] * normal + self._tangent[:, None] * friction
            velocity = free[: 2 * cells] + self._step.response @ along
            position = position + h * velocity
            rate = rate + self._inverse_masses[1] * across
            height = height + h * rate
            rows[step] = np.concatenate([position, velocity, friction / h, normal / h, self._gap(height, position)])
        places, velocities, friction, normal, gaps = np.split(rows, np.array([2, 4, 5, 6]) * cells, axis=1)
        end = np.concatenate([gaps[-1], self._gap(rate, velocity)])
        return Trajectory(lane.times(start, steps), places, velocities, friction, normal, end, gaps)

    def _heights(self, state: State) -> tuple[FloatArray, FloatArray]:
        """Give places and velocities across the row, at which gaps and their rates are those of a state."""
        cells, (along, above) = self.lane.chain.cells, self._normal
        gaps = state.normal_state(cells)
        height, rate = (
            (gap[0] - along * (motion[0, cells:] - motion[0, :cells])) / above
            for gap, motion in zip(gaps, (state.positions, state.velocities), strict=True)
        )
        return height, rate

    def _gap(self, height: FloatArray, motion: FloatArray) -> FloatArray:
        """Give the gaps, or their rates."""
        cells, (along, above) = self.lane.chain.cells, self._normal
        gap: FloatArray = above * height + along * (motion[cells:] - motion[:cells])
        return gap

    def _impulses(self, motion: FloatArray, depth: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Give normal and friction impulses of contacts that would move so, along and across the row, without them.

        Normal impulses are solved without friction; μ times these bounds it, and then both are solved together.
        """
        chain, (n, t) = self.lane.chain, (self._normal, self._tangent)
        across, both, along = (a * b @ self._inverse_masses for a, b in ((n, n), (n, t), (t, t)))
        touching = (depth > 0) & (chain.friction_bound > 0)
        missing = self._erp / self.lane.time_step * np.maximum(depth - self._layer, 0.0) - n @ motion
        bound = np.where(touching, chain.friction_coefficient * np.maximum(missing / across, 0.0), 0.0)
        slip = t @ motion
        closed = np.clip(-(slip + both * missing / across) / (along - both**2 / across), -bound, bound)
        normal = (missing - both * closed) / across
        opened = np.clip(-slip / along, -bound, bound)
        presses = touching & (normal > 0)
        return np.where(presses, normal, 0.0), np.where(presses, closed, opened)
