"""Proven digits beside those of another program: numbers of mpmath, Taylor series, equations over half a period."""

from decimal import Decimal

import numpy as np
import pytest

from reference_lcp import Chain, ExactChain, HarmonicBase, prove
from reference_lcp.exact.exact_orbit import exact_orbit

pytest.importorskip("flint", reason="python-flint is not installed")
mp = pytest.importorskip("mpmath", reason="mpmath is not installed").mp

DIGITS = 40


class SecondProgram:
    """A uniform chain of unit masses and springs and a base of unit amplitude, over half of an antiperiodic motion.

    The state is (u, v, u̇, v̇, sin ωt, cos ωt, 1, q, q̇) of n cells. q is an oscillator at the drive's frequency that
    the last outer mass moves: after half a period it holds the first harmonic of that mass.
    """

    def __init__(self, cells: int, friction: str, frequency: str):
        self.cells, self.friction, self.omega = cells, mp.mpf(friction), mp.mpf(frequency)
        stretch = np.eye(cells, dtype=int) - np.eye(cells, k=-1, dtype=int)
        between, one, c = stretch.T @ stretch, np.eye(cells, dtype=int), 2 * mp.mpf("0.01")
        self.outer, self.inner = (np.full((cells, 4 * cells + 5), mp.mpf(0)) for _ in range(2))
        self.outer[:, : 3 * cells] = np.hstack([-between - one, one, -c * between])
        self.outer[0, 4 * cells : 4 * cells + 2] = mp.mpf(1), c * self.omega
        self.inner[:, : 2 * cells] = np.hstack([one, -one])

    def held(self, cell: int):
        """Row of the force on the inner mass that keeps a contact at rest."""
        return (self.outer[cell] - self.inner[cell]) / 2

    def moved(self, modes, state, duration):
        """The state after a time in which contacts keep their modes."""
        n, size = self.cells, state.size
        rates = np.full((size, size), mp.mpf(0))
        rates[: 2 * n, 2 * n : 4 * n] = np.eye(2 * n, dtype=int)
        for cell, mode in enumerate(modes):
            force = self.held(cell)
            if mode:
                force = np.zeros(size, dtype=int) * force
                force[4 * n + 2] = -mode * self.friction
            rates[2 * n + cell], rates[3 * n + cell] = self.outer[cell] - force, self.inner[cell] + force
        rates[4 * n, 4 * n + 1], rates[4 * n + 1, 4 * n] = self.omega, -self.omega
        rates[-2, -1], rates[-1, -2], rates[-1, n - 1] = mp.mpf(1), -(self.omega**2), mp.mpf(1)
        term, total, order = state, state, 0
        while max(map(abs, term)) > mp.mpf(10) ** -(DIGITS + 9):
            order += 1
            term = rates @ term * (duration / order)
            total = total + term
        return total

    def solved(self, first, events, guess):
        """Times of the events, and the state after half a period; from modes, events and a guess of state and times."""
        n, half, rest = self.cells, mp.pi / self.omega, np.array([mp.mpf(x) for x in (0, 1, 1, 0, 0)])

        def shot(unknown):
            modes, state, since, residuals = list(first), np.concatenate([unknown[: 4 * n], rest]), 0, []
            for (cell, new), time in zip(events, unknown[4 * n :], strict=True):
                state, since = self.moved(modes, state, time - since), time
                slips = state[3 * n + cell] - state[2 * n + cell]
                residuals.append(slips if modes[cell] else self.held(cell) @ state + new * self.friction)
                modes[cell] = new
            return self.moved(modes, state, half - since), residuals

        def residuals(*unknown):
            end, conditions = shot(np.array(unknown))
            return [*(end[: 4 * n] + unknown[: 4 * n]), *conditions]

        slope = mp.jacobian(residuals, guess)
        root = list(mp.findroot(residuals, guess, J=lambda *_: slope, tol=mp.mpf(10) ** -DIGITS, maxsteps=6))
        return root[4 * n :], shot(np.array(root))[0]


def found_in_doubles(cells: int, friction: str, frequency: str):
    """Modes at the start, events (cell, new mode), and a guess of state and times: all over half a period."""
    unit = {"outer_mass": 1, "chain_stiffness": 1, "base_amplitude": 1}
    chain = Chain.from_ratios(cells=cells, friction_ratio=float(friction), **unit)
    drive = HarmonicBase.from_ratio(chain, float(frequency), 1)
    _, period = exact_orbit(chain, drive)
    modes, starts = period.modes[period.lasting], [period.segments[row].start for row in period.lasting]
    rows = [row for row in range(1, len(modes)) if starts[row] < drive.period / 2]
    changes = [(row, cell) for row in rows for cell in np.flatnonzero(modes[row] != modes[row - 1]).tolist()]
    events = [(cell, int(modes[row, cell])) for row, cell in changes]
    state = period.segments[0].states(np.array([0.0]))[0]
    return modes[0].tolist(), events, [*state.tolist(), *(starts[row] for row, _ in changes)]


@pytest.mark.parametrize(
    ("cells", "friction", "frequency"),
    [(1, "0.3", "0.6"), (2, "0.3", "1.1"), pytest.param(3, "0.3", "0.8", marks=pytest.mark.slow)],
)
def test_every_proven_digit_is_that_of_a_program_that_shares_nothing_with_the_proof(cells, friction, frequency) -> None:
    proof = prove(ExactChain.from_ratios(cells=cells, friction_ratio=friction, frequency_ratio=frequency))
    with mp.workdps(DIGITS + 10):
        second = SecondProgram(cells, friction, frequency)
        first, events, guess = found_in_doubles(cells, friction, frequency)
        assert events
        times, end = second.solved(first, events, guess)
        sine, cosine = second.omega * end[-2], -end[-1]
        level = 20 * mp.log10(2 * second.omega / mp.pi * mp.hypot(sine, cosine))
        parts = [time * second.omega / (2 * mp.pi) + half for half in (0, 0.5) for time in times]
        changes = sorted(zip([cell + 1 for cell, _ in events] * 2, parts, strict=True))
        own = [mp.nstr(x, DIGITS) for x in (level, mp.atan2(cosine, sine), *(part for _, part in changes))]
    assert [change.cell for change in proof.transitions] == [cell for cell, _ in changes]
    enclosures = [proof.transmittance_db, proof.phase, *(change.time_over_period for change in proof.transitions)]
    for enclosure, number in zip(enclosures, own, strict=True):
        assert enclosure.radius < Decimal("1e-20")
        assert enclosure.contains(Decimal(number))
