"""Equation (7) with the normal direction resolved: against the fast path of closed contacts, and against events."""

import math

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from reference_lcp import (
    Chain,
    CompiledSimulation,
    HarmonicBase,
    Lane,
    Preload,
    State,
)
from tests.reference_lcp.cases import driven, moved
from tests.reference_lcp.resolved_lane import ResolvedLane

AMPLITUDE = 0.01
ROUND_OFF = 1e-12
"""Largest difference of two ways to compute one scheme, over U0 or U0 ω: a few thousand roundings."""

PERIODS = 4
EVENT_TOLERANCE = 1e-11
"""Relative tolerance of the event-driven solution: seven decades below the error of the finest steps."""


def flat_chain(cells=7, friction_ratio=0.3, frequency_ratio=0.9):
    chain = Chain.from_ratios(cells=cells, friction_ratio=friction_ratio, base_amplitude=AMPLITUDE)
    return chain, HarmonicBase.from_ratio(chain, frequency_ratio, AMPLITUDE)


def test_flat_contacts_under_constant_preload_move_as_the_chain_with_given_normal_force() -> None:
    chain, drive = flat_chain()
    lane, steps = Lane.periodic(chain, drive, 400), 3 * 400
    fast = CompiledSimulation([lane]).run(State.at_rest(1, 7), 0, steps)[0]
    full = moved(ResolvedLane(lane), lane.time_step, steps)
    velocity_scale = AMPLITUDE * drive.angular_frequency
    assert np.max(np.abs(full.positions[:, :14] - fast.positions)) <= ROUND_OFF * AMPLITUDE
    assert np.max(np.abs(full.velocities[:, :14] - fast.velocities)) <= ROUND_OFF * velocity_scale
    assert np.max(np.abs(full.friction - fast.friction)) <= ROUND_OFF * chain.friction_bound[0]
    assert np.max(np.abs(full.normal_force / chain.normal_force - 1)) <= ROUND_OFF
    assert np.max(np.abs(full.positions[:, 14:])) <= ROUND_OFF * AMPLITUDE
    assert {"stick", "slip"} == {
        "stick" if stuck else "slip" for stuck in np.unique(np.abs(full.relative_velocity) < 1e-9 * velocity_scale)
    }


class EventDriven:
    """One inclined cell of unit masses, integrated from event to event.

    Written from Newton's law of the cell, and apart from everything that it tests: modes of the contact
    are enumerated, forces come from two equations for two unknowns, and impacts are inelastic with
    Coulomb's law between the impulses.
    """

    def __init__(self, k_c, c_c, k_i, base, omega, preload, alpha, mu):
        self.k_c, self.c_c, self.k_i, self.base, self.omega = k_c, c_c, k_i, base, omega
        self.preload, self.mu = preload, mu
        s, c = math.sin(alpha), math.cos(alpha)
        self.normal, self.tangent = np.array([s, -s, c]), np.array([-c, c, s])
        rows = np.vstack([self.normal, self.tangent])
        self.delassus = rows @ rows.T

    def free_acceleration(self, t, x):
        u, v, _, du = x[:4]
        w = self.omega
        ground = self.k_c * (self.base * math.sin(w * t) - u) + self.c_c * (self.base * w * math.cos(w * t) - du)
        spring = self.k_i * (v - u)
        return np.array([ground + spring, -spring, 0.0]) - self.normal * self.preload(t)

    def contact(self, mode, b):
        """Force (λ_N, λ_T) of a mode, b being the free acceleration (or velocity) along normal and tangent."""
        if mode == "open":
            return np.zeros(2)
        if mode == "stick":
            return np.linalg.solve(self.delassus, -b)
        ratio = -self.mu if mode == "forward" else self.mu
        normal = -b[0] / (self.delassus[0, 0] + ratio * self.delassus[0, 1])
        return np.array([normal, ratio * normal])

    def admissible(self, mode, b, force):
        after = b + self.delassus @ force
        return {
            "open": after[0] >= 0,
            "stick": force[0] >= 0 and abs(force[1]) <= self.mu * force[0],
            "forward": force[0] >= 0 and after[1] > 0,
            "backward": force[0] >= 0 and after[1] < 0,
        }[mode]

    def choose(self, b, modes):
        fitting = [mode for mode in modes if self.admissible(mode, b, self.contact(mode, b))]
        assert len(fitting) == 1, f"{fitting} of {modes} fit"
        return fitting[0]

    def projected(self, vector):
        return np.array([self.normal @ vector, self.tangent @ vector])

    def loads(self, t, x):
        return self.projected(self.free_acceleration(t, x))

    def rate(self, mode):
        def of(t, x):
            force = self.contact(mode, self.loads(t, x))
            return np.concatenate(
                [x[3:], self.free_acceleration(t, x) + force[0] * self.normal + force[1] * self.tangent]
            )

        return of

    def exits(self, mode):
        """Functions that fall through zero where the mode ends, each with the modes that may follow."""
        opening = (lambda t, x: self.contact(mode, self.loads(t, x))[0], ("open",))
        if mode == "open":
            return [(lambda _, x: self.normal @ x[:3], None)]
        if mode == "stick":

            def reserve(sign):
                return lambda t, x: self.contact(mode, self.loads(t, x)) @ [self.mu, sign]

            return [(reserve(1.0), ("forward",)), (reserve(-1.0), ("backward",))]
        sign, other = (1.0, "backward") if mode == "forward" else (-1.0, "forward")
        return [opening, (lambda _, x: sign * (self.tangent @ x[3:]), ("stick", other))]

    def landed(self, t, x):
        """State and mode after an impact without restitution."""
        b = self.projected(x[3:])
        impact = self.choose(b, ("stick", "forward", "backward"))
        force = self.contact(impact, b)
        x = np.concatenate([x[:3], x[3:] + force[0] * self.normal + force[1] * self.tangent])
        if impact != "stick":
            held = self.contact(impact, self.loads(t, x))[0] > 0
            return x, impact if held else "open"
        return x, self.choose(self.loads(t, x), ("stick", "forward", "backward", "open"))

    def run(self, end):
        """Dense solution pieces (start, end, mode, interpolant) from rest, the contact closed and stuck."""
        t, x, mode, pieces = 0.0, np.zeros(6), "stick", []
        while t < end:
            exits = self.exits(mode)
            events = [function for function, _ in exits]
            for event in events:
                event.terminal, event.direction = True, -1
            solution = solve_ivp(
                self.rate(mode), (t, end), x, "DOP853", events=events, dense_output=True,
                rtol=EVENT_TOLERANCE, atol=EVENT_TOLERANCE * AMPLITUDE,
            )  # fmt: skip
            pieces.append((t, solution.t[-1], mode, solution.sol))
            t, x = solution.t[-1], solution.y[:, -1]
            if solution.status != 1:
                break
            following = next(after for hits, (_, after) in zip(solution.t_events, exits, strict=True) if hits.size)
            if following is None:
                x, mode = self.landed(t, x)
            else:
                mode = following[0] if len(following) == 1 else self.choose(self.loads(t, x), following)
        return pieces


def inclined_cell(alpha, friction_ratio, frequency_ratio, modulation, multiple):
    """One cell, its preload modulated at a multiple of the drive's frequency; and its event-driven solution."""
    chain, drive = driven(frequency_ratio, cells=1, friction_ratio=friction_ratio, damping_ratio=0.05)
    frequency = multiple * drive.angular_frequency
    mean, mu = chain.normal_force[0], chain.friction_coefficient[0]
    exact = EventDriven(
        chain.chain_stiffness[0], chain.chain_damping[0], chain.inner_stiffness[0], AMPLITUDE,
        drive.angular_frequency, lambda t: mean * (1 + modulation * math.sin(frequency * t)), alpha, mu,
    )  # fmt: skip
    preload = Preload(modulation=modulation, angular_frequency=frequency)
    return ResolvedLane(Lane(chain, drive, 1.0, preload), alpha), exact


def positions_of(pieces, time):
    starts = np.array([piece[0] for piece in pieces])
    rows = [pieces[max(0, np.searchsorted(starts, t, side="right") - 1)][3](t)[:3] for t in time]
    return np.array(rows)


def run_inclined(cell, steps_per_period):
    return moved(cell, cell.lane.drive.period / steps_per_period, PERIODS * steps_per_period)


@pytest.mark.slow
@pytest.mark.parametrize("parameters", [(0.2, 0.3, 0.8, 1.3, 2), (0.4, 0.3, 0.8, 2.0, 2)], ids=str)
def test_cell_that_lifts_off_lands_sticks_and_slips_agrees_with_its_events_at_first_order(parameters) -> None:
    """Contact that opens and closes, friction that follows the normal force, G_NT ≠ 0.

    The error depends on where in a step the events fall; so it is the root mean square over the run, and
    each resolution stands for three numbers of steps whose grids do not coincide.
    """
    cell, exact = inclined_cell(*parameters)
    pieces = exact.run(PERIODS * cell.lane.drive.period)
    modes = [mode for _, _, mode, _ in pieces]
    assert {"open", "stick", "forward", "backward"} == set(modes)
    assert "open" in modes[:-2], "no landing"
    errors = []
    for steps in (100, 200, 400, 800, 1600):
        squares = []
        for more in (1.0, 1.11, 1.23):
            motion = run_inclined(cell, round(more * steps))
            squares.append(np.mean((motion.positions - positions_of(pieces, motion.time)) ** 2))
        errors.append(np.sqrt(np.mean(squares)) / AMPLITUDE)
    order = -np.polyfit(np.arange(len(errors)), np.log2(errors), 1)[0]
    assert order == pytest.approx(1.0, abs=0.1)
    assert errors[-1] < 1e-3
    assert np.any(motion.normal_force == 0)
    chain = cell.lane.chain
    assert np.max(np.abs(motion.friction) - chain.friction_coefficient * motion.normal_force) <= (
        1e-9 * chain.friction_bound[0]
    )
