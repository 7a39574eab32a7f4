"""What is registered as an engine, and is none or does not say what it is."""

from dataclasses import replace

from multibody_xval.engines import Option, Preset
from multibody_xval.engines.reference import Reference


class NoEngine:
    """Another class."""


def raises():
    """Fail where an engine is made."""
    raise OSError("no licence\nserver")


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


class OptionIsNoText(Reference):
    """One of its options has a value that no file takes."""

    name = "broken-option"
    capabilities = replace(
        Reference.capabilities, presets={"joint": {"tuned": Preset("", {"solver": Option("\udc80", "", "")})}}
    )


class OptionIsANumber(Reference):
    """One of its options is a number, without default and reason."""

    name = "broken-type"
    capabilities = replace(Reference.capabilities, presets={"joint": {"tuned": Preset("", {"iterations": 50})}})


class NoReason(Reference):
    """It does not know whether it is installed."""

    name = "broken-reason"

    def unavailable_reason(self):
        """Fail."""
        raise RuntimeError("no reason")
