"""Three steady states are proven a second time, with arithmetic, equations and tests of signs of their own."""

from decimal import Decimal

import numpy as np
import pytest

from reference_lcp import Chain, ExactChain, HarmonicBase, exact_steady_state, prove
from reference_lcp.exact.exact_orbit import exact_orbit

pytest.importorskip("flint", reason="python-flint is not installed")
pytest.importorskip("mpmath", reason="mpmath is not installed")

from mpmath import iv, mp, nstr

from tests.reference_lcp.exact.proof.interval_proof import Orbit, coulomb, proven_orbit


def near(cells: int, friction: str, frequency: str) -> Orbit:
    """The motion in floating point over a period, in units of masses, springs and the base's amplitude."""
    unit = {"outer_mass": 1.0, "chain_stiffness": 1.0, "base_amplitude": 1.0}
    chain = Chain.from_ratios(cells=cells, friction_ratio=float(friction), **unit)
    _, period = exact_orbit(chain, HarmonicBase.from_ratio(chain, float(frequency), 1.0))
    modes, starts = period.modes[period.lasting], [period.segments[row].start for row in period.lasting]
    events, times = [], []
    for row in range(1, len(modes)):
        for cell in np.flatnonzero(modes[row] != modes[row - 1]).tolist():
            events.append((cell, int(modes[row][cell])))
            times.append(float(starts[row]))
    state = period.segments[0].states(np.array([0.0]))[0]
    for cell in np.flatnonzero(np.all(modes == 0, axis=0)):
        state[cells + cell] = state[cell]  # by symmetry
    numbers = iv.mpf(friction), iv.mpf(frequency), iv.mpf("0.01")
    return Orbit(tuple(map(int, modes[0])), events, times, state.tolist(), *numbers)


@pytest.mark.slow
@pytest.mark.parametrize(("cells", "friction", "frequency"), [(1, "0.3", "0.6"), (2, "0.3", "1.1"), (3, "0.3", "0.8")])
def test_both_proofs_enclose_the_same_transmittance(cells, friction, frequency) -> None:
    level, tangent = coulomb(*proven_orbit(near(cells, friction, frequency)))
    proof = prove(ExactChain.from_ratios(cells=cells, friction_ratio=friction, frequency_ratio=frequency))
    assert len(proof.transitions) > 0
    low, high = (Decimal(nstr(mp.make_mpf(end), 50)) for end in level._mpi_)
    assert high - low < Decimal("1e-10")
    enclosure = proof.transmittance_db
    assert enclosure.value - enclosure.radius <= high
    assert low <= enclosure.value + enclosure.radius
    assert float(tangent.mid) == pytest.approx(np.tan(float(proof.phase.value)), rel=1e-10)


@pytest.mark.slow
def test_second_proof_refuses_another_friction() -> None:
    """Its enclosure is so narrow that one part in 1e7 of the friction is another number."""
    level, _ = coulomb(*proven_orbit(near(1, "0.30000003", "0.6")))
    chain = Chain.from_ratios(cells=1, friction_ratio=0.3)
    assert (
        abs(float(level.mid) - exact_steady_state(chain, HarmonicBase.from_ratio(chain, 0.6)).transmittance_db) > 1e-9
    )


@pytest.mark.slow
def test_second_proof_refuses_a_slip_that_is_declared_a_stick() -> None:
    orbit = near(2, "0.3", "1.1")
    cell = orbit.events[0][0]
    kept = [k for k, event in enumerate(orbit.events) if event[0] != cell]
    orbit.events, orbit.times = [orbit.events[k] for k in kept], [orbit.times[k] for k in kept]
    orbit.first = tuple(0 if k == cell else mode for k, mode in enumerate(orbit.first))
    with pytest.raises(AssertionError):
        coulomb(*proven_orbit(orbit))
