"""Words and phrases that readers should not meet, and what to write instead.

``python docs/words.py`` prints those of the README, of these pages, of the recipes and of the help of the commands.
A test allows none in the README and in what is written by hand here.
"""

import re
import sys
from collections.abc import Iterator
from typing import NamedTuple

from commands import lines as help_of_commands
from tables import DOCS, MADE, pages

from multibody_xval.engines.interface.registry import engine, engine_names
from multibody_xval.reports.reproducers.recipe import recipe_file, recipe_text

INSTEAD = {
    r"lanes?": "chain (in a batch)",
    r"variants?": "configuration",
    r"as installed": "default options",
    r"truth": "exact solution, exact value",
    r"certified": "periodic",
    r"unsteady": "not periodic",
    r"laws?": "step model (of an engine)",
    r"unmodelled": "unexplained",
    r"verdicts?": "result",
    r"(?<!--)stores?": "results file",
    r"blocked": "not run",
    r"hop|hops|hopped|hopping": "lose contact",
    r"rub|rubs|rubbed|rubbing": "friction acts, friction is",
    r"gates?|mutants?": "check, seeded fault",
    r"beside": "next to, than",
    r"noted|noticed|led|thrifty|patient|settling|settles?|twins?": "a plain verb",
    r"(?:steps?|sweeps?|events?|points?|ms|times|rows?|once) an? (?:period|step|cell|lane|run|case|second)": "per",
    r"of one's own|of yours": "your",
    r"holds as read here": "partly confirmed",
    r"own step too coarse": "time step too large to decide",
    r"as its law predicts|that of those|those of that": "a sentence with a subject",
    r"a \w+ that is none": "a plain noun",
}
"""Patterns, with what to write."""

ALLOWED = {
    r"Coulomb['’]s laws?|friction law|[Tt]h(?:e|is) law|A law": "the friction law of physics",
    r"(?:and|compute and|engines?|suite) stores?|stores? (?:it|the|every)": "the verb",
    r"other-lane|its lanes alone|row a step in si units|variant that shares": "names of faults and clauses",
}
"""What looks like one and is none, with the reason."""


class Hit(NamedTuple):
    """A word with its place."""

    place: str
    line: int
    word: str
    instead: str


def found(place: str, text: str) -> Iterator[Hit]:
    """Give the banned words of a Markdown text: code, links and comments are left out."""
    blank = re.compile(r"```.*?```|``.*?``|`[^`\n]*`|\$\$.*?\$\$|<!--.*?-->|\]\([^)\s]*\)", re.DOTALL)
    plain = blank.sub(lambda code: re.sub(r"[^\n]", " ", code[0]), text)
    for line, words in enumerate(plain.splitlines(), start=1):
        excused = [own.span() for pattern in ALLOWED for own in re.finditer(pattern, words)]
        for pattern, instead in INSTEAD.items():
            for own in re.finditer(rf"\b(?:{pattern})\b", words, re.IGNORECASE):
                if not any(start <= own.start() and own.end() <= end for start, end in excused):
                    yield Hit(place, line, own[0], instead)


def by_hand() -> Iterator[Hit]:
    """Give those of the READMEs and of the pages, but for the parts that other texts are copied into."""
    for page in [*pages(), DOCS.parent / "scenarios/truth/README.md"]:
        text = MADE.sub(lambda part: "\n" * part[0].count("\n"), page.read_text(encoding="utf-8"))
        yield from found(str(page.relative_to(DOCS.parent)), text)


def of_the_product() -> Iterator[Hit]:
    """Give those of recipes, blocks included, and of the help of commands."""
    for name in engine_names():
        if recipe_file(engine(name)):
            yield from found(f"recipe of {name}", recipe_text(name).replace("```", ""))
    yield from found("help of commands", "\n".join(help_of_commands()))


if __name__ == "__main__":
    hits = [*by_hand(), *of_the_product()]
    for hit in hits:
        print(f"{hit.place}:{hit.line}: {hit.word} → {hit.instead}")
    print(f"{len(hits)} banned words")
    sys.exit(bool(hits))
