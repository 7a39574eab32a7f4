"""The laws of Exudyn's tuned connectors: a zone or a bristle, in substeps of the trapezoidal rule.

A substep ends with M a⁺ + C v⁺ + K q⁺ + W φ⁺ = f(t+h) e_1, where v⁺ = v + h/2 (a + a⁺), q⁺ = q + h v + h²/4 (a + a⁺).
In a regime of the contacts φ = k x + d w + c, with elongations x and slip velocities w.
"""

from collections.abc import Callable, Mapping

import numpy as np
from numpy.typing import NDArray

from multibody_xval.engines.exudyn.joint import bristles_at, reduced_mass
from multibody_xval.engines.interface.law import Constant, Law, Step
from multibody_xval.engines.interface.presets import Preset
from reference_lcp.chain.simulation import Lane
from reference_lcp.chain.trajectory import State
from reference_lcp.validation import FloatArray

RULE = "trapezoidal rule with φ at its end, substeps h = dt / "

NEWTON_PERIOD = 1e-9
"""Of U0: a substep errs by at most 1e-10 of its first residual; all of them make ten displacement scales a period."""

NEWTON_REASON = "Newton's iteration stops at the relative tolerance"

MOST_CHANGES = 50
"""Of the regimes of zones, in a substep."""

Regime = tuple[FloatArray, FloatArray, FloatArray]
"""k, d and c of every contact, shape (n,)."""


def connector(preset: Preset) -> Law:
    """Give the law of a zone or of a bristle: both engines have presets of this name."""
    if "zone" in preset.options:
        symbols, step = {"z_s": "zone", "z_k": "zone_per_kick"}, _zones
        formula = "φ = F clip(w / z, ±1), z = max(z_s s ω_r, z_k F h / m_red)"
    else:
        symbols, step = {"θ": "bristle_phase", "ζ": "bristle_damping"}, _bristles
        formula = (
            "stick: φ = k_s (x − foot) + d_s w, k_s = m_red (θ / h)², d_s = 2 ζ √(k_s m_red), "
            "until |φ| > F after a substep; slip: φ = F sgn w, until w has reversed after a substep"
        )
    return Law(
        formula=f"{formula}; {RULE}{preset['substeps']}",
        constants={symbol: Constant(preset[option], "", option) for symbol, option in symbols.items()},
        step=lambda lane, of: step(lane, preset["substeps"], of),
        bound=NEWTON_PERIOD,
        bound_reason=NEWTON_REASON,
    )


def _zones(lane: Lane, substeps: int, of: Mapping[str, float]) -> Step:
    """Look for the regimes in which a substep ends, from those of the one before."""
    chain, bound = lane.chain, lane.chain.friction_bound
    speed = lane.drive.displacement_scale(chain) * chain.resonator_frequency
    width = np.maximum(of["z_s"] * speed, of["z_k"] * bound / reduced_mass(chain) * lane.time_step / substeps)

    def regime(slip: FloatArray) -> Regime:
        inside = np.abs(slip) <= width
        return np.zeros(chain.cells), np.where(inside, bound / width, 0.0), np.where(inside, 0.0, np.sign(slip) * bound)

    return _trapezoidal(
        lane,
        substeps,
        start=lambda _position, velocity: regime(chain.contact_directions.T @ velocity),
        after=lambda _regime, _elongation, slip: regime(slip),
        most_changes=MOST_CHANGES,
    )


def _bristles(lane: Lane, substeps: int, of: Mapping[str, float]) -> Step:
    """Keep the regimes of a substep, and change them after it; a slipping bristle has k = 0."""
    chain, bound = lane.chain, lane.chain.friction_bound
    mass = reduced_mass(chain)
    stiffness = mass * (of["θ"] * substeps / lane.time_step) ** 2
    damping = 2 * of["ζ"] * np.sqrt(stiffness * mass)

    def regime(sticks: NDArray[np.bool_], constant: FloatArray) -> Regime:
        return np.where(sticks, stiffness, 0.0), np.where(sticks, damping, 0.0), constant

    def start(position: FloatArray, velocity: FloatArray) -> Regime:
        load = float(lane.loads(0, 1)[0])
        slip, deflection = bristles_at(State(position[None], velocity[None]), lane, load, stiffness, damping)
        foot = chain.contact_directions.T @ position - deflection
        sticks = (slip == 0) & (bound > 0)
        return regime(sticks, np.where(sticks, -stiffness * foot, slip))

    def after(before: Regime, elongation: FloatArray, slip: FloatArray) -> Regime:
        spring, dashpot, constant = before
        stuck = spring > 0
        stays = stuck & (np.abs(spring * elongation + dashpot * slip + constant) <= bound)
        reversed_ = ~stuck & (slip * constant < 0)  # sticks with the force that it had
        held = constant - stiffness * elongation - damping * slip
        return regime(stays | reversed_, np.where(stays, constant, np.where(reversed_, held, np.sign(slip) * bound)))

    return _trapezoidal(lane, substeps, start, after, most_changes=1)


def _trapezoidal(
    lane: Lane,
    substeps: int,
    start: Callable[[FloatArray, FloatArray], Regime],
    after: Callable[[Regime, FloatArray, FloatArray], Regime],
    most_changes: int,
) -> Step:
    """Give the step from the regimes of the first state, and those after a substep from its regimes, x and w."""
    chain, h, slips = lane.chain, lane.time_step / substeps, lane.chain.contact_directions
    acceleration, regime, number = np.empty(0), (np.empty(0),) * 3, 0

    def balanced(position: FloatArray, velocity: FloatArray, load: float, length: float) -> FloatArray:
        """Give accelerations, of which positions and velocities have no part yet."""
        spring, dashpot, constant = regime
        stiffness = chain.stiffness_matrix + (slips * spring) @ slips.T
        damping = chain.damping_matrix + (slips * dashpot) @ slips.T
        force: FloatArray = -stiffness @ position - damping @ velocity - slips @ constant
        force[0] += load
        matrix: FloatArray = chain.mass_matrix + length / 2 * damping + length**2 / 4 * stiffness
        return np.linalg.solve(matrix, force).astype(np.float64)

    def take(
        position: FloatArray, velocity: FloatArray, load: FloatArray, _bound: FloatArray
    ) -> tuple[FloatArray, FloatArray]:
        nonlocal acceleration, regime, number
        if number == 0:
            regime = start(position, velocity)
            acceleration = balanced(position, velocity, load[0], 0.0)
        ends = h * np.arange(number * substeps + 1, (number + 1) * substeps + 1, dtype=np.float64)
        for each in lane.drive.load(chain, ends):
            place, speed = position + h * velocity + h**2 / 4 * acceleration, velocity + h / 2 * acceleration
            for _ in range(most_changes):
                acceleration = balanced(place, speed, each, h)
                position, velocity = place + h**2 / 4 * acceleration, speed + h / 2 * acceleration
                before, regime = regime, after(regime, slips.T @ position, slips.T @ velocity)
                if np.array_equal(before, regime):
                    break
        number += 1
        return position, velocity

    return take


LAWS = {"joint:tuned": connector}
"""By formulation and preset: elsewhere Newton's iteration decides between solutions, or round-off what slips."""
