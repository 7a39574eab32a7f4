"""An adapter's own function as the lines of a script: what it does for one scene, with the scene's numbers in place.

A function that builds a scene is read as its source. What the scene and the preset decide is decided here: conditions,
loops over options, and what is computed of them; helpers of the adapter come along. What is left calls the
engine alone.
"""

import ast
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, fields, replace
from types import FunctionType
from typing import Any

from multibody_xval.engines.interface.scene import SteppedWorld
from multibody_xval.reports.reproducers.known_names import (
    UNKNOWN,
    Bound,
    Scope,
    arguments_of,
    asks_of,
    assigned_in,
    given_arguments,
    is_object,
    is_plain,
    loaded,
    names_in,
    outer_names,
    scope_of,
    tree_of,
)
from multibody_xval.reports.reproducers.own_expressions import Expressions, NotWritable, function_of
from multibody_xval.reports.reproducers.tidy import script_text


@dataclass
class Lines(Expressions):
    """What a script needs of an adapter, one part after the other."""

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
            elif (
                isinstance(line, ast.Assign)
                and isinstance(line.value, ast.Lambda)
                and names_in(line.targets[0]) == {"state"}
            ):
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
                given = {name.arg: value for name, value in zip(own.args.args, state.args, strict=True)}
                if loaded(value) <= set(given):
                    return _Given(given).visit(value)
        return ast.Subscript(state, ast.Constant(part), ast.Load())

    def _flat(self, build: Any, bound: Bound) -> list[ast.stmt]:
        if not isinstance(build, FunctionType):
            raise NotWritable(f"scene = {build} is a class; allowed: a function that gives a SteppedWorld")
        tree, scope = tree_of(build), scope_of(build, bound)
        *lines, last = self.block(tree.body, scope, keep_return=True)
        assert isinstance(last, ast.Return), f"{build} gives nothing"
        return [*map(_global, lines), *self._given(last.value, scope)]

    def _given(self, value: Any, scope: Scope) -> list[ast.stmt]:
        """Give the functions of a world names."""
        if isinstance(value, ast.IfExp):
            return self._given(value.body if self.value(value.test, scope) else value.orelse, scope)
        called = value.func if isinstance(value, ast.Call) else None
        target = scope.module.get(called.id) if isinstance(called, ast.Name) else None
        if target is SteppedWorld:
            names = [own.name for own in fields(SteppedWorld)]
            given = {**dict(zip(names, value.args, strict=False)), **{own.arg: own.value for own in value.keywords}}
            return [
                ast.Assign([ast.Name(name, ast.Store())], self.expression(own, scope))
                for name, own in given.items()
                if not (isinstance(own, ast.Name) and own.id == name)
            ]
        if not isinstance(target, FunctionType):
            raise NotWritable(f"scene = {ast.unparse(value)} is no world of functions; allowed: SteppedWorld(...)")
        return self._flat(
            target, {name: self.value(own, scope) for name, own in given_arguments(target, value).items()}
        )

    def text(self, first: str, frame: str) -> str:
        """Write the first line, and all that a frame, which follows, uses by its names."""
        constants: list[ast.stmt] = [
            ast.Assign([ast.Name(name, ast.Store())], value) for name, value in self.constants.items()
        ]
        lines = [*constants, *self.helpers.values(), *self.body]
        return script_text(list(self.imports), first, lines, frame)

    def block(self, lines: Sequence[ast.stmt], scope: Scope, *, keep_return: bool = False) -> list[ast.stmt]:
        """Write lines, up to the first that returns; that one as it is, if it is kept."""
        written: list[ast.stmt] = []
        for line in lines:
            if keep_return and isinstance(line, ast.Return):
                return [*written, line]
            written += self._line(line, scope)
            if written and isinstance(written[-1], ast.Return):
                break
        return written

    def _line(self, line: Any, scope: Scope) -> list[ast.stmt]:  # noqa: PLR0911 (a kind of line each)
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
                own = scope.inner(arguments_of(line) | assigned_in(line.body) - outer_names(line.body))
                return [function_of(line.name, line.args, self.block(line.body, own) or [ast.Pass()], self, own)]
            case ast.Expr():
                return self._call_alone(line.value, scope)
            case ast.With():
                for item in line.items:
                    scope.forget(names_in(item.optional_vars) if item.optional_vars else ())
                items = [
                    ast.withitem(self.expression(own.context_expr, scope), own.optional_vars) for own in line.items
                ]
                return [ast.With(items, self.block(line.body, scope))]
        return [self.parts(line, scope)]

    def _assigned(self, target: Any, value: Any, scope: Scope, more: Sequence[Any] = ()) -> list[ast.stmt]:
        if isinstance(value, ast.IfExp):
            test = self.value(value.test, scope)
            if test is not UNKNOWN:
                return self._assigned(target, value.body if test else value.orelse, scope, more)
        pairs = isinstance(target, ast.Tuple) and isinstance(value, ast.Tuple) and not more
        if pairs and len(target.elts) == len(value.elts) and not names_in(target) & loaded(value):
            each = zip(target.elts, value.elts, strict=True)
            return [line for own, part in each for line in self._assigned(own, part, scope)]
        if isinstance(target, ast.Attribute) and isinstance(value, ast.Name) and is_object(scope.known.get(value.id)):
            return []  # of a class that keeps what is known here
        found = self.value(value, scope)
        written = self.expression(value, scope) if found is UNKNOWN or is_plain(found) else None
        for own in (target, *more):
            if isinstance(own, ast.Name):
                scope.learn(own.id, found if is_plain(found) or is_object(found) else UNKNOWN)
            elif isinstance(own, ast.Tuple) and isinstance(found, tuple) and len(found) == len(own.elts):
                for name, part in zip(own.elts, found, strict=True):
                    scope.learn(name.id, part)  # type: ignore[attr-defined]
            else:
                scope.forget(names_in(own))
        if written is None and not is_object(found):
            scope.forget(names_in(target))
            written = self.expression(value, scope)
        if written is None or (
            isinstance(target, ast.Name) and isinstance(written, ast.Name) and written.id == target.id
        ):
            return []
        return [ast.Assign([self.parts(own, scope) for own in (target, *more)], written)]

    def _if(self, line: ast.If, scope: Scope) -> list[ast.stmt]:
        test = self.value(line.test, scope)
        if test is not UNKNOWN:
            return self.block(line.body if test else line.orelse, scope)
        condition = self.expression(line.test, scope)
        both = [self.block(branch, scope.inner(())) for branch in (line.body, line.orelse)]
        scope.forget(assigned_in([line]))
        return [ast.If(condition, both[0] or [ast.Pass()], both[1])] if any(both) else []

    def _loop(self, line: ast.For, scope: Scope) -> list[ast.stmt]:
        over, own = self.value(line.iter, scope), names_in(line.target)
        if isinstance(over, tuple | list) and asks_of(line.body, own, scope):
            written = []
            for value in over:
                scope.learn(line.target.id, value)  # type: ignore[attr-defined]
                written += self.block(line.body, replace(scope, literal=scope.literal | own))
            return written
        scope.forget(assigned_in([line]) | own)
        over, body = self.expression(line.iter, scope), self.block(line.body, scope)
        return [ast.For(line.target, over, body, [])] if body else []

    def _call_alone(self, call: Any, scope: Scope) -> list[ast.stmt]:
        if self.value(call, scope) is not UNKNOWN:
            return []
        written = self.expression(call, scope)
        match written:
            case ast.Call(func=ast.Name(id="setattr"), args=[of, ast.Constant(value=str(name)), value]):
                return [ast.Assign([ast.Attribute(of, name, ast.Store())], value)]
        return [ast.Expr(written)]


class _Given(ast.NodeTransformer):
    """Writes arguments in the place of their names."""

    def __init__(self, given: Mapping[str, ast.expr]):
        self._given = given

    def visit_Name(self, node: ast.Name) -> ast.AST:
        return self._given.get(node.id, node)


def _global(line: ast.stmt) -> ast.stmt:
    """Give a function of a script, whose names outside are those of the script."""
    if isinstance(line, ast.FunctionDef):
        line.body = [ast.Global(own.names) if isinstance(own, ast.Nonlocal) else own for own in line.body]
    return line
