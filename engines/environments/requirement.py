"""Which packages an engine of a name needs: ``mujoco@3.3.7`` is a version of an engine that is registered."""

from dataclasses import dataclass
from typing import Self

from packaging.specifiers import SpecifierSet
from packaging.version import InvalidVersion, Version

from engines.environments.environment import Environment
from engines.interface.engine import Engine
from engines.shared.wheel_engine import WheelEngine
from reference_lcp.refusal import ParameterError, shown

EXAMPLE = "mujoco@3.3.7"
"""The name of a version, for messages."""

NEEDED = ("numpy", "packaging")
"""What every adapter needs beside its engine."""


@dataclass(frozen=True)
class Requirement:
    """An engine from a package index, in one version or in whatever its adapter takes.

    Parameters
    ----------
    adapter
        The engine as it is registered.
    version
        Beginning of the version, such as ``3.3.7`` or ``6``; empty for the newest one that the adapter takes.
    """

    adapter: WheelEngine
    version: str = ""

    @classmethod
    def of(cls, registered: Engine, version: str | None = None) -> Self:
        """Check that the engine comes from a package index, and that its adapter takes this version; any without one.

        Raises
        ------
        ParameterError
            If not; with the versions that it takes.
        """
        name = f"engine = {shown(registered.name if version is None else f'{registered.name}@{version}')}"
        if not isinstance(registered, WheelEngine):
            comes_with = "the suite" if registered.name == "reference" else "the system"
            raise ParameterError(f"{name}: it comes with {comes_with}; allowed: {registered.name}")
        if version is None:
            return cls(registered)
        try:
            Version(version)
        except InvalidVersion:
            raise ParameterError(f"{name} has no version after the @; allowed: one as in {EXAMPLE}") from None
        if not registered.takes(version):
            package = registered.capabilities.package
            raise ParameterError(f"{name}: its adapter does not take that; allowed: {package} {registered.versions}")
        return cls(registered, version)

    @property
    def name(self) -> str:
        """Of the engine in an environment of its own."""
        return f"{self.adapter.name}@{self.version}" if self.version else self.adapter.name

    @property
    def environment(self) -> Environment:
        """The environment that it is installed into."""
        return Environment(self.name)

    @property
    def lines(self) -> list[str]:
        """The packages, as uv and pip take them."""
        own = SpecifierSet(self.adapter.versions) & SpecifierSet(self._beginning)
        return [f"{self.adapter.capabilities.package}{own}", *self.adapter.environment_packages, *NEEDED]

    def met_by(self, installed: str) -> bool:
        """Tell whether this version is one of those that are meant."""
        return SpecifierSet(self._beginning).contains(installed, prereleases=True)

    @property
    def _beginning(self) -> str:
        """The version as a specifier: whatever begins so; a preliminary or a local one must be that very one."""
        if not self.version:
            return ""
        exact = Version(self.version)
        return f"=={self.version}" if exact.is_prerelease or exact.local else f"=={exact.public}.*"
