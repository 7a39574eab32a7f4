"""Names in an adapter's source: which of them are known here, and which only a script has."""

import ast
import builtins
import inspect
import math
import textwrap
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, is_dataclass
from functools import cache
from types import FunctionType
from typing import Any

import numpy as np

from multibody_xval.engines.interface.scene import Box

SUITE = "multibody_xval"

UNKNOWN = object()
"""Of an expression that only the engine gives."""

PURE = frozenset({
    "abs", "all", "any", "bool", "dict", "enumerate", "float", "int", "isinstance", "len", "list", "map", "max", "min",
    "range", "repr", "round", "str", "sum", "tuple", "zip",
})  # fmt: skip
"""Functions of Python that give the same whenever they are asked."""

Bound = Mapping[str, Any]


@dataclass
class Scope:
    """Names of a function: those whose value is known here, and those that only the script has."""

    module: Mapping[str, Any]
    known: dict[str, Any]
    unknown: set[str]
    shared: frozenset[str] = frozenset()
    """Names that functions within change, which are never known."""
    literal: frozenset[str] = frozenset()
    """Names of loops that are written out: what they stand for is written in their place."""

    def inner(self, names: Iterable[str]) -> "Scope":
        """Give the scope of a function or a loop in this one, with names of its own."""
        own = set(names)
        known = {name: value for name, value in self.known.items() if name not in own}
        return Scope(self.module, known, self.unknown | own, self.shared, self.literal)

    def forget(self, names: Iterable[str]) -> None:
        """Leave it to the script what names stand for."""
        for name in names:
            self.known.pop(name, None)
            self.unknown.add(name)

    def learn(self, name: str, value: Any) -> bool:
        """Note what a name stands for, unless that may change; tells whether it is known now."""
        if value is UNKNOWN or isinstance(value, list) or name in self.shared:
            self.forget([name])
            return False
        self.known[name] = value
        self.unknown.discard(name)
        return True


@cache
def source(of: Any) -> str:
    """Give the text of a function or a class."""
    return textwrap.dedent(inspect.getsource(of))


def tree_of(of: Any) -> Any:
    """Parse it; every tree is a new one, for lines are changed in place."""
    return ast.parse(source(of)).body[0]


def scope_of(of: Any, bound: Bound) -> Scope:
    """Give the scope of a function some of whose arguments are known."""
    tree = tree_of(of)
    names = arguments_of(tree) | assigned_in(tree.body)
    shared = frozenset(name for line in ast.walk(tree) if isinstance(line, ast.Nonlocal) for name in line.names)
    return Scope(of.__globals__, dict(bound), names - set(bound), shared)


def of_module(name: str, scope: Scope) -> Any:
    """Give what a name of an adapter's module stands for, if it gives the same whenever it is asked."""
    if name not in scope.module:
        return getattr(builtins, name) if name in PURE else UNKNOWN
    found = scope.module[name]
    if isinstance(found, FunctionType):
        return found if is_pure(found) else UNKNOWN
    kinds = isinstance(found, type) and (is_dataclass(found) or found.__module__ == "builtins")
    return found if is_plain(found) or kinds or found in (np, math) else UNKNOWN


@cache
def is_pure(function: FunctionType) -> bool:
    """Whether a function of the suite uses no engine."""
    if not function.__module__.startswith(SUITE) or "import" in source(function):
        return False
    called = (function.__globals__.get(name) for name in function.__code__.co_names)
    return all(own is function or is_pure(own) for own in called if isinstance(own, FunctionType))


def is_plain(value: Any) -> bool:
    """Whether a value can be written into a script."""
    if isinstance(value, tuple | list):
        return all(map(is_plain, value))
    if isinstance(value, dict):
        return all(map(is_plain, [*value, *value.values()]))
    return value is None or isinstance(value, bool | int | float | str | Box | np.number)


def is_object(value: Any) -> bool:
    """Whether a value is one of the suite's own, which a script does without."""
    known = type(value).__module__.partition(".")[0] == SUITE and not isinstance(value, Box | str)
    return known or (isinstance(value, tuple) and not is_plain(value))


def mentions_object(node: ast.AST, scope: Scope) -> bool:
    """Whether an expression uses one of the suite's own."""
    return any(is_object(scope.known.get(name)) for name in loaded(node))


def asks_of(body: Sequence[ast.stmt], own: set[str], scope: Scope) -> bool:
    """Whether lines ask what is known by the names of a loop."""
    calls = (part for line in body for part in ast.walk(line) if isinstance(part, ast.Call | ast.DictComp))
    return any(own & loaded(part) and mentions_object(part, scope) for part in calls)


def names_in(target: Any) -> set[str]:
    """Give the names that a target sets."""
    return {own.id for own in ast.walk(target) if isinstance(own, ast.Name) and isinstance(own.ctx, ast.Store)}


def loaded(node: ast.AST) -> set[str]:
    """Give the names that an expression takes from outside."""
    every = list(ast.walk(node))
    inside = {name for own in every if isinstance(own, ast.comprehension) for name in names_in(own.target)}
    inside |= {name for own in every if isinstance(own, ast.Lambda) for name in arguments_of(own)}
    return {own.id for own in every if isinstance(own, ast.Name) and isinstance(own.ctx, ast.Load)} - inside


def assigned_in(lines: Sequence[ast.stmt]) -> set[str]:
    """Give the names that lines set, but for those of functions within."""
    found: set[str] = set()
    for line in lines:
        if isinstance(line, ast.FunctionDef):
            found.add(line.name)
        elif isinstance(line, ast.Import | ast.ImportFrom):
            found |= {own.asname or own.name for own in line.names}
        else:
            found |= names_in(line)
            within = (getattr(line, part, []) for part in ("body", "orelse"))
            found |= {name for part in within if isinstance(part, list) for name in assigned_in(part)}
    return found


def outer_names(lines: Sequence[ast.stmt]) -> set[str]:
    """Give the names of the function around that lines change."""
    return {name for line in lines if isinstance(line, ast.Nonlocal) for name in line.names}


def arguments_of(function: Any) -> set[str]:
    """Give the names of the arguments of a function."""
    return {own.arg for own in ast.walk(function.args) if isinstance(own, ast.arg)}


def given_arguments(target: Any, call: ast.Call, skip: int = 0) -> dict[str, ast.expr]:
    """Give the arguments of a call by their names, as far as they are written one by one."""
    names = list(inspect.signature(target).parameters)[skip:]
    starred = any(isinstance(own, ast.Starred) for own in call.args)
    given = {} if starred else dict(zip(names, call.args, strict=False))
    return {**given, **{own.arg: own.value for own in call.keywords if own.arg}}
