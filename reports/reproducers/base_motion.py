"""Motions of the base as expressions of Python in the time t [s]: displacement [m], then velocity [m/s]."""

from functools import singledispatch

from reference_lcp.chain.harmonic import Drive, HarmonicBase, StillBase
from reference_lcp.chain.shaken_table import GrowingAcceleration, Vibration


@singledispatch
def base_motion(drive: Drive) -> str:
    """Give both expressions; an empty text where the base stands still.

    Raises
    ------
    TypeError
        If the drive is none that a question has.
    """
    raise TypeError(f"{type(drive).__name__} is no drive of a reproducer")


@base_motion.register
def _still(_drive: StillBase) -> str:
    return ""


@base_motion.register
def _harmonic(drive: HarmonicBase) -> str:
    amplitude, omega = drive.amplitude, drive.angular_frequency
    return f"{amplitude!r} * np.sin({omega!r} * t), {amplitude * omega!r} * np.cos({omega!r} * t)"


@base_motion.register
def _vibration(drive: Vibration) -> str:
    swing, omega = drive.swing, drive.angular_frequency
    return f"{swing!r} * (1 - np.cos({omega!r} * t)), {swing * omega!r} * np.sin({omega!r} * t)"


@base_motion.register
def _growing(drive: GrowingAcceleration) -> str:
    return f"{drive.amplitude / drive.duration**3!r} * t**3, {drive.jerk / 2!r} * t**2"
