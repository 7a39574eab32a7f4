"""An adapter's own function as the lines of a script: what it does for one scene, with the scene's numbers in place.

A function that builds a scene is read as its source. What the scene and the preset decide is decided here: conditions,
loops over options, and what is computed of them; helpers of the adapter come along. What is left calls the engine alone.
"""

import ast
import builtins
import inspect
import math
import textwrap
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field, fields, is_dataclass, replace
from functools import cache
from types import FunctionType, GeneratorType, ModuleType
from typing import Any

import numpy as np

from multibody_xval.engines.interface.scene import Box, SceneSetting, SteppedWorld
from multibody_xval.reports.reproducers.tidy import script_text
from reference_lcp.errors import ParameterError

SUITE = "multibody_xval"

UNKNOWN = object()
"""Of an expression that only the engine gives."""

PURE = frozenset({
    "abs", "all", "any", "bool", "dict", "enumerate", "float", "int", "isinstance", "len", "list", "map", "max", "min",
    "range", "repr", "round", "str", "sum", "tuple", "zip",
})  # fmt: skip
"""Functions of Python that give the same whenever they are asked."""

Bound = Mapping[str, Any]


class NotWritable(ParameterError):
    """An adapter does what cannot be written as lines of a script."""


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


@dataclass
class Lines:
    """What a script needs of an adapter, one part after the other."""

    imports: dict[str, None] = field(default_factory=dict)
    constants: dict[str, ast.expr] = field(default_factory=dict)
    helpers: dict[Any, ast.stmt] = field(default_factory=dict)
    names: dict[Any, str] = field(default_factory=dict)
    body: list[ast.stmt] = field(default_factory=list)

    def add(self, build: Callable[..., Any], part: int, **bound: Any) -> None:
        """Add what a function does that gives a `SteppedWorld`, whose functions keep their names.

        Of a state, which is place, orientation and velocity, or the coordinates of joints, one `part` is left.
        """
        self.body += self._flat(build, bound)
        for line in self.body:
            if isinstance(line, ast.FunctionDef) and line.name == "state":
                assert isinstance(line.body[-1], ast.Return), "a state"
                line.body[-1].value = self._part_of(line.body[-1].value, part)
            elif isinstance(line, ast.Assign) and isinstance(line.value, ast.Lambda) and _names(line.targets[0]) == {"state"}:
                line.value.body = self._part_of(line.value.body, part)

    def _part_of(self, state: Any, part: int) -> ast.expr:
        """Give a part of a state: where it is written part by part, and where a helper is given the parts."""
        if isinstance(state, ast.Tuple) and len(state.elts) != 2:
            return state.elts[part]
        if isinstance(state, ast.Tuple):  # place and orientation are one array
            pose = f"({ast.unparse(state.elts[0])}){'[3:]' if part else '[:3]'}"
            return state.elts[1] if part == 2 else ast.parse(pose, mode="eval").body
        for own in self.helpers.values():
            if isinstance(own, ast.FunctionDef) and isinstance(state, ast.Call) and ast.unparse(state.func) == own.name:
                value = own.body[-1].value.elts[part]  # type: ignore[attr-defined]
                given = {name.arg: value for name, value in zip(own.args.args, state.args)}
                if _loaded(value) <= set(given):
                    return _Given(given).visit(value)  # type: ignore[no-any-return]
        return ast.Subscript(state, ast.Constant(part), ast.Load())

    def _flat(self, build: Any, bound: Bound) -> list[ast.stmt]:
        if not isinstance(build, FunctionType):
            raise NotWritable(f"scene = {build} is a class; allowed: a function that gives a SteppedWorld")
        tree, scope = _tree(build), _scope(build, bound)
        *lines, last = self._block(tree.body, scope, keep_return=True)
        assert isinstance(last, ast.Return), f"{build} gives nothing"
        return [*map(_global, lines), *self._given(last.value, scope)]

    def _given(self, value: Any, scope: Scope) -> list[ast.stmt]:
        """Give the functions of a world names."""
        if isinstance(value, ast.IfExp):
            return self._given(value.body if self._value(value.test, scope) else value.orelse, scope)
        target = scope.module.get(value.func.id) if isinstance(value, ast.Call) else None
        if target is SteppedWorld:
            names = [own.name for own in fields(SteppedWorld)]
            given = {**dict(zip(names, value.args)), **{own.arg: own.value for own in value.keywords}}
            return [
                ast.Assign([ast.Name(name, ast.Store())], self._expression(own, scope))
                for name, own in given.items()
                if not (isinstance(own, ast.Name) and own.id == name)
            ]
        if not isinstance(target, FunctionType):
            raise NotWritable(f"scene = {ast.unparse(value)} is no world of functions; allowed: SteppedWorld(...)")
        return self._flat(target, {name: self._value(own, scope) for name, own in _arguments(target, value).items()})

    def text(self, first: str, frame: str) -> str:
        """Write the first line, and all that a frame, which follows, uses by its names."""
        constants: list[ast.stmt] = [ast.Assign([ast.Name(name, ast.Store())], value) for name, value in self.constants.items()]
        lines = [*constants, *self.helpers.values(), *self.body]
        return script_text(list(self.imports), first, lines, frame)

    # Statements

    def _block(self, lines: Sequence[ast.stmt], scope: Scope, *, keep_return: bool = False) -> list[ast.stmt]:
        written: list[ast.stmt] = []
        for line in lines:
            if keep_return and isinstance(line, ast.Return):
                return [*written, line]
            written += self._line(line, scope)
            if written and isinstance(written[-1], ast.Return):
                break
        return written

    def _line(self, line: Any, scope: Scope) -> list[ast.stmt]:
        match line:
            case ast.Expr(value=ast.Constant()) | ast.Assert() | ast.Raise():
                return []  # what is refused is refused before
            case ast.Import() | ast.ImportFrom():
                self.imports[ast.unparse(line)] = None
                scope.forget(own.asname or own.name.partition(".")[0] for own in line.names)
                return []
            case ast.AnnAssign(value=None):
                return []
            case ast.AnnAssign():
                return self._assigned(line.target, line.value, scope)
            case ast.Assign():
                return self._assigned(line.targets[0], line.value, scope, line.targets[1:])
            case ast.If():
                return self._if(line, scope)
            case ast.For():
                return self._loop(line, scope)
            case ast.FunctionDef():
                scope.forget([line.name])
                own = scope.inner(_arguments_of(line) | _assigned_in(line.body) - _outer(line.body))
                return [_function(line.name, line.args, self._block(line.body, own) or [ast.Pass()], self, own)]
            case ast.Expr():
                return self._call_alone(line.value, scope)
            case ast.With():
                for item in line.items:
                    scope.forget(_names(item.optional_vars) if item.optional_vars else ())
                items = [ast.withitem(self._expression(own.context_expr, scope), own.optional_vars) for own in line.items]
                return [ast.With(items, self._block(line.body, scope))]
        return [self._parts(line, scope)]

    def _assigned(self, target: Any, value: Any, scope: Scope, more: Sequence[Any] = ()) -> list[ast.stmt]:
        if isinstance(value, ast.IfExp):
            test = self._value(value.test, scope)
            if test is not UNKNOWN:
                return self._assigned(target, value.body if test else value.orelse, scope, more)
        pairs = isinstance(target, ast.Tuple) and isinstance(value, ast.Tuple) and not more
        if pairs and len(target.elts) == len(value.elts) and not _names(target) & _loaded(value):
            each = zip(target.elts, value.elts, strict=True)
            return [line for own, part in each for line in self._assigned(own, part, scope)]
        if isinstance(target, ast.Attribute) and isinstance(value, ast.Name) and _is_object(scope.known.get(value.id)):
            return []  # of a class that keeps what is known here
        found = self._value(value, scope)
        written = self._expression(value, scope) if found is UNKNOWN or _is_plain(found) else None
        for own in (target, *more):
            if isinstance(own, ast.Name):
                scope.learn(own.id, found if _is_plain(found) or _is_object(found) else UNKNOWN)
            elif isinstance(own, ast.Tuple) and isinstance(found, tuple) and len(found) == len(own.elts):
                for name, part in zip(own.elts, found, strict=True):
                    scope.learn(name.id, part)  # type: ignore[attr-defined]
            else:
                scope.forget(_names(own))
        if written is None and not _is_object(found):
            scope.forget(_names(target))
            written = self._expression(value, scope)
        if written is None or (isinstance(target, ast.Name) and isinstance(written, ast.Name) and written.id == target.id):
            return []
        return [ast.Assign([self._parts(own, scope) for own in (target, *more)], written)]

    def _if(self, line: ast.If, scope: Scope) -> list[ast.stmt]:
        test = self._value(line.test, scope)
        if test is not UNKNOWN:
            return self._block(line.body if test else line.orelse, scope)
        condition = self._expression(line.test, scope)
        both = [self._block(branch, scope.inner(())) for branch in (line.body, line.orelse)]
        scope.forget(_assigned_in([line]))
        return [ast.If(condition, both[0] or [ast.Pass()], both[1])] if any(both) else []

    def _loop(self, line: ast.For, scope: Scope) -> list[ast.stmt]:
        over, own = self._value(line.iter, scope), _names(line.target)
        if isinstance(over, tuple | list) and _asks_of(line.body, own, scope):
            written = []
            for value in over:
                scope.learn(line.target.id, value)  # type: ignore[attr-defined]
                written += self._block(line.body, replace(scope, literal=scope.literal | own))
            return written
        scope.forget(_assigned_in([line]) | own)
        over, body = self._expression(line.iter, scope), self._block(line.body, scope)
        return [ast.For(line.target, over, body, [])] if body else []

    def _call_alone(self, call: Any, scope: Scope) -> list[ast.stmt]:
        if self._value(call, scope) is not UNKNOWN:
            return []
        written = self._expression(call, scope)
        match written:
            case ast.Call(func=ast.Name(id="setattr"), args=[of, ast.Constant(value=name), value]):
                return [ast.Assign([ast.Attribute(of, name, ast.Store())], value)]
        return [ast.Expr(written)]

    # Expressions

    def _value(self, node: Any, scope: Scope) -> Any:
        """Give the value of an expression, as far as scene and preset alone give it."""
        space: dict[str, Any] = {}
        for name in _loaded(node):
            if name in scope.unknown:
                return UNKNOWN
            found = scope.known[name] if name in scope.known else _of_module(name, scope)
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

    def _expression(self, node: Any, scope: Scope) -> Any:
        """Write an expression with what is known in place."""
        if _mentions_object(node, scope):
            if isinstance(node, ast.Attribute) and node.attr == "time_step":
                return ast.Name("TIME_STEP", ast.Load())
            found = self._value(node, scope)
            if found is not UNKNOWN and _is_plain(found):
                return self._literal(found)
        match node:
            case ast.IfExp():
                test = self._value(node.test, scope)
                if test is not UNKNOWN:
                    return self._expression(node.body if test else node.orelse, scope)
            case ast.BoolOp():
                idle = isinstance(node.op, ast.And)  # what changes nothing
                rest = [own for own in node.values if (found := self._value(own, scope)) is UNKNOWN or bool(found) != idle]
                if len(rest) == 1:
                    return self._expression(rest[0], scope)
            case ast.DictComp() if _is_plain(found := self._value(node, scope)):
                return self._literal(found)
            case ast.Name(ctx=ast.Load()):
                return self._name(node, scope)
            case ast.Lambda():
                return self._parts(node, scope.inner(_arguments_of(node)))
            case ast.ListComp() | ast.GeneratorExp() | ast.DictComp() | ast.SetComp():
                return self._parts(node, scope.inner(name for own in node.generators for name in _names(own.target)))
            case ast.Call():
                return self._call(node, scope)
        return self._parts(node, scope)

    def _parts(self, node: Any, scope: Scope) -> Any:
        written = {}
        for name, value in ast.iter_fields(node):
            if isinstance(value, list):
                written[name] = [self._part(own, scope) for own in value]
            else:
                written[name] = self._part(value, scope)
        return type(node)(**written)

    def _part(self, value: Any, scope: Scope) -> Any:
        if isinstance(value, ast.expr):
            return self._expression(value, scope)
        return self._parts(value, scope) if isinstance(value, ast.keyword | ast.comprehension) else value

    def _name(self, node: ast.Name, scope: Scope) -> ast.expr:
        if node.id in scope.unknown:
            return node
        if node.id in scope.known:
            if not _is_plain(scope.known[node.id]):
                raise NotWritable(f"{node.id} is a part of the suite; allowed in a script: what the engine is given")
            return self._literal(scope.known[node.id]) if node.id in scope.literal else node
        if node.id not in scope.module:
            return node
        found = scope.module[node.id]
        if isinstance(found, ModuleType):
            named = found.__name__ if found.__name__ == node.id else f"{found.__name__} as {node.id}"
            self.imports[f"import {named}"] = None
        elif _is_plain(found):
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
            args = [self._expression(own, scope) for own in node.args]
            return ast.Call(self._expression(node.func, scope), args, self._keywords(node.keywords, scope))
        given = _arguments(target, node, skip=len(first))
        bound = {name: value for name, own in given.items() if _is_object(value := self._value(own, scope))}
        left = {id(own) for name, own in given.items() if name in bound}
        func = ast.Name(self._helper(target, {**first, **bound}), ast.Load())
        args = [self._expression(own, scope) for own in node.args if id(own) not in left]
        return ast.Call(func, args, self._keywords([own for own in node.keywords if id(own.value) not in left], scope))

    def _keywords(self, keywords: Sequence[ast.keyword], scope: Scope) -> list[ast.keyword]:
        written = []
        for own in keywords:
            value = self._expression(own.value, scope)
            if own.arg is None and isinstance(value, ast.Dict) and all(isinstance(key, ast.Constant) for key in value.keys):
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
        if isinstance(func, ast.Attribute) and _is_object(of := self._value(func.value, scope)):
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
        tree, scope = _tree(target), _scope(target, bound)
        return _function(name, _without(tree.args, bound), self._block(tree.body, scope) or [ast.Pass()], self, scope)

    def _class(self, target: type, bound: dict[str, Any], name: str) -> ast.stmt:
        """Write a class whose instances keep what is known: ``self.setting`` is read as what it stands for."""
        methods = [own for own in _tree(target).body if isinstance(own, ast.FunctionDef)]
        kept = {own: value for method in methods for own, value in _kept(method, bound)}
        body: list[ast.stmt] = []
        for method in methods:
            given = bound if method.name == "__init__" else {}
            method = _Kept(kept).visit(method)
            scope = _scope(getattr(target, method.name), given)
            scope.known |= {f"self.{own}": value for own, value in kept.items()}
            lines = self._block(method.body, scope) or [ast.Pass()]
            body.append(_function(method.name, _without(method.args, given), lines, self, scope))
        return ast.ClassDef(name, [], [], body, [])

    def _literal(self, value: Any) -> ast.expr:
        """Write a value; boxes as named tuples."""
        if isinstance(value, Box):
            self.imports["from collections import namedtuple"] = None
            self.constants["Box"] = ast.parse("namedtuple('Box', 'mass side')", mode="eval").body
            return ast.parse(f"Box({value.mass!r}, {value.side!r})", mode="eval").body
        if isinstance(value, list | tuple):
            return (ast.List if isinstance(value, list) else ast.Tuple)([self._literal(own) for own in value], ast.Load())
        if isinstance(value, np.generic):
            value = value.item()
        if isinstance(value, float) and not math.isfinite(value):
            self.imports["import math"] = None
            return ast.parse(f"math.{value}" if value > 0 else "-math.inf", mode="eval").body
        return ast.parse(repr(value), mode="eval").body


def _function(name: str, args: ast.arguments, body: list[ast.stmt], lines: Lines, scope: Scope) -> ast.FunctionDef:
    """Give a function without annotations."""
    every = [*args.posonlyargs, *args.args, *args.kwonlyargs, args.vararg, args.kwarg]
    for own in every:
        if own is not None:
            own.annotation = None
    args.defaults = [lines._expression(own, scope) for own in args.defaults]
    args.kw_defaults = [own and lines._expression(own, scope) for own in args.kw_defaults]
    return ast.FunctionDef(name, args, body, [])


class _Given(ast.NodeTransformer):
    """Writes arguments in the place of their names."""

    def __init__(self, given: Mapping[str, ast.expr]):
        self._given = given

    def visit_Name(self, node: ast.Name) -> ast.AST:
        return self._given.get(node.id, node)


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
            for own, part in zip(target.elts, value.elts) if together else [(target, value)]:  # type: ignore[attr-defined]
                if isinstance(own, ast.Attribute) and isinstance(part, ast.Name) and part.id in bound:
                    yield own.attr, bound[part.id]


@cache
def _source(of: Any) -> str:
    return textwrap.dedent(inspect.getsource(of))


def _tree(of: Any) -> Any:
    return ast.parse(_source(of)).body[0]


def _scope(of: Any, bound: Bound) -> Scope:
    tree = _tree(of)
    names = _arguments_of(tree) | _assigned_in(tree.body)
    shared = frozenset(name for line in ast.walk(tree) if isinstance(line, ast.Nonlocal) for name in line.names)
    return Scope(of.__globals__, dict(bound), names - set(bound), shared)


def _of_module(name: str, scope: Scope) -> Any:
    """Give what a name of an adapter's module stands for, if it gives the same whenever it is asked."""
    if name not in scope.module:
        return getattr(builtins, name) if name in PURE else UNKNOWN
    found = scope.module[name]
    if isinstance(found, FunctionType):
        return found if _is_pure(found) else UNKNOWN
    kinds = isinstance(found, type) and (is_dataclass(found) or found.__module__ == "builtins")
    return found if _is_plain(found) or kinds or found in (np, math) else UNKNOWN


@cache
def _is_pure(function: FunctionType) -> bool:
    """Whether a function of the suite uses no engine."""
    if not function.__module__.startswith(SUITE) or "import" in _source(function):
        return False
    called = (function.__globals__.get(name) for name in function.__code__.co_names)
    return all(own is function or _is_pure(own) for own in called if isinstance(own, FunctionType))


def _is_plain(value: Any) -> bool:
    """Whether a value can be written into a script."""
    if isinstance(value, tuple | list):
        return all(map(_is_plain, value))
    if isinstance(value, dict):
        return all(map(_is_plain, [*value, *value.values()]))
    return value is None or isinstance(value, bool | int | float | str | Box | np.number)


def _is_object(value: Any) -> bool:
    """Whether a value is one of the suite's own, which a script does without."""
    known = type(value).__module__.partition(".")[0] == SUITE and not isinstance(value, Box | str)
    return known or (isinstance(value, tuple) and not _is_plain(value))


def _mentions_object(node: ast.AST, scope: Scope) -> bool:
    return any(_is_object(scope.known.get(name)) for name in _loaded(node))


def _asks_of(body: Sequence[ast.stmt], own: set[str], scope: Scope) -> bool:
    """Whether lines ask what is known by the names of a loop."""
    calls = (part for line in body for part in ast.walk(line) if isinstance(part, ast.Call | ast.DictComp))
    return any(own & _loaded(part) and _mentions_object(part, scope) for part in calls)


def _names(target: Any) -> set[str]:
    return {own.id for own in ast.walk(target) if isinstance(own, ast.Name) and isinstance(own.ctx, ast.Store)}


def _loaded(node: ast.AST) -> set[str]:
    """Give the names that an expression takes from outside."""
    every = list(ast.walk(node))
    inside = {name for own in every if isinstance(own, ast.comprehension) for name in _names(own.target)}
    inside |= {name for own in every if isinstance(own, ast.Lambda) for name in _arguments_of(own)}
    return {own.id for own in every if isinstance(own, ast.Name) and isinstance(own.ctx, ast.Load)} - inside


def _assigned_in(lines: Sequence[ast.stmt]) -> set[str]:
    """Give the names that lines set, but for those of functions within."""
    found: set[str] = set()
    for line in lines:
        if isinstance(line, ast.FunctionDef):
            found.add(line.name)
        elif isinstance(line, ast.Import | ast.ImportFrom):
            found |= {own.asname or own.name for own in line.names}
        else:
            found |= _names(line)
            within = (getattr(line, part, []) for part in ("body", "orelse"))
            found |= {name for part in within if isinstance(part, list) for name in _assigned_in(part)}
    return found


def _outer(lines: Sequence[ast.stmt]) -> set[str]:
    return {name for line in lines if isinstance(line, ast.Nonlocal) for name in line.names}


def _arguments_of(function: Any) -> set[str]:
    return {own.arg for own in ast.walk(function.args) if isinstance(own, ast.arg)}


def _arguments(target: Any, call: ast.Call, skip: int = 0) -> dict[str, ast.expr]:
    """Give the arguments of a call by their names, as far as they are written one by one."""
    names = list(inspect.signature(target).parameters)[skip:]
    given = dict(zip(names, call.args)) if not any(isinstance(own, ast.Starred) for own in call.args) else {}
    return {**given, **{own.arg: own.value for own in call.keywords if own.arg}}


def _without(args: ast.arguments, bound: Bound) -> ast.arguments:
    """Leave out arguments that are known; those with defaults are never among them."""
    args.args = [own for own in args.args if own.arg not in bound]
    return args


def _global(line: ast.stmt) -> ast.stmt:
    """Give a function of a script, whose names outside are those of the script."""
    if isinstance(line, ast.FunctionDef):
        line.body = [ast.Global(own.names) if isinstance(own, ast.Nonlocal) else own for own in line.body]
    return line
