"""Why finer or exact presets of the reference have no model."""

from engines.interface.law import NotModelled
from engines.interface.presets import Preset


def authority(_: Preset) -> NotModelled:
    """Say that they are not predicted by anything: others are compared with them."""
    return NotModelled("it is what others are judged by: Coulomb's law itself, with a finer step or none")
