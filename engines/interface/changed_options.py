"""Presets with changed options: ``PRESET:NAME=VALUE:…``, read by the types that its options have."""

import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import replace
from typing import Any

from multibody_xval.engines.interface.presets import ACROSS, OfStep, Option, Preset
from reference_lcp.errors import ParameterError, choices, shown

MOST_COUNT = 2**31 - 1
"""Largest integer that engines in C take."""

SWITCHES = {"true": True, "false": False}

NONE = "none"
"""Leaves an option out, as presets do that are without it."""


def changed_preset(
    preset: Preset, settings: Sequence[str], all_presets: Iterable[Preset], installed: Preset, name: str
) -> Preset:
    """Give a preset with some options changed by texts ``NAME=VALUE``; the preset itself where nothing is.

    It claims no longer to share the reference's scheme. The texts that an option takes are those that `all_presets`
    have. What `installed`, the engine as it comes, is without can be left out.
    """
    known = list(all_presets)
    values: dict[str, Any] = {}
    reached = preset
    for setting in settings:
        option, value = _read(reached, setting, known, installed, name)
        if option in values:
            raise ParameterError(f"option {option} of {name} is set twice; allowed: once")
        values[option] = value
        reached = replace(preset, options=_options(preset, values))
    changes = {option: value for option, value in sorted(values.items()) if value != preset[option]}
    return _changed(preset, changes) if changes else preset


def _changed(preset: Preset, changes: Mapping[str, Any]) -> Preset:
    return replace(
        preset,
        options=_options(preset, changes),
        modulated_options={other: own for other, own in preset.modulated_options.items() if other not in changes},
        shares_scheme=False,
        settings=tuple(f"{option}={value_text(value)}" for option, value in changes.items()),
    )


def _options(preset: Preset, changes: Mapping[str, Any]) -> dict[str, Option]:
    """Give all options, some with other values, and without those that are ``None``."""
    left_out = {name for name, value in changes.items() if value is None}
    changed = {name: replace(preset.options[name], value=value) for name, value in changes.items()}
    return {name: option for name, option in {**preset.options, **changed}.items() if name not in left_out}


def value_text(value: Any) -> str:
    """Give a value of an option as `changed_preset` reads it."""
    if isinstance(value, tuple):
        return ",".join(map(value_text, value))
    if isinstance(value, OfStep):
        return ",".join(value.text.split())
    if value is None:
        return NONE
    return str(value).lower() if isinstance(value, bool) else str(value)


def _read(preset: Preset, setting: str, known: Sequence[Preset], installed: Preset, name: str) -> tuple[str, Any]:
    """Read ``NAME=VALUE``."""
    option, _, text = setting.partition("=")
    settable = [each for each, own in preset.engine_options.items() if not own.fixed]
    settable += [each for each in preset.options if each == ACROSS]
    if option not in settable:
        allowed = choices(option, settable) if settable else "allowed: none"
        raise ParameterError(f"option {shown(option)} cannot be set in {name}; {allowed}")
    if text == NONE and _can_be_left_out(preset, option, installed):
        return option, None
    formulas = {value_text(formula): formula for formula in _formulas(option, known)}
    value = formulas.get(text) or _value(text, _numbers(preset[option]), _texts(option, known))
    if value is None:
        raise ParameterError(
            f"{option} = {shown(text)} of {name}; allowed: {_type_text(preset, option, known, installed)}, such as "
            f"{value_text(preset[option])}"
        )
    return option, value


def _numbers(value: Any) -> Any:
    """Give a value of the type that numbers have which an option takes instead of a formula."""
    return value.at(1.0) if isinstance(value, OfStep) else value


def _value(text: str, like: Any, texts: Sequence[str]) -> Any:
    """Read a value of the type of another; ``None`` if it is not of that type."""
    if isinstance(like, tuple):
        return _values(text, like, texts)
    if isinstance(like, bool):
        return SWITCHES.get(text.lower())
    if isinstance(like, str):
        return text if text in texts else None
    return _count(text) if isinstance(like, int) else _number(text)


def _values(text: str, like: tuple[Any, ...], texts: Sequence[str]) -> tuple[Any, ...] | None:
    """Read texts in any number, or as many values as another tuple has."""
    parts = text.split(",") if text else []
    if _is_set_of_flags(like):
        return tuple(parts) if set(parts) <= set(texts) and len(set(parts)) == len(parts) else None
    if len(parts) != len(like):
        return None
    values = tuple(_value(part, each, texts) for part, each in zip(parts, like, strict=True))
    return None if None in values else values


def _count(text: str) -> int | None:
    return int(text) if text.isdecimal() and int(text) <= MOST_COUNT else None


def _number(text: str) -> float | None:
    try:
        number = float(text)
    except ValueError:
        return None
    return number if math.isfinite(number) else None


def _is_set_of_flags(value: tuple[Any, ...]) -> bool:
    """Tell a tuple of any number of texts from one of so many values."""
    return all(isinstance(each, str) for each in value)


def _texts(option: str, known: Sequence[Preset]) -> list[str]:
    """Give the texts that the presets of an engine set an option to, or that the engine has without them."""
    values = _set_or_default(option, known)
    flat = [each for value in values for each in (value if isinstance(value, tuple) else (value,))]
    return sorted({each for each in flat if isinstance(each, str)})


def _formulas(option: str, known: Sequence[Preset]) -> list[OfStep]:
    """Give the formulas that the presets of an engine set an option to, each once."""
    return list(dict.fromkeys(value for value in _set_or_default(option, known) if isinstance(value, OfStep)))


def _can_be_left_out(preset: Preset, option: str, installed: Preset) -> bool:
    """Tell whether the engine has no value of its own for an option, and comes without it."""
    own = installed.options.get(option)
    return preset.options[option].default is None and (own is None or own.value is None)


def _set_or_default(option: str, known: Sequence[Preset]) -> list[Any]:
    settings = [preset.options[option] for preset in known if option in preset.options]
    return [value for setting in settings for value in (setting.value, setting.default)]


def _type_text(preset: Preset, option: str, known: Sequence[Preset], installed: Preset) -> str:
    """Say what an option takes."""
    words = [
        *map(value_text, _formulas(option, known)),
        *([NONE] if _can_be_left_out(preset, option, installed) else []),
    ]
    return _type_of_numbers(preset, option, known) + (f", or {' or '.join(words)}" if words else "")


def _type_of_numbers(preset: Preset, option: str, known: Sequence[Preset]) -> str:
    value = _numbers(preset[option])
    if isinstance(value, tuple):
        if _is_set_of_flags(value):
            return f"any of {', '.join(_texts(option, known))} with commas between, or nothing"
        return f"{len(value)} values with commas between"
    if isinstance(value, str):
        return " or ".join(_texts(option, known))
    return {bool: "true or false", int: "an integer >= 0", float: "a number"}[type(value)]
