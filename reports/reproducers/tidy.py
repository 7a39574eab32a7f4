"""Lines of Python as a script: without what nothing uses, and in lines of a width that can be read."""

import ast
import io
import textwrap
import tokenize
from collections import Counter
from collections.abc import Iterable, Sequence

WIDTH = 116
"""Characters a line has at most, where it can be broken."""

SHORT = 90
"""Characters of a line of constants, at most."""

LONG_TEXT = 100
"""Characters from which on a text stands before the line that has it: a model in XML."""


def script_text(imports: Sequence[str], first: str, lines: Sequence[ast.stmt], frame: str) -> str:
    """Write a first line, and lines that a frame follows, with the imports of all."""
    tail = ast.parse(frame).body
    _rename(lines)
    kept = _used(lines, _loads(tail))
    loaded = _loads([*kept, *tail])
    wanted = [line for line in imports if {own.asname or own.name for own in _import(line).names} & loaded]
    texts: dict[str, str] = {}
    written = "\n".join(_written(_together(kept), texts))
    models = "".join(f'{name} = """\n{_broken(text)}\n"""\n' for text, name in texts.items())
    body = ast.unparse(ast.parse("\n".join(sorted(wanted)))) + f"\n\n{first}\n{models}{written}"
    return f"{body}\n{frame}"


def _import(line: str) -> ast.Import:
    found = ast.parse(line).body[0]
    assert isinstance(found, ast.Import | ast.ImportFrom), line
    return found  # type: ignore[return-value]


def _rename(lines: Sequence[ast.stmt]) -> None:
    """Call helpers as they are called without an underscore, where nothing else is called so."""
    every = [node for line in lines for node in ast.walk(line)]
    taken = {node.id for node in every if isinstance(node, ast.Name)} | {
        node.arg for node in every if isinstance(node, ast.arg)
    }
    taken |= {node.name for node in every if isinstance(node, ast.FunctionDef | ast.ClassDef)}
    helpers = [line for line in lines if isinstance(line, ast.FunctionDef | ast.ClassDef)]
    names = {own.name: own.name.strip("_") for own in helpers if own.name.strip("_") not in taken}
    for node in every:
        if isinstance(node, ast.Name):
            node.id = names.get(node.id, node.id)
    for own in helpers:
        own.name = names.get(own.name, own.name)


def _loads(lines: Iterable[ast.AST]) -> set[str]:
    """Give the names that are read, and those of attributes with a dot before."""
    every = [node for line in lines for node in ast.walk(line)]
    read = {node.id for node in every if isinstance(node, ast.Name) and not isinstance(node.ctx, ast.Store)}
    read |= {node.target.id for node in every if isinstance(node, ast.AugAssign) and isinstance(node.target, ast.Name)}
    return read | {f".{node.attr}" for node in every if isinstance(node, ast.Attribute)}


def _used(lines: Sequence[ast.stmt], roots: set[str]) -> list[ast.stmt]:
    """Leave out what nothing uses, again and again: names that are only set, functions and methods."""
    kept = [ast.parse(ast.unparse(ast.fix_missing_locations(line))).body[0] for line in lines]
    while True:
        before = sum(1 for line in kept for _ in ast.walk(line))
        kept = _without(kept, _loads(kept) | roots)
        if sum(1 for line in kept for _ in ast.walk(line)) == before:
            return kept


def _without(lines: Sequence[ast.stmt], read: set[str], dot: str = "") -> list[ast.stmt]:
    kept: list[ast.stmt] = []
    for line, after in zip(lines, [*lines[1:], None], strict=True):
        if isinstance(line, ast.FunctionDef | ast.ClassDef):
            if dot + line.name not in read and not line.name.startswith("__"):
                continue
            line.body = _without(line.body, read, "." * isinstance(line, ast.ClassDef)) or [ast.Pass()]
        elif isinstance(line, ast.For | ast.If | ast.With):
            line.body = _without(line.body, read) or [ast.Pass()]
        elif isinstance(line, ast.Assign) and _idle(line.value):
            names = {node.id for target in line.targets for node in ast.walk(target) if isinstance(node, ast.Name)}
            plain = all(isinstance(target, ast.Name | ast.Tuple) for target in line.targets)
            if plain and (not names & read or _overwritten(line, after)):
                continue
        kept.append(line)
    return kept


def _idle(value: ast.expr) -> bool:
    """Whether an expression only gives a value."""
    return not any(isinstance(node, ast.Call) for node in ast.walk(value))


def _overwritten(line: ast.Assign, after: ast.stmt | None) -> bool:
    if not isinstance(after, ast.Assign) or ast.dump(after.targets[0]) != ast.dump(line.targets[0]):
        return False
    return not _loads([after.value]) & {node.id for node in ast.walk(line.targets[0]) if isinstance(node, ast.Name)}


class _Texts(ast.NodeTransformer):
    def __init__(self, texts: dict[str, str]):
        self._texts = texts

    def visit_Constant(self, node: ast.Constant) -> ast.AST:
        if isinstance(node.value, str) and len(node.value) > LONG_TEXT:
            return ast.Name(self._texts.setdefault(node.value, "MODEL" + "2" * len(self._texts)))
        return node


def _together(lines: Sequence[ast.stmt]) -> list[ast.stmt]:
    """Put constants that follow each other into one line, as long as it is short."""
    merged: list[ast.stmt] = []
    for line in lines:
        last = merged[-1] if merged else None
        both = [own for own in (last, line) if isinstance(own, ast.Assign) and _constant(own)]
        if len(both) == 2:
            names, values = zip(*(_pairs(own) for own in both), strict=True)
            joint = ast.Assign([ast.Tuple([*names[0], *names[1]])], ast.Tuple([*values[0], *values[1]]))
            text = ast.unparse(ast.fix_missing_locations(joint)).replace("(", "", 1)
            if len(text) <= SHORT:
                merged[-1] = joint
                continue
        merged.append(line)
    return merged


def _constant(line: ast.Assign) -> bool:
    own = line.targets[0]
    names = own.elts if isinstance(own, ast.Tuple) else [own]
    upper = all(isinstance(name, ast.Name) and name.id.isupper() for name in names)
    return upper and not any(isinstance(node, ast.Name | ast.Call) for node in ast.walk(line.value))


def _pairs(line: ast.Assign) -> tuple[list[ast.expr], list[ast.expr]]:
    own, value = line.targets[0], line.value
    return (own.elts, value.elts) if isinstance(own, ast.Tuple) else ([own], [value])  # type: ignore[attr-defined]


def _written(lines: Sequence[ast.stmt], texts: dict[str, str]) -> Iterable[str]:
    """Write lines one by one, with a blank one around functions."""
    functions = Counter[bool]()
    was = True
    for line in lines:
        block = isinstance(line, ast.FunctionDef | ast.ClassDef)
        if functions.total() and (block or was):
            yield ""
        was = block
        functions[block] += 1
        text = ast.unparse(ast.fix_missing_locations(_Texts(texts).visit(line)))
        for own in text.split("\n"):
            if own:
                yield from _lines(own)


def _lines(line: str) -> Iterable[str]:
    """Break a line within brackets, where it is too long."""
    indent, within = len(line) - len(line.lstrip()) + 4, 0
    while len(line) > WIDTH:
        places = [place for place in _commas(line, within) if indent < place < WIDTH]
        if not places:
            break
        yield line[: places[-1] + 1]
        line, within = " " * indent + line[places[-1] + 1 :].lstrip(), 1
    yield line


def _commas(line: str, depth: int) -> list[int]:
    """Give the commas of a line that stand within brackets, of which so many are open before."""
    places = []
    try:
        for token in tokenize.generate_tokens(io.StringIO(line.strip() + "\n").readline):
            depth += (token.string in "([{") - (token.string in ")]}") if token.type == tokenize.OP else 0
            if token.string == "," and token.type == tokenize.OP:
                places.append((depth, token.start[1]))
    except tokenize.TokenError:
        pass  # the rest of a line that has been broken
    begin = len(line) - len(line.lstrip())
    return [begin + place for depth, place in places if depth > 0]


def _broken(model: str) -> str:
    """Give a text of XML with a line an element, or more."""
    elements = model.replace("><", ">\n<").replace(" />", "/>").replace(" >", ">").split("\n")
    return "\n".join(line for element in elements for line in textwrap.wrap(element, WIDTH))
