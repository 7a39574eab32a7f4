"""All commands with their options, from the commands themselves: a part of the page of commands (`docs/tables.py`)."""

import re
from collections.abc import Iterator
from pathlib import Path
from typing import Any

from multibody_xval.reports.cli import scenario
from multibody_xval.reports.cli.console_script import COMMANDS, loaded
from multibody_xval.reports.cli.run import STUDIES

SHARED = {*scenario.names()} - STUDIES.keys()
"""Commands that are made when they are used, and have the options of all scenarios."""


def lines() -> list[str]:
    """Give the lines of all commands."""
    found = [line for name in COMMANDS for line in _command([name], loaded(name))]
    return "\n".join(found).strip().splitlines()


def _command(path: list[str], command: Any, above: list[str] | None = None) -> Iterator[str]:
    """Give the lines of a command, then those of the ones below it, but for `SHARED`."""
    name = " ".join(path)
    yield from ("", f"{'#' * (len(path) + 2)} `{name}`", "", *_help(command.help))
    options = list(_options(command.params))
    if options and options == above:
        yield "Options: as above."
    elif options:
        yield from ("| option | what it does |", "|---|---|", *options)
    below = {child: own for child, own in getattr(command, "commands", {}).items() if child not in SHARED}
    before: list[str] = []
    for child, own in below.items():
        yield from _command([*path, child], own, before)
        before = list(_options(own.params))


def _help(text: str) -> Iterator[str]:
    """Give the paragraphs of a help, with the example as a block and without the exit codes, which have a page."""
    for paragraph in text.split("\n\n"):
        line = " ".join(paragraph.partition("Exit code 0:")[0].split())
        if line.startswith("Example: "):
            yield from ("```console", line.removeprefix("Example: "), "```", "")
        elif line:
            yield from (_escaped(line), "")


def _options(params: list[Any]) -> Iterator[str]:
    """Give a row a parameter."""
    for param in params:
        text = _escaped(" ".join((getattr(param, "help", None) or "").split()))
        if param.param_type_name == "argument":
            yield f"| `{param.metavar or param.name.upper()}` | {text} |"
        else:
            names = ", ".join(f"`{name}`" for name in [*param.opts, *param.secondary_opts])
            yield f"| {names} | {text}{_default(param)} |"


def _default(param: Any) -> str:
    """Say what holds without an option, where that is a number or a text."""
    shown = isinstance(param.default, str | int | float | Path) and not isinstance(param.default, bool)
    return f" Without it: `{param.default}`." if shown and "ithout it" not in (param.help or "") else ""


def _escaped(text: str) -> str:
    return re.sub(r"([\\*_<>|\[\]#])", r"\\\1", text)
