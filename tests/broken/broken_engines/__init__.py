"""What is registered as an engine, and is none or does not say what it is."""

from dataclasses import replace

from multibody_xval.engines import Preset
from multibody_xval.engines.reference import Reference


class NoEngine:
    """Another class."""


class NoCapabilities(Reference):
    name = "broken-capabilities"
    capabilities = None


class NoVersion(Reference):
    name = "broken-version"

    def version(self):
        raise LookupError("no version of the wheel")


class OptionIsANumber(Reference):
    name = "broken-type"
    capabilities = replace(Reference.capabilities, presets={"joint": {"tuned": Preset("", {"iterations": 50})}})
