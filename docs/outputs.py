"""Runs the examples of pages and writes what they print below them.

An example is a block of Python or of a console after the comment ``run``; what it prints stands in the block of text
that follows. All examples of a page run in order, in one empty folder; Python keeps its names from one to the next.
Pictures that they write there replace those of the same name in `_static` that the page shows.

python docs/outputs.py README.md docs/quick_start.md     writes the outputs anew, and the pictures
python docs/outputs.py --check README.md                 prints what differs, and ends with 1 if anything does
"""

import io
import math
import os
import re
import shutil
import subprocess
import sys
import tempfile
from collections.abc import Iterator
from contextlib import chdir, redirect_stdout
from pathlib import Path
from typing import Any

STATIC = Path(__file__).parent / "_static"

PLUGIN = Path(__file__).parents[1] / "tests" / "plugin"
"""The engine that the page about engines of others shows."""

EXAMPLE = re.compile(
    r"<!-- run -->\n```(?P<kind>python|console)\n(?P<code>.*?)```\n(?P<gap>```text\n)?(?(gap)(?P<shown>.*?)```\n)",
    re.DOTALL,
)
SECONDS = re.compile(r"\d[\d.]* (?=s\b|min\b)")
NUMBER = re.compile(r"[-−]?\d[\d,]*\.?\d*(?:e[-+]\d+)?")

CLOSE, NOTHING = 0.02, 1e-6
"""By how much numbers may differ between machines, as a part; smaller ones are round-off and equal."""


def printed(kind: str, code: str, names: dict[str, Any]) -> str:
    """Run an example and give its standard output, without trailing spaces."""
    if kind == "python":
        with redirect_stdout(io.StringIO()) as out:
            exec(compile(code, "example", "exec"), names)
        text = out.getvalue()
    else:
        command = re.sub(r"^multibody-xval\b", f"{sys.executable} -m multibody_xval", code, flags=re.MULTILINE)
        command = re.sub(r"^pytest\b", f"{sys.executable} -m pytest", command, flags=re.MULTILINE)
        done = subprocess.run(["bash", "-ec", command], stdout=subprocess.PIPE, text=True, check=False)
        text = done.stdout
    return "\n".join(line.rstrip() for line in text.strip("\n").splitlines()) + "\n" if text.strip() else ""


def outputs(page: str) -> Iterator[tuple[re.Match[str], str]]:
    """Run all examples of a page in the working folder: each with what it prints."""
    names: dict[str, Any] = {"__name__": "example"}
    for found in EXAMPLE.finditer(page):
        yield found, printed(found["kind"], found["code"], names)


def with_outputs(page: str) -> str:
    """Give a page with its outputs as they are now."""
    parts, end = [], 0
    for found, text in outputs(page):
        block = f"```text\n{text}```\n" if text else ""
        parts += [page[end : found.start()], f"<!-- run -->\n```{found['kind']}\n{found['code']}```\n", block]
        end = found.end()
    return "".join([*parts, page[end:]])


def alike(shown: str, now: str) -> bool:
    """Tell whether two outputs have the same words and, but for what machines differ in, the same numbers."""
    shown, now = SECONDS.sub("", shown), SECONDS.sub("", now)
    if NUMBER.sub("#", shown).split() != NUMBER.sub("#", now).split():
        return False
    one, other = (
        [float(own.replace("−", "-").replace(",", "")) for own in NUMBER.findall(text)] for text in (shown, now)
    )
    return all(math.isclose(*pair, rel_tol=CLOSE, abs_tol=NOTHING) for pair in zip(one, other, strict=True))


def main(check: bool, files: list[Path]) -> int:
    """Write or check the outputs of pages; give the exit code."""
    os.environ |= {"MPLBACKEND": "Agg", "COLUMNS": "80", "NO_COLOR": "1"}
    sys.path.append(str(PLUGIN))
    wrong = 0
    for file in (path.resolve() for path in files):
        page = file.read_text(encoding="utf-8")
        with tempfile.TemporaryDirectory() as folder, chdir(folder):
            if check:
                for found, now in outputs(page):
                    if not alike(found["shown"] or "", now):
                        wrong += 1
                        print(f"{file.name}:\n{found['code']}\nshown:\n{found['shown']}\nnow:\n{now}")
            else:
                file.write_text(with_outputs(page), encoding="utf-8")
                for picture in Path(folder).glob("*.svg"):
                    if f"_static/{picture.name})" in page:
                        shutil.copy(picture, STATIC)
    return min(wrong, 1)


if __name__ == "__main__":
    arguments = [own for own in sys.argv[1:] if own != "--check"]
    sys.exit(main("--check" in sys.argv, [*map(Path, arguments)]))
