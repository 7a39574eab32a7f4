"""An adapter's function that builds scenes, as the lines of a script for one scene and one preset.

It is read as its source, in which scene and setting are known. What asks them is replaced by its value; names and all
other expressions stay as they are written. Of a condition that is known, the branch that is not taken goes. A function
of the suite that is called comes along as a helper, without the arguments that are scene or setting; imports and
constants come along too. The function must end in ``SteppedWorld(...)``, whose functions get its names: ``step``,
``state`` and so on, or in ``SolvedWorld(...)``; one of a server ends in ``SimpleNamespace(...)``.
"""

import ast
import inspect
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, fields
from types import FunctionType, ModuleType, SimpleNamespace
from typing import Any

import numpy as np

from multibody_xval.engines.interface.scene import SolvedWorld, SteppedWorld
from multibody_xval.reports.reproducers.known import (
    SUITE,
    UNKNOWN,
    Scope,
    is_object,
    is_plain,
    names_set,
    scope_of,
    tree_of,
)
from reference_lcp.errors import ParameterError

LONG_TEXT = 100
"""Characters from which on a text is a constant of its own: a model in XML."""


class NotWritable(ParameterError):
    """An adapter does what cannot be written as lines of a script."""


@dataclass
class Lines:
    """Lines of a script, and what they need."""

    world: list[ast.stmt] = field(default_factory=list)
    imports: set[str] = field(default_factory=set)
    switches: set[str] = field(default_factory=set)
    """What is set of `sys` before an engine is imported."""
    starts: set[str] = field(default_factory=set)
    """What is set of an engine once it is imported."""
    constants: dict[str, ast.expr] = field(default_factory=dict)
    models: dict[str, str] = field(default_factory=dict)
    """Names of long texts."""
    helpers: dict[Any, ast.FunctionDef] = field(default_factory=dict)


def specialised(build: Any, known: Mapping[str, Any]) -> Lines:
    """Write a function that gives a `SteppedWorld`, of which some arguments are known."""
    writer = _Specialiser()
    writer.lines.world = writer.world(build, known)
    return writer.lines


class _Specialiser(ast.NodeTransformer):
    """Writes lines of an adapter, and collects what they need."""

    scope: Scope

    def __init__(self) -> None:
        self.lines = Lines()

    def world(self, build: Any, known: Mapping[str, Any]) -> list[ast.stmt]:
        if not isinstance(build, FunctionType):
            raise NotWritable(f"scene = {build} is a class; allowed: a function that gives a SteppedWorld")
        self.scope = scope_of(build, known)
        *lines, last = tree_of(build).body
        return [*map(_with_globals, self.block(lines)), *self._functions(last.value)]

    def _functions(self, value: Any) -> list[ast.stmt]:
        """Give the functions of a world its names."""
        if isinstance(value, ast.IfExp):
            return self._functions(value.body if self.scope.value(value.test) else value.orelse)
        target = self.scope.module.get(ast.unparse(value.func))
        if target in (SteppedWorld, SolvedWorld, SimpleNamespace):
            names = [own.name for own in fields(SolvedWorld if target is SolvedWorld else SteppedWorld)]
            given = {**dict(zip(names, value.args, strict=False)), **{own.arg: own.value for own in value.keywords}}
            return [_assigned(name, self.visit(own)) for name, own in given.items() if ast.unparse(own) != name]
        if not isinstance(target, FunctionType):
            raise NotWritable(f"scene = {ast.unparse(value)} is no world of functions; allowed: SteppedWorld(...)")
        return self.world(target, {name: self.scope.value(own) for name, own in _given(target, value).items()})

    def block(self, lines: Sequence[ast.stmt]) -> list[ast.stmt]:
        """Write lines, up to the first that returns."""
        written: list[ast.stmt] = []
        for line in lines:
            own = self.visit(line)
            written += own if isinstance(own, list) else [own] * (own is not None)
            if written and isinstance(written[-1], ast.Return):
                break
        return written

    def visit(self, node: ast.AST) -> Any:
        """Write a line or an expression; one that asks scene or setting is replaced by its value."""
        if isinstance(node, ast.expr) and self.scope.asks(node):
            if _is_time_step(node):
                return ast.Name("TIME_STEP", ast.Load())
            if is_plain(value := self.scope.value(node)):
                return self._literal(value)
        return super().visit(node)

    def visit_Assign(self, node: ast.Assign) -> Any:
        target, value = node.targets[0], node.value
        if isinstance(value, ast.IfExp) and (test := self.scope.value(value.test)) is not UNKNOWN:
            return self.visit_Assign(ast.Assign(node.targets, value.body if test else value.orelse))
        if isinstance(target, ast.Tuple) and isinstance(value, ast.Tuple):
            pairs = zip(target.elts, value.elts, strict=True)
            return self.block([ast.copy_location(ast.Assign([own], part), node) for own, part in pairs])
        found = self.scope.value(value)
        written = None if is_object(found) else self.visit(value)
        for own, part in _pairs(target, found):
            self.scope.learn(own, part)
        if written is None or ast.unparse(written) == ast.unparse(target):
            return None
        return ast.Assign([self.visit(target)], written)

    def visit_AnnAssign(self, node: ast.AnnAssign) -> Any:
        return node.value and self.visit_Assign(ast.Assign([node.target], node.value))

    def visit_If(self, node: ast.If) -> Any:
        test = self.scope.value(node.test)
        if test is not UNKNOWN:
            return self.block(node.body if test else node.orelse)
        branches = []
        for branch in (node.body, node.orelse):
            with self.scope.within(()):
                branches.append(self.block(branch))
        self.scope.forget(names_set(*node.body, *node.orelse))
        return ast.If(self.visit(node.test), *branches) if branches[0] else None

    def visit_For(self, node: ast.For) -> Any:
        over = self.scope.value(node.iter)
        self.scope.forget(names_set(node))
        if over is not UNKNOWN and not list(over):
            return None
        return ast.For(node.target, self.visit(node.iter), self.block(node.body), [])

    def visit_FunctionDef(self, node: ast.FunctionDef) -> Any:
        with self.scope.within(names_set(node.args, *node.body)):
            return self._function(node, node.name)

    def visit_Expr(self, node: ast.Expr) -> Any:
        return ast.Expr(self.visit(node.value)) if self.scope.value(node.value) is UNKNOWN else None

    def visit_Import(self, node: Any) -> None:
        self.lines.imports.add(ast.unparse(node))

    visit_ImportFrom = visit_Import  # noqa: N815 (as `ast` calls it)

    def visit_Assert(self, _node: ast.Assert) -> None:
        """Leave it out: what is refused is refused before."""

    def visit_Raise(self, _node: ast.Raise) -> None:
        """Leave it out, too."""

    def visit_With(self, node: ast.With) -> Any:
        """Write what is within: the suite's own contexts keep an engine silent."""
        own = [self.scope.module.get(ast.unparse(item.context_expr).partition("(")[0]) for item in node.items]
        if all(getattr(each, "__module__", "").startswith(SUITE) for each in own):
            return self.block(node.body)
        return self.generic_visit(node)

    def visit_IfExp(self, node: ast.IfExp) -> Any:
        test = self.scope.value(node.test)
        return self.generic_visit(node) if test is UNKNOWN else self.visit(node.body if test else node.orelse)

    def visit_BoolOp(self, node: ast.BoolOp) -> Any:
        """Leave out what decides nothing."""
        idle = isinstance(node.op, ast.And)
        values = [self.scope.value(own) for own in node.values]
        left = [
            own for own, value in zip(node.values, values, strict=True) if value is UNKNOWN or bool(value) is not idle
        ]
        return self.visit(left[0]) if len(left) == 1 else self.generic_visit(node)

    def visit_ListComp(self, node: Any) -> Any:
        with self.scope.within(names_set(node)):
            return self.generic_visit(node)

    visit_GeneratorExp = visit_DictComp = visit_Lambda = visit_ListComp  # noqa: N815

    def visit_Name(self, node: ast.Name) -> Any:
        if node.id in self.scope.local:
            if is_object(self.scope.known.get(node.id)):
                raise NotWritable(f"{node.id} is a part of the suite; allowed in a script: what the engine is given")
            return node
        found = self.scope.module.get(node.id)
        if isinstance(found, ModuleType):
            self.lines.imports.add(f"import {found.__name__}" + f" as {node.id}" * (found.__name__ != node.id))
        elif callable(found):
            self.lines.imports.add(f"from {found.__module__} import {node.id}")
        elif node.id in self.scope.module:
            self.lines.constants[node.id] = self._literal(found)
        return node

    def visit_Call(self, node: ast.Call) -> Any:
        name = node.func.id if isinstance(node.func, ast.Name) else ""
        if name.startswith("import_"):
            module = name.removeprefix("import_")
            self.lines.imports.add(f"import {module}")
            lines = list(ast.walk(tree_of(self.scope.module[name])))
            switches, starts = (
                {ast.unparse(line) for line in lines if isinstance(line, kind)} for kind in (ast.Assign, ast.Expr)
            )
            self.lines.switches |= {text for text in switches if text.startswith("sys.")}
            self.lines.starts |= {text for text in starts if text.startswith(f"{module}.") and not text.endswith("()")}
            return ast.Name(module, ast.Load())
        target = None if name in self.scope.local else self.scope.module.get(name)
        if isinstance(target, FunctionType) and target.__module__.startswith(SUITE):
            given = {own: self.scope.value(value) for own, value in _given(target, node).items()}
            known = {own: value for own, value in given.items() if is_object(value)}
            node.args = [own for own in node.args if not is_object(self.scope.value(own))]
            node.func = ast.Name(self._helper(target, known), ast.Load())
            node.args = [self.visit(own) for own in node.args]
            node.keywords = [self.visit(own) for own in node.keywords]
            return node
        return self.generic_visit(node)

    def _helper(self, function: FunctionType, known: Mapping[str, Any]) -> str:
        """Give the name of a helper, which is written once."""
        if function not in self.lines.helpers:
            outer, self.scope = self.scope, scope_of(function, known)
            self.lines.helpers[function] = self._function(tree_of(function), function.__name__)
            self.scope = outer
        return self.lines.helpers[function].name

    def _function(self, node: ast.FunctionDef, name: str) -> ast.FunctionDef:
        """Write a function without annotations, and without the arguments that are known."""
        own = node.args
        own.args = [each for each in own.args if not is_object(self.scope.known.get(each.arg))]
        for each in (*own.args, *own.kwonlyargs, own.kwarg):
            if each is not None:
                each.annotation = None
        own.defaults = [self.visit(default) for default in own.defaults]
        return ast.FunctionDef(name, own, self.block(node.body), [])

    def _literal(self, value: Any) -> ast.expr:
        """Write a value."""
        if isinstance(value, str) and len(value) > LONG_TEXT:
            return ast.Name(self.lines.models.setdefault(value, "MODEL" + "2" * len(self.lines.models)), ast.Load())
        if isinstance(value, list | tuple):
            kind = ast.List if isinstance(value, list) else ast.Tuple
            return kind([self._literal(own) for own in value], ast.Load())
        return ast.parse(repr(value.item() if isinstance(value, np.generic) else value), mode="eval").body


def _is_time_step(node: ast.expr) -> bool:
    """Whether an expression is the time step of a setting, or the one that a server is given."""
    own = node.args[0] if isinstance(node, ast.Call) and ast.unparse(node.func) == "float" else node
    if isinstance(own, ast.Subscript):
        return isinstance(own.slice, ast.Constant) and own.slice.value == "time_step"
    return isinstance(own, ast.Attribute) and own.attr == "time_step"


def _assigned(name: str, value: ast.expr) -> ast.Assign:
    return ast.Assign([ast.Name(name, ast.Store())], value)


def _pairs(target: ast.expr, value: Any) -> list[tuple[str, Any]]:
    """Give the names that are set, each with its value."""
    if isinstance(target, ast.Tuple) and isinstance(value, tuple):
        return [(own.id, part) for own, part in zip(target.elts, value, strict=True)]  # type: ignore[attr-defined]
    return [(name, value if isinstance(target, ast.Name) else UNKNOWN) for name in names_set(target)]


def _given(target: Any, call: ast.Call) -> dict[str, ast.expr]:
    """Give the arguments of a call by their names."""
    positional = dict(zip(inspect.signature(target).parameters, call.args, strict=False))
    return {**positional, **{own.arg: own.value for own in call.keywords if own.arg}}


def _with_globals(line: ast.stmt) -> ast.stmt:
    """Give a function of a script, whose names outside are those of the script."""
    if isinstance(line, ast.FunctionDef):
        line.body = [ast.Global(own.names) if isinstance(own, ast.Nonlocal) else own for own in line.body]
    return line
