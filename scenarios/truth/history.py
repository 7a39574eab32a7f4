"""Blocks of truth in released versions of an engine: its plain script, in environments that uv makes and drops."""

import os
import re
import shutil
import sys
from collections.abc import Callable, Iterator, Sequence
from functools import partial
from io import StringIO
from pathlib import Path
from subprocess import PIPE, CompletedProcess, Popen, TimeoutExpired, run
from time import monotonic
from typing import Any

import pandas as pd
from packaging.version import Version

from multibody_xval.engines.interface.texts import shortened, visible
from multibody_xval.scenarios.output_files import RunError, write_whole
from multibody_xval.scenarios.table_text import csv_text
from multibody_xval.scenarios.terminal_table import tracked
from multibody_xval.scenarios.truth import Motion, judged, problem_named
from reference_lcp.errors import ParameterError, checked_choice

FOLDER = Path(__file__).parent
SCRIPTS = {file.name.removesuffix("_blocks.py"): file for file in sorted(FOLDER.glob("scripts/*_blocks.py"))}
PACKAGES = {name: {"dart": "dartpy", "pinocchio": "pin", "rapier": "rapier3d"}.get(name, name) for name in SCRIPTS}
BLOCKS, MODELS = ("block-held", "block-breaks-away", "block-stops", "launched-box"), ("joint", "contact")
TEXTS, NUMBERS = ("version", "released", "problem", "status"), ("number [m]", "exact [m]", "off by [m]", "seconds")
COLUMNS = [*TEXTS[:3], *NUMBERS, TEXTS[3]]
INSTALL_SECONDS, RUN_SECONDS, NOT_INSTALLED = 600.0, 60.0, "does not install"
Uv = Callable[..., CompletedProcess[str]]


def uv_found() -> Uv:
    """Give what runs uv; it and pip take the package index that one of them is told of, by a variable or pip.conf."""
    uv = shutil.which("uv", path=f"{os.environ.get('PATH', '')}{os.pathsep}{Path(sys.executable).parent}")
    if uv is None:
        raise ParameterError("uv = not found; allowed: uv on the PATH; `pip install uv` installs it")
    ask = [sys.executable, "-m", "pip", "config", "list"]
    conf = re.search(r"\.index-url='(.+)'", run(ask, capture_output=True, text=True, check=False).stdout)
    pip_index = os.environ.get("PIP_INDEX_URL") or (conf and conf[1])
    index = os.environ.get("UV_DEFAULT_INDEX") or os.environ.get("UV_INDEX_URL") or pip_index
    return partial(_run, uv, {"PIP_INDEX_URL": pip_index or index, "UV_DEFAULT_INDEX": index} if index else {})


def _run(uv: str, indices: dict[str, str], *words: str, seconds: float = RUN_SECONDS, text: str = "") -> Any:
    """Run uv; of what it complains, the end is kept, in one line."""
    pipes: Any = {"stdin": PIPE, "stdout": PIPE, "stderr": PIPE, "encoding": "utf-8", "errors": "replace"}
    with Popen([uv, *words], env=os.environ | indices, **pipes) as process:
        try:
            out, problem = process.communicate(text, seconds)
        except TimeoutExpired:
            process.terminate()  # uv passes it on to what it runs
            out, problem = process.communicate()[0], f"stopped after {seconds:g} s"
    lines = [visible(line.strip()) for line in problem.splitlines() if line.strip()]
    return CompletedProcess(words, process.returncode, out, shortened("; ".join(lines[-2:]), 300))


def versions(engine: str, uv: Uv) -> list[str]:
    """Give the versions that the package index has for this Python, the oldest first."""
    listed = uv("tool", "run", "--python", sys.executable, "pip", "index", "versions", PACKAGES[engine])
    if found := re.search(r"^Available versions: (.+)", listed.stdout, re.MULTILINE):
        return [str(each) for each in sorted(map(Version, found[1].split(", ")))]
    raise RunError(f"the package index gives no version of {PACKAGES[engine]}: {listed.stderr}")


def chosen(known: Sequence[str], named: str | None, last: int) -> list[str]:
    """Give the versions that are named, or the last patch of each minor one, as many of the newest as asked."""
    if named is None:
        return list({Version(name).release[:2]: name for name in known}.values())[-last:]
    return list(dict.fromkeys(checked_choice("versions", name.strip(), known) for name in named.split(",")))


def stored(file: Path) -> pd.DataFrame:
    """Read the rows of earlier commands."""
    try:
        table = pd.read_csv(file, dtype=dict.fromkeys(TEXTS, str)) if file.exists() else pd.DataFrame(columns=COLUMNS)
        return _in_order(table[COLUMNS].astype(dict.fromkeys(NUMBERS, float)).fillna(dict.fromkeys(TEXTS, "")))
    except (ValueError, KeyError) as problem:
        raise ParameterError(f"{file} is no file of history: {visible(str(problem))}; allowed: its own") from None


def _in_order(table: pd.DataFrame) -> pd.DataFrame:
    return table.sort_values("version", key=lambda own: own.map(Version), kind="stable", ignore_index=True)


def add_missing(table: pd.DataFrame, engine: str, names: Sequence[str], file: Path, uv: Uv) -> pd.DataFrame:
    """Run the versions that a table lacks, write it after each, and give it, the oldest version first."""
    table = table[~table.version.isin(names) | ~table.status.str.startswith(NOT_INSTALLED)]
    for name in tracked([own for own in names if own not in set(table.version)], "versions"):
        rows = pd.DataFrame(_measured(engine, name, uv), columns=COLUMNS)
        table = _in_order(pd.concat([table, rows]) if len(table) else rows)
        write_whole(file, csv_text(table, missing=""))
    return table


def _measured(engine: str, version: str, uv: Uv) -> Iterator[dict[str, Any]]:
    wanted, script = f"{PACKAGES[engine]}=={version}", SCRIPTS[engine]
    lock = uv("pip", "compile", "-", "--no-deps", "--format", "pylock.toml", text=wanted).stdout
    row = {"version": version, "released": min(re.findall(r"upload-time = (\d{4}-\d\d-\d\d)", lock), default="")}
    python = ["run", "--no-project", "--isolated", "--python", sys.executable, "--with", wanted, "python"]
    installed = uv(*python, "-c", "", seconds=INSTALL_SECONDS)
    if installed.returncode:
        yield {**row, "problem": "all", "status": f"{NOT_INSTALLED}: {installed.stderr}"}
        return
    for model in [own for own in MODELS if f"def {own}(" in script.read_text(encoding="utf-8")]:
        for name in BLOCKS:
            began = monotonic()
            done = uv(*python, str(script), model, str(FOLDER / f"problems/{name}.json"))
            own = {**row, "problem": f"{name}, {model}", "seconds": round(monotonic() - began, 2)}
            yield own | ({"status": f"fails: {done.stderr}"} if done.returncode else _judged(name, done.stdout))


def _judged(name: str, text: str) -> dict[str, Any]:
    """Give where the block is in the end, and whether the whole motion agrees with the exact one."""
    problem = problem_named(name)
    try:
        rows = pd.read_csv(StringIO(text), dtype=float)[["time", "x0", "v0"]].dropna().to_numpy()
        verdict = judged(problem, Motion(rows[:, 0], rows[:, 1:2], rows[:, 2:])).verdict[0]
    except (ValueError, KeyError) as refused:
        return {"status": f"fails: {visible(str(refused))}"}
    number, exact = rows[-1, 1], problem.positions[-1][0]
    return dict(zip([*NUMBERS[:3], "status"], (number, exact, abs(number - exact), verdict), strict=True))
