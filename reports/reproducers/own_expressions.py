"""Expressions of an adapter's source as a script has them: what scene and preset give stands in place."""

import ast
import math
from abc import ABC, abstractmethod
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from types import FunctionType, GeneratorType, ModuleType
from typing import Any

import numpy as np

from multibody_xval.engines.interface.scene import Box
from multibody_xval.reports.reproducers.known_names import (
    SUITE,
    UNKNOWN,
    Bound,
    Scope,
    arguments_of,
    given_arguments,
    is_object,
    is_plain,
    loaded,
    mentions_object,
    names_in,
    of_module,
    scope_of,
    tree_of,
)
from reference_lcp.errors import ParameterError


class NotWritable(ParameterError):
    """An adapter does what cannot be written as lines of a script."""


@dataclass
class Expressions(ABC):
    """What a script needs of an adapter beside its lines: imports, constants, helpers."""

    imports: dict[str, None] = field(default_factory=dict)
    constants: dict[str, ast.expr] = field(default_factory=dict)
    helpers: dict[Any, ast.stmt] = field(default_factory=dict)
    names: dict[Any, str] = field(default_factory=dict)

    @abstractmethod
    def block(self, lines: Sequence[ast.stmt], scope: Scope) -> list[ast.stmt]:
        """Write lines."""

    def value(self, node: Any, scope: Scope) -> Any:
        """Give the value of an expression, as far as scene and preset alone give it."""
        space: dict[str, Any] = {}
        for name in loaded(node):
            if name in scope.unknown:
                return UNKNOWN
            found = scope.known[name] if name in scope.known else of_module(name, scope)
            if found is UNKNOWN:
                return UNKNOWN
            space[name] = found
        try:
            found = eval(compile(ast.Expression(ast.fix_missing_locations(node)), "<scene>", "eval"), space)
            return tuple(found) if isinstance(found, GeneratorType) else found
        except ParameterError:
            raise
        except Exception:
            return UNKNOWN

    def expression(self, node: Any, scope: Scope) -> Any:  # noqa: PLR0911 (a kind of expression each)
        """Write an expression with what is known in place."""
        if mentions_object(node, scope):
            if isinstance(node, ast.Attribute) and node.attr == "time_step":
                return ast.Name("TIME_STEP", ast.Load())
            found = self.value(node, scope)
            if found is not UNKNOWN and is_plain(found):
                return self._literal(found)
        match node:
            case ast.IfExp():
                test = self.value(node.test, scope)
                if test is not UNKNOWN:
                    return self.expression(node.body if test else node.orelse, scope)
            case ast.BoolOp():
                idle = isinstance(node.op, ast.And)  # what changes nothing
                rest = [
                    own for own in node.values if (found := self.value(own, scope)) is UNKNOWN or bool(found) != idle
                ]
                if len(rest) == 1:
                    return self.expression(rest[0], scope)
            case ast.DictComp() if is_plain(found := self.value(node, scope)):
                return self._literal(found)
            case ast.Name(ctx=ast.Load()):
                return self._name(node, scope)
            case ast.Lambda():
                return self.parts(node, scope.inner(arguments_of(node)))
            case ast.ListComp() | ast.GeneratorExp() | ast.DictComp() | ast.SetComp():
                return self.parts(node, scope.inner(name for own in node.generators for name in names_in(own.target)))
            case ast.Call():
                return self._call(node, scope)
        return self.parts(node, scope)

    def parts(self, node: Any, scope: Scope) -> Any:
        """Write the parts of a line or an expression."""
        written = {}
        for name, value in ast.iter_fields(node):
            if isinstance(value, list):
                written[name] = [self._part(own, scope) for own in value]
            else:
                written[name] = self._part(value, scope)
        return type(node)(**written)

    def _part(self, value: Any, scope: Scope) -> Any:
        if isinstance(value, ast.expr):
            return self.expression(value, scope)
        return self.parts(value, scope) if isinstance(value, ast.keyword | ast.comprehension) else value

    def _name(self, node: ast.Name, scope: Scope) -> ast.expr:
        if node.id in scope.unknown:
            return node
        if node.id in scope.known:
            if not is_plain(scope.known[node.id]):
                raise NotWritable(f"{node.id} is a part of the suite; allowed in a script: what the engine is given")
            return self._literal(scope.known[node.id]) if node.id in scope.literal else node
        if node.id not in scope.module:
            return node
        found = scope.module[node.id]
        if isinstance(found, ModuleType):
            named = found.__name__ if found.__name__ == node.id else f"{found.__name__} as {node.id}"
            self.imports[f"import {named}"] = None
        elif is_plain(found):
            self.constants[node.id] = self._literal(found)
        elif found.__module__.partition(".")[0] == SUITE:
            return ast.Name(self._helper(found, {}), ast.Load())
        else:
            self.imports[f"from {found.__module__} import {node.id}"] = None
        return node

    def _call(self, node: ast.Call, scope: Scope) -> ast.expr:
        if isinstance(node.func, ast.Name) and node.func.id.startswith("import_"):
            name = node.func.id.removeprefix("import_")
            self.imports[f"import {name}"] = None
            return ast.Name(name, ast.Load())
        target, first = self._called(node.func, scope)
        if target is None:
            args = [self.expression(own, scope) for own in node.args]
            return ast.Call(self.expression(node.func, scope), args, self._keywords(node.keywords, scope))
        given = given_arguments(target, node, skip=len(first))
        bound = {name: value for name, own in given.items() if is_object(value := self.value(own, scope))}
        left = {id(own) for name, own in given.items() if name in bound}
        func = ast.Name(self._helper(target, {**first, **bound}), ast.Load())
        args = [self.expression(own, scope) for own in node.args if id(own) not in left]
        return ast.Call(func, args, self._keywords([own for own in node.keywords if id(own.value) not in left], scope))

    def _keywords(self, keywords: Sequence[ast.keyword], scope: Scope) -> list[ast.keyword]:
        written = []
        for own in keywords:
            value = self.expression(own.value, scope)
            if (
                own.arg is None
                and isinstance(value, ast.Dict)
                and all(isinstance(key, ast.Constant) for key in value.keys)
            ):
                pairs = zip(value.keys, value.values, strict=True)
                written += [ast.keyword(key.value, part) for key, part in pairs]  # type: ignore[union-attr]
            else:
                written.append(ast.keyword(own.arg, value))
        return written

    def _called(self, func: ast.expr, scope: Scope) -> tuple[Any, dict[str, Any]]:
        """Give the function or the class of the suite that is called, and what it is a method of."""
        if isinstance(func, ast.Name) and func.id not in {*scope.unknown, *scope.known}:
            found = scope.module.get(func.id)
            own = isinstance(found, FunctionType | type) and found.__module__.partition(".")[0] == SUITE
            return (found, {}) if own else (None, {})
        if isinstance(func, ast.Attribute) and is_object(of := self.value(func.value, scope)):
            return getattr(type(of), func.attr), {"self": of}
        return None, {}

    def _helper(self, target: Any, bound: dict[str, Any]) -> str:
        """Give the name of a helper, which is written once for all that has the same known arguments."""
        key = target, tuple((name, id(value)) for name, value in sorted(bound.items()))
        if key not in self.names:
            name = target.__name__
            self.names[key] = name + "2" * (name in self.names.values())
            write = self._class if isinstance(target, type) else self._function
            self.helpers[key] = write(target, bound, self.names[key])
        return self.names[key]

    def _function(self, target: Any, bound: dict[str, Any], name: str) -> ast.stmt:
        tree, scope = tree_of(target), scope_of(target, bound)
        return function_of(name, _without(tree.args, bound), self.block(tree.body, scope) or [ast.Pass()], self, scope)

    def _class(self, target: type, bound: dict[str, Any], name: str) -> ast.stmt:
        """Write a class whose instances keep what is known: ``self.setting`` is read as what it stands for."""
        methods = [own for own in tree_of(target).body if isinstance(own, ast.FunctionDef)]
        kept = {own: value for method in methods for own, value in _kept(method, bound)}
        body: list[ast.stmt] = []
        for method in methods:
            given = bound if method.name == "__init__" else {}
            own = _Kept(kept).visit(method)
            scope = scope_of(getattr(target, own.name), given)
            scope.known |= {f"self.{name}": value for name, value in kept.items()}
            lines = self.block(own.body, scope) or [ast.Pass()]
            body.append(function_of(own.name, _without(own.args, given), lines, self, scope))
        return ast.ClassDef(name, [], [], body, [])

    def _literal(self, value: Any) -> ast.expr:
        """Write a value; boxes as named tuples."""
        if isinstance(value, Box):
            self.imports["from collections import namedtuple"] = None
            self.constants["Box"] = ast.parse("namedtuple('Box', 'mass side')", mode="eval").body
            return ast.parse(f"Box({value.mass!r}, {value.side!r})", mode="eval").body
        if isinstance(value, list | tuple):
            return (ast.List if isinstance(value, list) else ast.Tuple)(
                [self._literal(own) for own in value], ast.Load()
            )
        if isinstance(value, np.generic):
            value = value.item()
        if isinstance(value, float) and not math.isfinite(value):
            self.imports["import math"] = None
            return ast.parse(f"math.{value}" if value > 0 else "-math.inf", mode="eval").body
        return ast.parse(repr(value), mode="eval").body


class _Kept(ast.NodeTransformer):
    """Reads attributes of an instance that are known as names of their own."""

    def __init__(self, kept: Mapping[str, Any]):
        self._kept = kept

    def visit_Attribute(self, node: ast.Attribute) -> ast.AST:
        of = node.value
        if isinstance(of, ast.Name) and of.id == "self" and node.attr in self._kept and isinstance(node.ctx, ast.Load):
            return ast.Name(f"self.{node.attr}", ast.Load())
        return self.generic_visit(node)


def _kept(method: ast.FunctionDef, bound: Bound) -> Iterable[tuple[str, Any]]:
    """Give what an instance keeps of what is known: ``self.name = argument``."""
    for line in ast.walk(method):
        if method.name == "__init__" and isinstance(line, ast.Assign):
            target, value = line.targets[0], line.value
            together = isinstance(target, ast.Tuple) and isinstance(value, ast.Tuple)
            for own, part in zip(target.elts, value.elts, strict=True) if together else [(target, value)]:  # type: ignore[attr-defined]
                if isinstance(own, ast.Attribute) and isinstance(part, ast.Name) and part.id in bound:
                    yield own.attr, bound[part.id]


def _without(args: ast.arguments, bound: Bound) -> ast.arguments:
    """Leave out arguments that are known; those with defaults are never among them."""
    args.args = [own for own in args.args if own.arg not in bound]
    return args


def function_of(
    name: str, args: ast.arguments, body: list[ast.stmt], lines: Expressions, scope: Scope
) -> ast.FunctionDef:
    """Give a function without annotations."""
    every = [*args.posonlyargs, *args.args, *args.kwonlyargs, args.vararg, args.kwarg]
    for own in every:
        if own is not None:
            own.annotation = None
    args.defaults = [lines.expression(own, scope) for own in args.defaults]
    args.kw_defaults = [own and lines.expression(own, scope) for own in args.kw_defaults]
    return ast.FunctionDef(name, args, body, [])
