"""What an adapter's function knows before it runs: its scene and its setting, and what follows from them."""

import ast
import builtins
import inspect
import textwrap
from collections.abc import Iterable, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass, field
from functools import cache
from types import FunctionType
from typing import Any

import numpy as np

from reference_lcp.errors import ParameterError

SUITE = "multibody_xval"

UNKNOWN = object()
"""Of an expression that only the engine gives."""


@dataclass
class Scope:
    """Names of a function: every local one, and the values of those that are known."""

    module: Mapping[str, Any]
    local: set[str]
    known: dict[str, Any]
    changing: set[str] = field(default_factory=set)
    """Names that functions within set, which are never known."""

    def value(self, node: Any) -> Any:
        """Give the value of an expression, as far as scene and setting give it."""
        space = {name: self._value_of(name) for name in _read(node)}
        if any(value is UNKNOWN for value in space.values()):
            return UNKNOWN
        try:
            return eval(compile(ast.Expression(node), "<scene>", "eval"), space)
        except ParameterError:
            raise
        except Exception:
            return UNKNOWN

    def _value_of(self, name: str) -> Any:
        if name in self.local:
            return self.known.get(name, UNKNOWN)
        found = self.module.get(name, getattr(builtins, name, UNKNOWN))
        return UNKNOWN if isinstance(found, FunctionType) and "import" in source(found) else found

    def asks(self, node: ast.AST) -> bool:
        """Whether an expression asks the scene or the setting, and not only names that have their values."""
        return any(not is_plain(self.known[name]) for name in _read(node) & set(self.known))

    def learn(self, name: str, value: Any) -> None:
        """Note what a name stands for from now on."""
        lasting = is_plain(value) and not isinstance(value, list)
        if (lasting or is_object(value)) and name not in self.changing:
            self.known[name] = value
        else:
            self.known.pop(name, None)

    def forget(self, names: Iterable[str]) -> None:
        """Leave it to the script what names stand for."""
        for name in names:
            self.known.pop(name, None)

    @contextmanager
    def within(self, names: Iterable[str]) -> Iterator[None]:
        """Look into what has such names of its own; what is learnt there is forgotten after."""
        known, local = self.known, self.local
        self.known, self.local = {name: known[name] for name in known if name not in set(names)}, local | set(names)
        yield
        self.known, self.local = known, local


def scope_of(function: FunctionType, known: Mapping[str, Any]) -> Scope:
    """Give the scope of a function, some of whose arguments are known."""
    lines = tree_of(function)
    inner = {name for line in ast.walk(lines) if isinstance(line, ast.Nonlocal) for name in line.names}
    return Scope(function.__globals__, names_set(lines), dict(known), inner)


@cache
def source(function: Any) -> str:
    """Give the text of a function."""
    return textwrap.dedent(inspect.getsource(function))


def tree_of(function: Any) -> Any:
    """Parse it; every tree is a new one, for lines are changed in place."""
    return ast.parse(source(function)).body[0]


def is_plain(value: Any) -> bool:
    """Whether a value can be written into a script."""
    if isinstance(value, tuple | list):
        return all(map(is_plain, value))
    if isinstance(value, dict):
        return all(map(is_plain, [*value, *value.values()]))
    return value is None or isinstance(value, bool | int | float | str | np.number)


def is_object(value: Any) -> bool:
    """Whether a value is one of the suite's own, which a script does without: a scene, a setting, a preset."""
    return type(value).__module__.startswith(SUITE) and not is_plain(value)


def names_set(*nodes: ast.AST) -> set[str]:
    """Give all names that lines or expressions set, arguments among them."""
    every = [node for own in nodes for node in ast.walk(own)]
    names = {node.id for node in every if isinstance(node, ast.Name) and isinstance(node.ctx, ast.Store)}
    names |= {node.arg for node in every if isinstance(node, ast.arg)}
    names |= {node.name for node in every if isinstance(node, ast.FunctionDef)}
    return names | {node.asname or node.name for node in every if isinstance(node, ast.alias)}


def _read(node: ast.AST) -> set[str]:
    """Give the names that an expression takes from outside."""
    every = {own.id for own in ast.walk(node) if isinstance(own, ast.Name) and isinstance(own.ctx, ast.Load)}
    return every - names_set(node)
