"""Mutants whose chain is moved by another drive, or pressed by another preload, than is given."""

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any

from engines.mutants.altered import AlteredSimulation, of_lanes
from engines.mutants.mutant import Mutant, Original
from reference_lcp.chain.harmonic import Drive, HarmonicForce, MovingBase
from reference_lcp.chain.mass_in_mass import Chain
from reference_lcp.chain.simulation import Lane
from reference_lcp.validation import FloatArray

LATE = (7.0, 1.0, 0.1, 1e-2, 1e-3, 1e-4, 1e-5, 1e-6)
"""Time steps by which something comes late."""

WHOLE = (1.0,)
"""The error is there or not."""


@dataclass(frozen=True)
class _AlteredDrive:
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
class _StiffDashpotlessBase(_AlteredDrive):
    """A moving base that lacks a part of the force of its dashpot."""

    missing: float = 0.0

    def load(self, chain: Chain, time: FloatArray) -> FloatArray:
        load = self.drive.load(chain, time)
        if not isinstance(self.drive, MovingBase):
            return load
        return load - self.missing * chain.chain_damping[0] * self.drive.velocity(time)


def _driven(kind: type, **changes: Callable[[Lane, float], float]) -> Any:
    """Alter the drives of a kind, by fields of `_AlteredDrive`."""

    def change(lane: Lane, size: float) -> Lane:
        if not isinstance(lane.drive, kind):
            return lane
        values = {name: value(lane, size) for name, value in changes.items()}
        return replace(lane, drive=_AlteredDrive(lane.drive, **values))

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
        sizes=LATE,
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
        sizes=LATE,
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
        sizes=WHOLE,
    ),
    Mutant(
        name="preload-late",
        error="a normal force that changes s steps late",
        build=_preloaded("phase", lambda phase, size, step: phase - size * step),
        sizes=LATE,
    ),
    Mutant(
        name="preload-modulation",
        error="a normal force whose modulation is × (1 − s)",
        build=_preloaded("modulation", lambda modulation, size, _: modulation * (1 - size)),
    ),
)
