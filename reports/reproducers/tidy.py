"""Lines of Python as a script: without what nothing uses, and in lines of a width that can be read."""

import ast
import re
import textwrap
from collections.abc import Iterable, Iterator, Mapping, Sequence

WIDTH = 116
"""Characters a line has at most, where it can be broken."""

TUPLE = re.compile(r"^( *(?:return|[\w.]+,[\w., ]+ =)) \(([^()]*(?:\([^()]*\)[^()]*)*[^,])\)$")
"""A line that gives several values in brackets."""


def used(lines: Sequence[ast.stmt], frame: str) -> list[ast.stmt]:
    """Leave out functions, and names that are only set, which neither lines nor the frame after them read."""
    kept = list(lines)
    while True:
        read = names_read([*kept, ast.parse(frame)])
        left = [line for line in kept if not _unused(line, read)]
        for line in left:
            if isinstance(line, ast.FunctionDef):
                line.body = [own for own in line.body if not _unused(own, read)] or [ast.Pass()]
        if len(list(_every(left))) == len(list(_every(kept))):
            return left
        kept = left


def names_read(lines: Iterable[ast.AST]) -> set[str]:
    """Give the names that are read, also those to which something is added."""
    nodes = list(_every(lines))
    added = {ast.unparse(node.target) for node in nodes if isinstance(node, ast.AugAssign)}
    return added | {node.id for node in nodes if isinstance(node, ast.Name) and isinstance(node.ctx, ast.Load)}


def _every(lines: Iterable[ast.AST]) -> Iterator[ast.AST]:
    return (node for line in lines for node in ast.walk(line))


def _unused(line: ast.stmt, read: set[str]) -> bool:
    if isinstance(line, ast.FunctionDef):
        return line.name not in read
    if not isinstance(line, ast.Assign) or any(isinstance(node, ast.Call) for node in ast.walk(line.value)):
        return False
    return isinstance(line.targets[0], ast.Name) and line.targets[0].id not in read


def imports_of(imports: Iterable[str], read: set[str]) -> list[str]:
    """Give the imports of names that are read."""
    names = {own: ast.parse(own).body[0].names[0] for own in imports}  # type: ignore[attr-defined]
    return sorted(own for own, name in names.items() if (name.asname or name.name.partition(".")[0]) in read)


def text_of(lines: Iterable[ast.stmt], units: Mapping[str, str]) -> str:
    """Write lines, with a blank one around functions and loops, and the units of constants."""
    blocks = []
    for line in lines:
        text = ast.unparse(ast.fix_missing_locations(line))
        unit = units.get(ast.unparse(line.targets[0])) if isinstance(line, ast.Assign) else None
        text = "\n".join(_broken(TUPLE.sub(r"\1 \2", own)) for own in text.split("\n") if own)
        around = "\n" * isinstance(line, ast.FunctionDef | ast.For | ast.If | ast.With)
        blocks.append(around + text + f"  # {unit}" * (unit is not None) + around)
    return re.sub(r"\n{3,}", "\n\n", "\n".join(blocks)).strip("\n")


def _broken(line: str) -> str:
    """Break a line that is too long, within its brackets."""
    indent = " " * (len(line) - len(line.lstrip()) + 4)
    after_commas = line.replace(" ", "\xa0").replace(",\xa0", ", ")
    filled = textwrap.fill(
        after_commas, WIDTH, subsequent_indent=indent, break_long_words=False, break_on_hyphens=False
    )
    return filled.replace("\xa0", " ")


def model_text(model: str, name: str) -> str:
    """Write a text of XML with a line an element, or more."""
    elements = model.replace("><", ">\n<").replace(" />", "/>").replace(" >", ">").split("\n")
    lines = "\n".join(line for element in elements for line in textwrap.wrap(element, WIDTH))
    return f'{name} = """\n{lines}\n"""'
