"""What an engine does as it is installed, beside what it does with the options of its tuned presets."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from engines.interface.variant import Variant
from reports.data.errors import VariantErrors
from reports.data.single_options import SingleOption
from scenarios.studies.one_option import tuned_options


@dataclass(frozen=True)
class Installed:
    """Both presets of one formulation of an engine.

    Parameters
    ----------
    default, tuned
        How far both are from the truth.
    options
        What the tuned preset sets otherwise than the default one, by name.
    decisive
        The one of them that alone leaves the least of the default's error, if that is less than half; ``None`` where
        there is none, or it is not known.
    """

    default: VariantErrors
    tuned: VariantErrors
    options: Mapping[str, Any]
    decisive: SingleOption | None = None


def installed(errors: Mapping[Variant, VariantErrors], singles: Sequence[SingleOption] = ()) -> list[Installed]:
    """Give every formulation of which both presets have an error, the largest default error first."""
    best = {single.default.variant: single for single in reversed(singles) if single.halves}
    pairs = []
    for default in errors.values():
        if default.variant.preset_name != "default":
            continue
        own = default.variant
        tuned = errors.get(own.tuned)
        if tuned is not None and tuned.known and default.known:
            pairs.append(Installed(default, tuned, tuned_options(own.engine, own.formulation), best.get(own)))
    return sorted(pairs, key=lambda pair: -pair.default.size)


def by_engine(pairs: list[Installed]) -> dict[str, list[Installed]]:
    """Give the formulations of each engine, joints first, by the title of the engine."""
    engines: dict[str, list[Installed]] = {}
    for pair in pairs:
        engines.setdefault(pair.tuned.variant.capabilities.title, []).append(pair)
    return {
        name: sorted(own, key=lambda pair: pair.tuned.variant.formulation != "joint") for name, own in engines.items()
    }
