"""What is registered as an engine, and is none or does not say what it is."""

from engines import Engine
from engines.reference import Reference


class NoEngine:
    """Another class."""


def raises():
    """Fail where an engine is made."""
    raise OSError("no licence\nserver")


class Unfinished(Engine):
    """Abstract methods are left."""


class NoCapabilities(Reference):
    """Its capabilities are no such object."""

    name = "broken-capabilities"
    capabilities = None


class NoVersion(Reference):
    """It does not know its version."""

    name = "broken-version"

    def version(self):
        """Fail."""
        raise LookupError("no version of the wheel")


class VersionIsANumber(Reference):
    """Its version is no text."""

    name = "broken-number"

    def version(self):
        """Give a number."""
        return 2


class NoReason(Reference):
    """It does not know whether it is installed."""

    name = "broken-reason"

    def unavailable_reason(self):
        """Fail."""
        raise RuntimeError("no reason")
