"""The names of `multibody_xval` with their docstrings: parts of the page of Python (`docs/tables.py`)."""

import inspect
from collections.abc import Iterator
from enum import EnumType
from functools import cached_property
from typing import Any

import multibody_xval

FENCE = "```"


def table() -> list[tuple[str, str]]:
    """Give every name with the first paragraph of its docstring."""
    return [(f"`{name}`", first_paragraph(value)) for name, value in names().items()]


def names() -> dict[str, Any]:
    """Give all names, functions first."""
    every = {name: getattr(multibody_xval, name) for name in multibody_xval.__all__}
    return dict(sorted(every.items(), key=lambda item: (inspect.isclass(item[1]), item[0].lower())))


def first_paragraph(value: object) -> str:
    """Give the first paragraph of a docstring in one line."""
    return " ".join((inspect.getdoc(value) or "").split("\n\n")[0].split())


def lines() -> Iterator[str]:
    """Give a section a name: its call, its docstring, and of a class its methods."""
    for name, value in names().items():
        yield from ("", f"### {name}", "", f"{FENCE}text", call(name, value), "", inspect.getdoc(value) or "", FENCE)
        if inspect.isclass(value):
            own = {key: each for key, each in vars(value).items() if not key.startswith("_")}
            texts = [
                f"- `{member(key, each)}`: {first_paragraph(each)}" for key, each in own.items() if is_described(each)
            ]
            yield from (["", *texts] if texts else [])


def is_described(value: object) -> bool:
    """Tell whether a member of a class is a method or property with a docstring of its own."""
    kinds = (property, cached_property, classmethod, staticmethod)
    return bool(inspect.getdoc(value)) and (isinstance(value, kinds) or inspect.isfunction(value))


def member(name: str, value: Any) -> str:
    """Give a method with its parameters, or the name of a property."""
    return name if isinstance(value, property | cached_property) else call(name, getattr(value, "__func__", value))


def call(name: str, value: Any) -> str:
    """Give a call with parameters and simple defaults, without types, which the docstring has."""
    if isinstance(value, EnumType):  # whose signature is another one in each Python
        return f"{name}(value)"
    try:
        parameters = list(inspect.signature(value).parameters.values())
    except (TypeError, ValueError):
        return name
    parts, star = [], False
    for own in parameters:
        if own.name in ("self", "cls", "unknown"):
            continue
        if own.kind is own.KEYWORD_ONLY and not star:
            parts.append("*")
            star = True
        star = star or own.kind is own.VAR_POSITIONAL
        prefix = {own.VAR_POSITIONAL: "*", own.VAR_KEYWORD: "**"}.get(own.kind, "")
        default = "" if own.default is own.empty else f"={shown(own.default)}"
        parts.append(f"{prefix}{own.name}{default}")
    return f"{name}({', '.join(parts)})"


def shown(default: object) -> str:
    """Give a default as text; dots where it is no number, text or None."""
    return repr(default) if type(default) in (int, float, str, bool, type(None)) else "..."
