"""History of an engine: plain scripts in its released versions, against the truth; what changed, and when.

A version has an environment of its own, made by uv and removed again. Scripts import the engine only, so that versions
which no adapter of the suite takes can be asked as well: blocks of `truth`, and scripts that `reproduce` prints.
"""

import json
import math
import os
import re
import shutil
import subprocess
import sys
import tempfile
import tomllib
from collections.abc import Callable, Iterator, Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, replace
from datetime import date, timedelta
from itertools import groupby, pairwise
from pathlib import Path
from types import MappingProxyType
from typing import Any, NamedTuple

import numpy as np
from packaging.version import InvalidVersion, Version

import truth
from engines.isolated.installation import run_uv
from reference_lcp.errors import ParameterError, RunError, checked_choice, shortened, shown
from reference_lcp.output import write_whole
from truth.judge import distances, read_motion
from truth.problem import problem_named

SCRIPTS = Path(truth.__file__).parent / "scripts"

PROBLEMS = ("block-held", "block-breaks-away", "block-stops", "launched-box")
"""What every version is asked."""

FEW = ("block-held", "block-stops")
"""What is asked where a problem takes more than seconds."""

CHANGED = 1e-8
"""Part of an error by which it may differ between two versions of one law: orders of sums, and solvers that stop at
another iteration."""

SMALLEST = 1e-12
"""Errors below this are round-off [m] or [m/s]."""

PRINTED = re.compile(r"^.+: (?P<value>\S+) ?(?P<unit>.*) \(exact: (?P<exact>\S+)\)$", re.MULTILINE)
"""The last line of a script that `reproduce` prints."""

DECIMALS = 8
"""Of the errors of such scripts, in the unit that they print: they print twelve digits."""

OPTION_TITLES = {"": "as it comes", "exact": "solver without tolerance"}
"""Options of scripts, for people."""

AFTERWARDS = timedelta(days=7)
"""How long after its release the other packages of a version may have been published, where they matter."""

ROOM = 500e6
"""Free space that the environment of one version needs, beside four times its wheel [B]."""


@dataclass(frozen=True)
class ReleasedEngine:
    """How versions of an engine are had."""

    package: str
    """Its name in the package index."""
    script: str
    also: tuple[str, ...] = ("numpy",)
    """Other requirements."""
    adapters: tuple[str, ...] = ()
    """Engines of the suite whose scripts it runs too."""
    kinds: tuple[str, ...] = ("joint", "contact")
    options: tuple[str, ...] = ("",)
    """Options with which everything is asked; the empty one is the engine as it comes."""
    problems: tuple[str, ...] = PROBLEMS
    of_its_time: bool = False
    """Whether a version needs other packages as they were when it was published."""
    longest_run: float = 120.0
    """Seconds after which a script is ended: most take about one."""


ENGINES: Mapping[str, ReleasedEngine] = {
    "mujoco": ReleasedEngine("mujoco", "mujoco_blocks.py", adapters=("mujoco",), options=("", "exact")),
    "pybullet": ReleasedEngine("pybullet", "pybullet_blocks.py", ("numpy<2",), ("pybullet",)),
    "rapier": ReleasedEngine("rapier3d", "rapier_blocks.py", adapters=("rapier",)),
    "exudyn": ReleasedEngine(
        "exudyn", "exudyn_blocks.py", adapters=("exudyn-regularised", "exudyn-bristle"), kinds=("zone", "bristle")
    ),
    "pymunk": ReleasedEngine("pymunk", "pymunk_blocks.py", adapters=("pymunk",)),
    "dart": ReleasedEngine("dartpy", "dart_blocks.py", adapters=("dart",)),
    "drake": ReleasedEngine("drake", "drake_blocks.py", ("numpy", "pyyaml"), ("drake",)),
    "mjx": ReleasedEngine("mujoco-mjx", "mjx_blocks.py", problems=FEW, of_its_time=True),
    "newton": ReleasedEngine(
        "newton", "newton_blocks.py", kinds=("joint",), problems=FEW, of_its_time=True, longest_run=900.0
    ),
    "sapien": ReleasedEngine("sapien", "sapien_blocks.py", ("numpy", "setuptools<81"), ("sapien",)),
    "pinocchio": ReleasedEngine(
        "pin", "pinocchio_blocks.py", adapters=("pinocchio",), kinds=("joint",), options=("", "exact")
    ),
}
"""Engines that have a script."""


class ReleasedVersion(NamedTuple):
    """A version that can be installed on this machine."""

    version: str
    date: str
    """On which it was published."""
    size: int
    """Of its wheel [B]."""
    python: str = ""
    """The Python with which it is run, such as 3.11; empty for the running one."""


@dataclass(frozen=True)
class VersionNumbers:
    """What one version gave."""

    version: str
    date: str
    numbers: Mapping[str, float]
    """Largest error of each quantity, see `metrics_of`."""
    reason: str = ""
    """Why there are none."""
    python: str = ""
    """Of its environment."""


@dataclass(frozen=True)
class VersionChange:
    """A number that differs between two versions that follow each other."""

    metric: str
    before: str
    after: str
    """The two versions."""
    old: float
    new: float

    @property
    def is_better(self) -> bool:
        """Whether the error has become smaller."""
        return self.new < self.old

    @property
    def direction(self) -> str:
        """Say so."""
        return "better" if self.is_better else "worse"

    def __str__(self) -> str:
        """Give it as a line."""
        return f"{self.metric}: {self.old:.6g} in {self.before}, {self.new:.6g} in {self.after}, {self.direction}"


def released_engine(name: str) -> ReleasedEngine:
    """Give how versions of an engine are had; a `ParameterError` if it has no script."""
    return ENGINES[checked_choice("engine", name, list(ENGINES))]


def metrics_of(engine: ReleasedEngine) -> list[str]:
    """Name the numbers of an engine: kind, problem, quantity, and the option if there is one."""
    return [
        f"{kind} {problem} {quantity}{option and f', {option}'}"
        for option in engine.options
        for kind in engine.kinds
        for problem in engine.problems
        for quantity in ("position", "velocity")
    ]


def pythons() -> list[str]:
    """Name the Pythons of this machine that uv finds, the running one first, then the newest."""
    listed = json.loads(run_uv("python", "list", "--only-installed", "--output-format", "json"))
    parts = [one["version_parts"] for one in listed if one["implementation"] == "cpython"]
    own, found = sys.version_info[:2], {(part["major"], part["minor"]) for part in parts}
    return [f"{major}.{minor}" for major, minor in (own, *sorted(found - {own}, reverse=True))]


def releases(engine: ReleasedEngine, first: str | None = None, last: str | None = None) -> list[ReleasedVersion]:
    """List the versions between two of them that have a wheel for a Python of this machine, the oldest first.

    Raises
    ------
    ParameterError
        If a version is no version, or there is none between the two.
    """
    lowest, highest = _version("--from", first), _version("--to", last)
    bounds = [*([f">={lowest}"] if lowest else []), *([f"<={highest}"] if highest else [])]
    found: list[ReleasedVersion] = []
    refused = ""
    for python in pythons():
        try:
            while True:
                others = [f"!={release.version}" for release in found]
                found.append(_newest(f"{engine.package}{','.join([*bounds, *others])}", python))
        except ParameterError as problem:
            refused = refused or str(problem)
    if not found:
        between = f"{first or 'the first'} to {last or 'the last'}"
        raise ParameterError(
            f"versions of {engine.package} from {between}: none has a wheel here ({refused}); allowed: others"
        )
    return sorted(found, key=lambda release: Version(release.version))


def _newest(requirement: str, python: str) -> ReleasedVersion:
    """Give the newest version that a requirement allows; a `ParameterError` if there is none."""
    text = run_uv(
        "pip", "compile", "--no-deps", "--only-binary", ":all:", "--format", "pylock.toml", "--prerelease", "disallow",
        "--python-version", python, "-", given=requirement,
    )  # fmt: skip
    (package,) = tomllib.loads(text)["packages"]
    wheels = package.get("wheels", [])
    return ReleasedVersion(
        str(package["version"]),
        str(max((wheel["upload-time"].date() for wheel in wheels if "upload-time" in wheel), default="")),
        max((int(wheel.get("size", 0)) for wheel in wheels), default=0),
        python,
    )


def _version(name: str, text: str | None) -> Version | None:
    try:
        return None if text is None else Version(text)
    except InvalidVersion:
        raise ParameterError(f"{name} = {shown(text)} is no version; allowed: such as 3.2 or 3.11.0") from None


def check_room(releases: Sequence[ReleasedVersion], folder: Path) -> float:
    """Give the bytes that the largest environment needs; a `ParameterError` if the disk has no room for it."""
    needed = ROOM + 4 * max(release.size for release in releases)
    free = shutil.disk_usage(folder).free
    if free < needed:
        raise ParameterError(f"{folder} has {free / 1e6:.0f} MB left; allowed: >= {needed / 1e6:.0f} MB")
    return needed


def measured(
    engine: ReleasedEngine, release: ReleasedVersion, scripts: Mapping[str, str] = MappingProxyType({})
) -> VersionNumbers:
    """Make the environment of a version, run every script in it, and remove it; `scripts` are texts by their names."""
    with tempfile.TemporaryDirectory(prefix="multibody-xval-history-") as folder:
        python = Path(folder) / "bin" / "python"
        try:
            of = ["--python", release.python] if release.python else []
            run_uv("venv", "--no-project", folder, "--allow-existing", *of)
            requirements = [f"{engine.package}=={release.version}", *engine.also]
            if engine.of_its_time and release.date:
                requirements += ["--exclude-newer", str(date.fromisoformat(release.date) + AFTERWARDS)]
            run_uv("pip", "install", "--python", str(python), "--only-binary", ":all:", *requirements)
        except ParameterError as problem:
            return VersionNumbers(release.version, release.date, {}, str(problem), release.python)
        cases = [(kind, name, option) for option in engine.options for kind in engine.kinds for name in engine.problems]
        with ThreadPoolExecutor(os.cpu_count()) as pool:
            found = list(pool.map(lambda case: _errors(engine, python, *case), cases))
            found += list(pool.map(lambda named: _printed(engine, python, *named), scripts.items()))
    numbers = {name: value for own, _ in found for name, value in own.items()}
    reason = next((why for _, why in found if why), "")
    return VersionNumbers(release.version, release.date, numbers, reason, release.python)


def _errors(engine: ReleasedEngine, python: Path, kind: str, name: str, option: str) -> tuple[dict[str, float], str]:
    """Run a script on a problem: the largest error of each quantity by its metric, or why there is none."""
    problem, file = problem_named(name), SCRIPTS.parent / "problems" / f"{name}.json"
    options = [option] if option else []
    text, reason = _output(engine, [str(python), str(SCRIPTS / engine.script), kind, str(file), *options])
    if reason:
        return {}, reason
    with tempfile.NamedTemporaryFile("w", suffix=".csv") as written:
        written.write(text[text.find("time,") :])  # what an engine prints as it is imported comes before
        written.flush()
        try:
            found = distances(problem, read_motion(written.name, problem), problem.time_step)
        except ParameterError as refused:
            return {}, str(refused)
    end = option and f", {option}"
    return {f"{kind} {name} {quantity}{end}": float(np.max(values)) for quantity, values in found.items()}, ""


def _printed(engine: ReleasedEngine, python: Path, name: str, script: str) -> tuple[dict[str, float], str]:
    """Run a script that prints its number and the exact one: the error by the name, or why there is none."""
    with tempfile.NamedTemporaryFile("w", suffix=".py") as written:
        written.write(script)
        written.flush()
        text, reason = _output(engine, [str(python), written.name])
    last = None if reason else PRINTED.search(text)
    if last is None:
        return {}, f"{name}: {reason or 'it prints no number'}"
    error = round(abs(float(last["value"]) - float(last["exact"])), DECIMALS)
    return ({name: error}, "") if math.isfinite(error) else ({}, f"{name}: {last['value']}")


def _output(engine: ReleasedEngine, command: Sequence[str]) -> tuple[str, str]:
    """Run a script: what it prints, or why it fails."""
    try:
        run = subprocess.run(command, capture_output=True, text=True, timeout=engine.longest_run, check=False)
    except subprocess.TimeoutExpired:
        return "", f"it took more than {engine.longest_run:g} s"
    if run.returncode:
        return "", shortened((run.stderr.strip().splitlines() or [f"exit code {run.returncode}"])[-1], 200)
    return run.stdout, ""


class History:
    """What versions of an engine gave, kept in a file: a killed run goes on where it was."""

    def __init__(self, name: str, file: Path | None = None):
        self.name, self.engine, self._file = name, released_engine(name), file
        self.scripts: Callable[[], Mapping[str, str]] = dict
        """Gives texts by the names of their numbers, which versions that are measured are asked beside blocks."""
        self._known: dict[str, VersionNumbers] = {}
        if file is not None and file.exists():
            self._known = _read(file, name)

    def of(self, release: ReleasedVersion) -> VersionNumbers:
        """Give what a version gave, measured now if the file does not have it."""
        if release.version not in self._known:
            self._known[release.version] = measured(self.engine, release, self.scripts())
            if self._file is not None:
                write_whole(self._file, self.as_json())
        return self._known[release.version]

    def as_json(self) -> str:
        """Give all that is known, by version."""
        ordered = sorted(self._known.values(), key=lambda one: Version(one.version))
        return json.dumps({"engine": self.name, "versions": [vars(one) for one in ordered]}, indent=1) + "\n"


def read_history(data: Any) -> tuple[str, list[VersionNumbers]]:
    """Give engine and versions of the content of a history's file; KeyError, TypeError and such if it is none."""
    versions = [
        VersionNumbers(
            str(one["version"]),
            str(one["date"]),
            {str(name): float(value) for name, value in one["numbers"].items()},
            str(one["reason"]),
            str(one.get("python", "")),
        )
        for one in data["versions"]
    ]
    return str(data["engine"]), versions


def _read(file: Path, name: str) -> dict[str, VersionNumbers]:
    try:
        engine, known = read_history(json.loads(file.read_text(encoding="utf-8")))
    except (OSError, ValueError, TypeError, KeyError, AttributeError):
        raise ParameterError(f"{file} is no history of an engine; allowed: another file") from None
    if engine != name:
        raise ParameterError(f"{file} is of {shown(engine)}; allowed: {name}")
    return {one.version: one for one in known}


def differs(old: float, new: float, tolerance: float = CHANGED) -> bool:
    """Say whether two errors differ by more than a part of the larger one, beyond round-off."""
    return abs(new - old) > max(tolerance * max(old, new), SMALLEST)


def changes(history: Sequence[VersionNumbers], tolerance: float = CHANGED) -> Iterator[VersionChange]:
    """Give every number that differs between two versions that follow each other and both have it."""
    for metric in dict.fromkeys(name for one in history for name in one.numbers):
        known = [one for one in history if metric in one.numbers]
        for old, new in pairwise(known):
            if differs(old.numbers[metric], new.numbers[metric], tolerance):
                yield VersionChange(metric, old.version, new.version, old.numbers[metric], new.numbers[metric])


def first_change(
    releases: Sequence[ReleasedVersion], number: Callable[[ReleasedVersion], float], tolerance: float = CHANGED
) -> tuple[ReleasedVersion, ReleasedVersion, float, float]:
    """Bisect: give two versions that follow each other, between which a number differs, and both numbers.

    Versions that say nothing are stepped over. It is one of several changes where there are several.

    Raises
    ------
    RunError
        If the first or the last version has no number, or both have the same.
    """
    low, high = 0, len(releases) - 1
    values = {place: number(releases[place]) for place in (low, high)}
    for place, value in values.items():
        if math.isnan(value):
            raise RunError(f"{releases[place].version} does not give this number")
    if not differs(values[low], values[high], tolerance):
        ends = f"{releases[low].version} and {releases[high].version}"
        raise RunError(f"{ends} do not differ: {values[low]:.12g} and {values[high]:.12g}")
    while high - low > 1:
        for place in sorted(range(low + 1, high), key=lambda each: abs(2 * each - low - high)):
            values[place] = number(releases[place])
            if not math.isnan(values[place]):
                break
        else:
            break
        if differs(values[low], values[place], tolerance):
            high = place
        else:
            low = place
    return releases[low], releases[high], values[low], values[high]


def history_document(name: str, history: Sequence[VersionNumbers]) -> str:
    """Give the page of an engine: what changed, every number by runs of versions, and what could not be had."""
    known = [one for one in history if one.numbers]
    lines = [f"# {name}: {len(known)} versions, {history[0].version} to {history[-1].version}", ""]
    found = list(changes(history))
    metrics = metrics_of(released_engine(name))
    printed = [each for each in dict.fromkeys(key for one in known for key in one.numbers) if each not in metrics]
    lines += [*_summary(released_engine(name), found, [*metrics, *printed]), ""]
    if found:
        lines += ["| from | to | number | before | after | |", "|---|---|---|---|---|---|"]
        for change in sorted(found, key=lambda each: Version(each.after)):
            lines.append(
                f"| {change.before} | {change.after} | {change.metric} | {change.old:.9g} | {change.new:.9g} | "
                f"{change.direction} by {abs(change.new - change.old):.2g} |"
            )
        lines.append("")
    engine = released_engine(name)
    titles = [OPTION_TITLES[option] for option in engine.options]
    lines += ["Largest error of each block against the exact motion, in m or m/s:", ""]
    lines += [f"| number | {' | '.join(titles)} |", "|---|" + "---|" * len(titles)]
    for metric in metrics_of(replace(engine, options=("",))):
        names = [metric + (option and f", {option}") for option in engine.options]
        lines.append(f"| {metric} | {' | '.join(_runs(each, known) for each in names)} |")
    if printed:
        lines += [
            "",
            "Errors of the scripts that `reproduce` prints, in their units:",
            "",
            "| script | error |",
            "|---|---|",
        ]
        lines += [f"| {metric} | {_runs(metric, known)} |" for metric in printed]
    used = [(python, [one.version for one in own]) for python, own in groupby(known, lambda one: one.python)]
    if len(used) > 1:
        parts = [f"{_span(own)} with Python {python}" for python, own in used]
        lines += ["", f"Wheels: {', '.join(parts)}."]
    for reason, alike in groupby(history, lambda one: one.reason):
        if reason:
            lines += ["", f"{_span([one.version for one in alike])}: {reason}"]
    return "\n".join(lines) + "\n"


def _summary(engine: ReleasedEngine, found: Sequence[VersionChange], metrics: Sequence[str]) -> list[str]:
    """Say in a sentence a version what has changed, by options."""
    lines = []
    for version in sorted({change.after for change in found}, key=Version):
        parts = []
        for option in engine.options:
            every = [metric for metric in metrics if metric.partition(", ")[2] == option]
            own = [change for change in found if change.after == version and change.metric in every]
            largest = max((abs(change.new - change.old) / max(change.old, change.new) for change in own), default=0.0)
            count = f"{len(own)} of {len(every)} numbers, by {largest:.1g} of the error at most" if own else "nothing"
            parts.append(f"{OPTION_TITLES[option]}: {count}")
        lines += [f"**{version}** changed {'; '.join(parts)}.", ""]
    return lines[:-1] or [f"Nothing has changed by more than {CHANGED:g} of an error."]


def _runs(metric: str, known: Sequence[VersionNumbers]) -> str:
    """Give the error of a number, once for all versions that follow each other and agree."""
    runs: list[list[VersionNumbers]] = []
    for one in (one for one in known if metric in one.numbers):
        if runs and not differs(runs[-1][-1].numbers[metric], one.numbers[metric]):
            runs[-1].append(one)
        else:
            runs.append([one])
    if len(runs) < 2:
        return "".join(f"{run[0].numbers[metric]:.4g}" for run in runs) or "–"
    return "; ".join(f"{run[0].numbers[metric]:.9g} ({_span([one.version for one in run])})" for run in runs)


def _span(versions: Sequence[str]) -> str:
    return versions[0] if len(versions) == 1 else f"{versions[0]} … {versions[-1]}"


def numbers_of(history: History, metric: str, scripts: Sequence[str] = ()) -> Callable[[ReleasedVersion], float]:
    """Give the number of a release by its name, that of a script too; a `ParameterError` if there is no such name."""
    checked_choice("metric", metric, [*metrics_of(history.engine), *scripts])
    return lambda release: history.of(release).numbers.get(metric, math.nan)
