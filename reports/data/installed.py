"""What an engine does as it is installed, beside what it does with the options of its tuned presets."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from engines.interface.registry import engine
from engines.interface.variant import Variant
from reports.data.errors import VariantErrors


@dataclass(frozen=True)
class Installed:
    """Both presets of one formulation of an engine.

    Parameters
    ----------
    default, tuned
        How far both are from the truth.
    options
        What the tuned preset sets otherwise than the default one, by name.
    """

    default: VariantErrors
    tuned: VariantErrors
    options: Mapping[str, Any]

    @property
    def title(self) -> str:
        """The engine, and its formulation where that is not the joint."""
        variant = self.tuned.variant
        own = variant.capabilities.title
        return own if variant.formulation == "joint" else f"{own}, {variant.formulation}"


def installed(errors: Mapping[Variant, VariantErrors]) -> list[Installed]:
    """Give every formulation of which both presets have an error, the largest default error first."""
    pairs = []
    for default in errors.values():
        if default.variant.preset_name != "default":
            continue
        own = default.variant
        tuned = errors.get(Variant(own.engine, own.formulation))
        if tuned is not None and tuned.known and default.known:
            pairs.append(Installed(default, tuned, changed_options(own.engine, own.formulation)))
    return sorted(pairs, key=lambda pair: -pair.default.size)


def by_engine(pairs: list[Installed]) -> dict[str, list[Installed]]:
    """Give the formulations of each engine, joints first, by the title of the engine."""
    engines: dict[str, list[Installed]] = {}
    for pair in pairs:
        engines.setdefault(pair.tuned.variant.capabilities.title, []).append(pair)
    return {
        name: sorted(own, key=lambda pair: pair.tuned.variant.formulation != "joint") for name, own in engines.items()
    }


def changed_options(name: str, formulation: str) -> dict[str, Any]:
    """Give the options of the tuned preset whose values are others than in the default preset."""
    presets = (engine(name).preset(formulation, preset).options for preset in ("tuned", "default"))
    tuned, default = presets
    return {
        option: own.value
        for option, own in tuned.items()
        if own.value != (default[option].value if option in default else own.default)
    }
