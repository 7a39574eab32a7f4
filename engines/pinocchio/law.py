"""Why Pinocchio's ADMM has no model."""

from engines.interface.law import NotModelled
from engines.interface.presets import Preset


def admm(preset: Preset) -> NotModelled:
    """Say what decides its steps."""
    return NotModelled(
        f"Coulomb's law in equation (5), but where ADMM stops, at {preset['tolerance']:g} N s, decides the impulses"
    )
