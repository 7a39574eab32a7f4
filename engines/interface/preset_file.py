"""Presets from a file beside an adapter: an engine's own values once, and what each preset changes, with reasons.

The tables of a ``presets.toml``:

``[own]``, ``[joint.own]``, ``[contact.own]``
    Options with the engine's own values, in both formulations or in one. ``name = value``, or ``name = [value, text]``
    with what that value does: in lower case it goes on after "the engine's own: ". A table ``{value, text, default,
    fixed, held, absent}`` says more, as `Option` has it; ``absent``: the engine does without it.
``[joint.PRESET]``
    ``about``, and what `Preset` says otherwise than by default. ``base``: another preset that it starts from.
``[joint.PRESET.set]``
    What it changes: ``name = [value, reason]``. ``[tuned]`` has what the tuned presets of both formulations change.
``[joint.PRESET.own]``
    Options that it has beside those of its formulation; ``without`` lists those that it has not.
``[joint.modulated]``, ``[joint.PRESET.modulated]``
    The same of options that act where the normal force changes in time.
``[joint]``, ``[all]``
    Keys of presets that hold for all presets of a formulation, or of both.

A value is a number, a text, a switch, a list, or ``{formula = "2h 1"}``: what depends on the time step h.
"""

import ast
import operator
import re
import tomllib
from collections.abc import Callable, Iterator, Mapping
from dataclasses import fields, replace
from pathlib import Path
from typing import Any

from multibody_xval.engines.interface.presets import ADAPTERS_UNITS, Formulation, NormalForce, OfStep, Option, Preset
from reference_lcp.errors import ParameterError, checked_choice

OPERATORS: Mapping[type[ast.AST], Callable[..., float]] = {
    ast.Add: operator.add, ast.Sub: operator.sub, ast.Mult: operator.mul, ast.Div: operator.truediv,
    ast.Pow: operator.pow, ast.USub: operator.neg,
}  # fmt: skip
"""Of formulas."""

TABLES = ("set", "own", "modulated")
"""Of a preset."""

NOT_STATED = ("options", "modulated_options", "settings", "description")
"""Fields of `Preset` that are made from tables."""

CLAIMS = {each.name: each.type for each in fields(Preset) if each.name not in NOT_STATED}
KEYS = ("about", "base", "without", *CLAIMS)

KINDS: Mapping[Any, tuple[str, tuple[type, ...]]] = {
    bool: ("true or false", (bool,)),
    float: ("a number", (float, int)),
    str: ("a text", (str,)),
    int | None: ("an integer", (int,)),
    NormalForce: (" or ".join(NormalForce), (str,)),
    tuple[str, ...]: ("a list of texts", (list,)),
    Mapping[str, float]: ("a table of numbers", (dict,)),
    Mapping[str, tuple[float, ...]]: ("a table of lists of numbers", (dict,)),
}
"""What a file has for the type of a field: in words, and as it is read."""

OF_OPTION = ("value", "text", "default", "fixed", "held", "absent")


def presets_of(file: Path, title: str) -> dict[Formulation, dict[str, Preset]]:
    """Read the presets of an engine.

    Raises
    ------
    ParameterError
        If the file is none of TOML, a key is unknown, a value is of another kind, or a formula has another name than h;
        with file, preset and key.
    """
    try:
        tables = tomllib.loads(file.read_text(encoding="utf-8"))
    except tomllib.TOMLDecodeError as problem:
        raise ParameterError(f"{_name(file)} cannot be read: {problem}; allowed: TOML, each key once") from None
    formulations = [each for each in Formulation if str(each) in tables]
    for name in tables:
        checked_choice(f"table of {_name(file)}", name, ["own", "all", "tuned", *map(str, Formulation)])
    return {each: _Formulation(file, tables, str(each), title).presets() for each in formulations}


def _name(file: Path) -> str:
    return f"{file.parent.name}/{file.name}"


class _Formulation:
    """One formulation of a file."""

    def __init__(self, file: Path, tables: Mapping[str, Any], name: str, title: str):
        self._where, self._title = f"{_name(file)}, {name}", title
        self._tables = tables[name]
        self._claims = {**tables.get("all", {}), **{key: each for key, each in self._tables.items() if key in CLAIMS}}
        self._own = {ADAPTERS_UNITS: Option.own("SI", "The chain in SI units.")}
        self._own |= self._options("own", {**tables.get("own", {}), **self._tables.get("own", {})})
        self._modulated = self._options("modulated", self._tables.get("modulated", {}))
        self._tuned = tables.get("tuned", {})

    def presets(self) -> dict[str, Preset]:
        """Give the presets by name, in their order."""
        made: dict[str, Preset] = {}
        for name, table in self._tables.items():
            if name in CLAIMS or name in ("own", "modulated"):
                continue
            if not isinstance(table, dict):
                raise ParameterError(f"{self._where}: {name} = {table!r}; allowed: {', '.join(CLAIMS)}, or a preset")
            made[name] = self._preset(name, table, made)
        return made

    def _preset(self, name: str, table: Mapping[str, Any], before: Mapping[str, Preset]) -> Preset:
        where = f"{self._where}:{name}"
        for key in table:
            checked_choice(f"key of {where}", key, [*KEYS, *TABLES])
        claims = {"optional": name not in ("tuned", "default"), **self._claims}
        claims |= {key: value for key, value in table.items() if key in CLAIMS}
        given = {key: self._claim(where, key, value) for key, value in claims.items()}
        if "base" in table:
            checked_choice(f"base of {where}", table["base"], list(before))
        base = before[table["base"]].options if "base" in table else self._own
        own = {key: option for key, option in base.items() if key not in table.get("without", [])}
        own |= self._options(f"{name}.own", table.get("own", {}))
        changes = {**(self._tuned if name == "tuned" else {}), **table.get("set", {})}
        modulated = dict(self._modulated) if given.get("normal_force", NormalForce.CONSTANT) != "constant" else {}
        for key, option in self._changed(f"{where}.modulated", {**own, **modulated}, table.get("modulated", {})):
            modulated[key] = option
        changed = dict(self._changed(f"{where}.set", own, changes))
        options = {**changed, **own, **changed}
        try:
            return Preset(table.get("about", ""), options, modulated_options=modulated, **given)
        except ParameterError as problem:
            raise ParameterError(f"{where}: {problem}") from None

    def _claim(self, where: str, key: str, value: Any) -> Any:
        """Check a key of a preset by the type of its field."""
        words, kinds = KINDS[CLAIMS[key]]
        if not isinstance(value, kinds) or (isinstance(value, bool) and bool not in kinds):
            raise ParameterError(f"{where}: {key} = {value!r}; allowed: {words}")
        if CLAIMS[key] is NormalForce:
            return NormalForce(checked_choice(f"{where}: {key}", str(value), list(map(str, NormalForce))))
        return _value(where, key, value)

    def _changed(
        self, where: str, own: Mapping[str, Option], changes: Mapping[str, Any]
    ) -> Iterator[tuple[str, Option]]:
        """Give the options that are changed, each with its reason."""
        for key, stated in changes.items():
            checked_choice(f"option of {where}", key, list(own))
            if not isinstance(stated, list) or len(stated) != 2 or not isinstance(stated[1], str):
                raise ParameterError(f"{where}: {key} = {stated!r}; allowed: [value, reason]")
            value = _value(where, key, stated[0])
            if value == own[key].value:
                raise ParameterError(f"{where}: {key} = {stated[0]!r} is the engine's own; allowed: what is changed")
            yield key, replace(own[key], value=value, reason=stated[1])

    def _options(self, table: str, stated: Mapping[str, Any]) -> dict[str, Option]:
        where = f"{self._where}.{table}"
        return {key: self._option(where, key, each) for key, each in stated.items()}

    def _option(self, where: str, key: str, stated: Any) -> Option:
        """Read an option with the engine's own value."""
        if isinstance(stated, list) and len(stated) == 2 and isinstance(stated[1], str):
            stated = {"value": stated[0], "text": stated[1]}
        if not isinstance(stated, dict) or "formula" in stated:
            stated = {"value": stated}
        for name in stated:
            checked_choice(f"key of {where}.{key}", name, OF_OPTION)
        if "value" not in stated:
            raise ParameterError(f"{where}: {key} has no value; allowed: value, and {', '.join(OF_OPTION[1:])}")
        value = _value(where, key, stated["value"])
        default = None if stated.get("absent") else _value(where, key, stated.get("default", stated["value"]))
        return Option(
            value, default, self._meaning(stated.get("text", "")), stated.get("fixed", False), stated.get("held", False)
        )

    def _meaning(self, text: str) -> str:
        if not text:
            return f"{self._title}'s own."
        return text if text[0].isupper() else f"{self._title}'s own: {text}"


def _value(where: str, key: str, stated: Any) -> Any:
    """Give a value as adapters take it: a tuple for a list, and what depends on the step for a formula."""
    if isinstance(stated, list):
        return tuple(_value(where, key, each) for each in stated)
    if isinstance(stated, dict) and list(stated) == ["formula"]:
        return OfStep(stated["formula"], _formula(where, key, stated["formula"]))
    if isinstance(stated, dict):
        return {name: _value(where, key, each) for name, each in stated.items()}
    return stated


def _formula(where: str, key: str, text: str) -> Callable[[float], Any]:
    """Read the parts of a formula, with spaces between, as ``2h 1``; a product needs no sign before h or a bracket."""
    try:
        parts = [re.sub(r"(?<=[\d)])(?=[h(])", "*", part).replace("²", "**2") for part in text.split()]
        trees = [ast.parse(part, mode="eval").body for part in parts]
        values = tuple(_evaluated(tree, 1.0) for tree in trees)
    except (SyntaxError, KeyError, ArithmeticError, TypeError) as problem:
        raise ParameterError(
            f"{where}: {key} = {text!r} is no formula ({problem}); allowed: numbers, h, + - * / ( ) ² and spaces"
        ) from None
    if len(values) == 1:
        return lambda step: _evaluated(trees[0], step)
    return lambda step: tuple(_evaluated(tree, step) for tree in trees)


def _evaluated(tree: ast.AST, step: float) -> float:
    """Evaluate an expression of numbers and h."""
    match tree:
        case ast.Constant(value=float() | int() as value):
            return float(value)
        case ast.Name(id="h"):
            return step
        case ast.BinOp(left=left, op=op, right=right):
            return OPERATORS[type(op)](_evaluated(left, step), _evaluated(right, step))
        case ast.UnaryOp(op=op, operand=operand):
            return OPERATORS[type(op)](_evaluated(operand, step))
    raise KeyError(ast.unparse(tree))
