"""What each option of a tuned preset does alone: the default preset with that one option."""

from collections.abc import Mapping
from dataclasses import dataclass

from engines.interface.variant import Variant
from reports.data.errors import VariantErrors
from scenarios.studies.one_option import with_single_options


@dataclass(frozen=True)
class SingleOption:
    """A default preset with one option of the tuned one.

    Parameters
    ----------
    default, tuned
        Errors of both presets, at the same points.
    option, value
        The option and the value that the tuned preset gives it, as commands take it.
    errors
        Errors of the default preset with this option.
    """

    default: VariantErrors
    tuned: VariantErrors
    option: str
    value: str
    errors: VariantErrors

    @property
    def halves(self) -> bool:
        """Whether the option alone takes off more than half of the largest error."""
        return self.errors.known == self.default.known and self.errors.size < self.default.size / 2


def single_options(errors: Mapping[Variant, VariantErrors]) -> list[SingleOption]:
    """Give the single options of every default whose errors are known, by engine and formulation, smallest first."""
    every = []
    for default in errors.values():
        own = default.variant
        tuned = errors.get(own.tuned)
        if own.preset_name == "default" and tuned is not None:
            changed = [errors[variant] for variant in with_single_options(own) if variant in errors]
            every += [SingleOption(default, tuned, *_setting(each.variant), each) for each in changed if each.known]
    return sorted(every, key=lambda single: (str(single.default.variant), single.errors.size))


def _setting(variant: Variant) -> tuple[str, str]:
    """Give name and value of the one option that is changed."""
    name, _, value = variant.preset.settings[0].partition("=")
    return name, value
