"""One way to simulate the chain: an engine, a formulation, a preset and changed options; what names stand for."""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any, Self

from multibody_xval.engines.interface.changed_options import value_text
from multibody_xval.engines.interface.presets import Capabilities, Formulation, Preset
from multibody_xval.engines.interface.registry import engine, installed_engine_names
from reference_lcp.chain.simulation import Lane, Simulation
from reference_lcp.errors import ParameterError, checked_choice

FORM = "ENGINE[:FORMULATION[:PRESET]][:OPTION=VALUE]..."
"""How a variant is named."""


GENERAL = ("default", "recommended")
"""Presets that hold in any model; others are for the chain."""

FOR_THE_CHAIN = "Chosen to be exact for this chain, and not to be copied into other models."


@dataclass(frozen=True, order=True)
class Variant:
    """An engine, a formulation and a preset, by name."""

    engine: str
    formulation: str = "joint"
    preset_name: str = "tuned"
    """Name of the preset; after it, as ``:NAME=VALUE``, the options that are changed in it, sorted."""

    @classmethod
    def parse(cls, text: str) -> Self:
        """Read ``ENGINE``, ``ENGINE:FORMULATION`` or ``ENGINE:FORMULATION:PRESET``; joint and tuned are understood.

        Options of the preset may follow, as ``:NAME=VALUE``.

        Raises
        ------
        ParameterError
            If there are more parts, or the engine has no such formulation, preset or option.
        """
        names, settings = name_parts(text)
        variant = cls(*names)
        preset = engine(variant.engine).preset(variant.formulation, ":".join([variant.preset_name, *settings]))
        return replace(variant, preset_name=":".join([variant.preset_name, *preset.settings]))

    def __str__(self) -> str:
        """Give the shortest text that `parse` reads."""
        name, *settings = self.preset_name.split(":")
        names = [self.engine, self.formulation, name]
        for usual in ("tuned", "joint"):
            if names[-1] == usual:
                names.pop()
            else:
                break
        return ":".join([*names, *settings])

    def changed(self, option: str, value: Any) -> Self:
        """Give it with one more option changed.

        Raises
        ------
        ParameterError
            If the preset has no such option, or it does not take the value.
        """
        setting = f"{option}={value_text(value)}"
        return self.parse(":".join([self.engine, self.formulation, self.preset_name, setting]))

    @property
    def unchanged(self) -> Self:
        """Give it without changed options."""
        return replace(self, preset_name=self.preset_name.split(":")[0])

    @property
    def preset(self) -> Preset:
        """Give the preset itself."""
        return engine(self.engine).preset(self.formulation, self.preset_name)

    @property
    def changed_options(self) -> dict[str, Any]:
        """Give the options that are otherwise than by default, with the values that they have there."""
        return self.preset.changed_from(self._presets["default"])

    @property
    def runs_scenes(self) -> bool:
        """Whether it is for scenes: its options hold in any model, or it runs nothing else."""
        return self.unchanged.preset_name in GENERAL or self.preset.scenes_only

    @property
    def description(self) -> str:
        """Say what the preset is for; of a tuned one, that it is for this chain alone."""
        chosen = self.preset_name == "tuned" and "default" in self._presets
        return f"{self.preset.description} {FOR_THE_CHAIN}" if chosen else self.preset.description

    def reach(self, option: str) -> str:
        """Say where an option of its may be copied to: *general* where the recommended preset changes it too."""
        recommended = self._presets.get("recommended")
        changed = recommended is not None and option in recommended.changed_from(self._presets["default"])
        return "general" if changed or self.unchanged.preset_name in GENERAL else "this chain only"

    @property
    def _presets(self) -> Mapping[str, Preset]:
        return self.capabilities.presets[Formulation(self.formulation)]

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
        return engine(self.engine).unavailable_reason()

    def build(self, lanes: Sequence[Lane]) -> Simulation:
        """Build every lane; see `Engine.build`."""
        return engine(self.engine).build(lanes, self.formulation, self.preset_name)

    @property
    def tuned(self) -> Self:
        """Give the tuned preset of the same formulation; its title names engine and formulation alone."""
        return replace(self, preset_name="tuned")

    @property
    def title(self) -> str:
        """The name that reports print; joint and tuned are left out."""
        name, *settings = self.preset_name.split(":")
        special = [part for part, usual in ((self.formulation, "joint"), (name, "tuned")) if part != usual]
        changes = [setting.replace("=", " = ", 1) for setting in settings]
        return ", ".join([engine(self.engine).capabilities.title, *special, *changes])


def name_parts(text: str) -> tuple[list[str], list[str]]:
    """Give engine, formulation and preset of a name, as far as it has them, and the options that follow."""
    parts = text.split(":")
    settings = [part for part in parts if "=" in part]
    names = parts[: len(parts) - len(settings)]
    if not 1 <= len(names) <= 3 or parts[len(names) :] != settings:
        raise ParameterError(f"engine = {text!r} has {len(parts)} parts; allowed: {FORM}")
    return names, settings


ALL = "all"
"""In place of a part of a name: every one; of engines, every one that is installed."""

EVERY_VARIANT = f"{ALL}:{ALL}:{ALL}"
"""Every preset of every engine that is installed."""


def variants_of(name: str, *, optional: bool = False, scenes_only: bool = False) -> list[Variant]:
    """Give the variants of an engine, in the order in which its capabilities list them.

    Parameters
    ----------
    name
        Of the engine.
    optional, scenes_only
        Give those of `Preset.optional`, of `Preset.scenes_only` too.

    Raises
    ------
    ParameterError
        If no engine of this name is registered.
    """
    return [
        Variant(name, str(formulation), preset_name)
        for formulation, presets in engine(name).capabilities.presets.items()
        for preset_name, preset in presets.items()
        if (optional or not preset.optional) and (scenes_only or not preset.scenes_only)
    ]


def variants_named(names: Sequence[str], *, scenes_only: bool = False) -> list[Variant]:
    """Give the variants that are to be run by their names, each once; an engine that is named has to be installed.

    ``all`` in place of a part stands for every one, but for presets that take part only where they are named.

    Raises
    ------
    ParameterError
        If a name is unknown or its engine not installed; unless `scenes_only`, also if its preset runs nothing else.
    """
    found: list[Variant] = []
    for name in names:
        own = _variants(name)
        chosen = own if scenes_only else [each for each in own if not each.preset.scenes_only]
        if own and not chosen:
            allowed = ", ".join(map(str, variants_of(own[0].engine, optional=True))) or "another engine"
            raise ParameterError(f"engine = {own[0]} runs scenes only; allowed: {allowed}")
        found += chosen
    return list(dict.fromkeys(found))


def variants_begun(name: str) -> list[Variant]:
    """Give the variants whose names begin with this one, optional ones too: of an engine alone, all that it has.

    Raises
    ------
    ParameterError
        If there is no such engine, formulation, preset or option, or the engine is not installed.
    """
    names, settings = name_parts(name)
    if len(names) == 3 or settings:
        return variants_named([name], scenes_only=True)
    own = variants_of(names[0], optional=True, scenes_only=True)
    check_installed(names[0], engine(names[0]).unavailable_reason())
    if len(names) == 1:
        return own
    formulation = checked_choice(f"formulation of {names[0]}", names[1], _each(each.formulation for each in own))
    return [each for each in own if each.formulation == formulation]


def _variants(text: str) -> list[Variant]:
    """Give the variants of one name, whose engines are installed."""
    names, settings = name_parts(text)
    if ALL not in names:
        variant = Variant.parse(text)
        check_installed(variant.engine, variant.unavailable_reason)
        return [variant]
    if settings:
        raise ParameterError(f"engine = {text!r} sets {settings[0]} in several variants; allowed: in one")
    name, formulation, preset = [*names, *("joint", "tuned")[len(names) - 1 :]]
    if name != ALL:
        check_installed(name, engine(name).unavailable_reason())
    engines = installed_engine_names() if name == ALL else [name]
    listed = [each for own in engines for each in variants_of(own, optional=preset != ALL, scenes_only=True)]
    if formulation != ALL:
        checked_choice(f"formulation of {name}", formulation, _each(each.formulation for each in listed))
        listed = [each for each in listed if each.formulation == formulation]
    if preset != ALL:
        checked_choice(f"preset of {name}", preset, _each(each.preset_name for each in listed))
        listed = [each for each in listed if each.preset_name == preset]
    return listed


def _each(names: Iterable[str]) -> list[str]:
    return list(dict.fromkeys(names))


def check_installed(name: str, missing: str | None) -> None:
    """Refuse an engine that is named, if something is missing."""
    if missing is not None:
        raise ParameterError(f"engine = {name} is not installed: {missing}")
