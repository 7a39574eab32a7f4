"""One way to simulate the chain: an engine, a formulation, a preset."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Self

from engines.interface.law_engine import LAW_SUFFIX, law_of
from engines.interface.presets import Capabilities, Preset
from engines.interface.registry import default_engine_names, engine
from reference_lcp.chain.simulation import Lane, Simulation
from reference_lcp.refusal import ParameterError


@dataclass(frozen=True, order=True)
class Variant:
    """An engine, a formulation and a preset, by name."""

    engine: str
    formulation: str = "joint"
    preset_name: str = "tuned"

    @classmethod
    def parse(cls, text: str) -> Self:
        """Read ``ENGINE``, ``ENGINE:FORMULATION`` or ``ENGINE:FORMULATION:PRESET``; joint and tuned are understood.

        An engine may be a version of one, ``NAME@VERSION``.

        Raises
        ------
        ParameterError
            If there are more parts, the engine has no such formulation or preset, or it is a version that is not there.
        """
        variant = cls.recorded(text)
        check_version(variant.engine)
        return variant

    @classmethod
    def recorded(cls, text: str) -> Self:
        """Read what `parse` reads, where it is not to be run: versions need not be there."""
        parts = text.split(":")
        if len(parts) > 3:
            raise ParameterError(f"engine = {text!r} has {len(parts)} parts; allowed: ENGINE[:FORMULATION[:PRESET]]")
        variant = cls(*parts)
        engine(variant.engine).preset(variant.formulation, variant.preset_name)
        return variant

    def __str__(self) -> str:
        """Give the shortest text that `parse` reads."""
        if self.preset_name != "tuned":
            return f"{self.engine}:{self.formulation}:{self.preset_name}"
        return self.engine if self.formulation == "joint" else f"{self.engine}:{self.formulation}"

    @property
    def preset(self) -> Preset:
        """Give the preset itself."""
        return engine(self.engine).preset(self.formulation, self.preset_name)

    @property
    def capabilities(self) -> Capabilities:
        """Give the engine's capabilities."""
        return engine(self.engine).capabilities

    @property
    def batch_lanes(self) -> int:
        """Give the number of lanes that one simulation takes at best."""
        return self.preset.batch_lanes or self.capabilities.batch_lanes

    @property
    def unavailable_reason(self) -> str | None:
        """Give the reason why it cannot be used here; ``None`` if it can."""
        return engine(self.engine).unavailable_reason_of(self.preset)

    def build(self, lanes: Sequence[Lane]) -> Simulation:
        """Build every lane; see `Engine.build`."""
        return engine(self.engine).build(lanes, self.formulation, self.preset_name)

    @property
    def law(self) -> Self | None:
        """Give the variant that is the model of this one's law; ``None`` where it has no model."""
        if law_of(self.preset) is None or self.engine.endswith(LAW_SUFFIX):
            return None
        return replace(self, engine=f"{engine(self.engine).states_laws_of}{LAW_SUFFIX}")

    @property
    def inclined_law(self) -> Self | None:
        """Give the same of its steps where contacts are inclined to the row; ``None`` where they have no model."""
        if self.preset.inclined_law is None:
            return self.law
        return replace(self, engine=f"{engine(self.engine).states_laws_of}{LAW_SUFFIX}")

    @property
    def title(self) -> str:
        """The name that reports print; joint and tuned are left out."""
        special = [part for part, usual in ((self.formulation, "joint"), (self.preset_name, "tuned")) if part != usual]
        return ", ".join([engine(self.engine).capabilities.title, *special])


def variants_of(name: str, *, optional: bool = False) -> list[Variant]:
    """Give the variants of an engine, in the order in which its capabilities list them.

    Parameters
    ----------
    name
        Of the engine.
    optional
        Give those of `Preset.optional` too.

    Raises
    ------
    ParameterError
        If no engine of this name is registered.
    """
    return [
        Variant(name, str(formulation), preset_name)
        for formulation, presets in engine(name).capabilities.presets.items()
        for preset_name, preset in presets.items()
        if optional or not preset.optional
    ]


def variants_named(text: str) -> list[Variant]:
    """Give the variants of ``ENGINE`` but for optional ones, or the one that ``ENGINE:FORMULATION[:PRESET]`` names.

    Raises
    ------
    ParameterError
        If no engine of this name is registered, it has no such formulation or preset, or it is a version that is not
        there.
    """
    if ":" in text:
        return [Variant.parse(text)]
    check_version(text)
    return variants_of(text)


def check_version(name: str) -> None:
    """Refuse a version of an engine that cannot be run here.

    Raises
    ------
    ParameterError
        If it is in no environment, or in one that is not whole; with the command that makes it.
    """
    missing = engine(name).unavailable_reason() if "@" in name else None
    if missing is not None:
        raise ParameterError(f"engine = {name!r} cannot be used: {missing}")


def default_variants() -> list[Variant]:
    """Give the variants that are compared where none is named: every formulation, tuned and as the engine comes.

    Those of the engines that come with the suite.
    """
    return [
        Variant(name, str(formulation), preset_name)
        for name in default_engine_names()
        for formulation, presets in engine(name).capabilities.presets.items()
        for preset_name in ("tuned", "default")
        if preset_name in presets
    ]
