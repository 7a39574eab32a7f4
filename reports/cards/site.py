"""A static site of engines by version, of histories and cards: an index, a page an engine, a feed of what changed."""

import json
import math
import re
from collections import defaultdict
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from datetime import UTC, datetime
from functools import cached_property
from pathlib import Path
from typing import Any

from packaging.version import InvalidVersion, Version
from scenarios.studies.history import VersionChange, VersionNumbers, changes, read_history

from reference_lcp.errors import ParameterError, shown
from reference_lcp.output import checked_output_folder, write_whole
from reports.cards.write import TEMPLATES
from reports.formatting import environment
from reports.page.section import SUITE_TEMPLATES

INDEX, FEED = "index.html", "feed.xml"

NAME = re.compile(r"[a-z0-9][a-z0-9-]*")
"""Names of engines; each is a file of the site."""

WIDTH, HEIGHT, MARGIN = 160.0, 28.0, 3.0
"""Of a line over versions [px]."""


@dataclass(frozen=True)
class EngineHistory:
    """The versions of one engine, the oldest first, and what changed between them."""

    name: str
    versions: tuple[VersionNumbers, ...]

    @cached_property
    def changes(self) -> list[VersionChange]:
        """Numbers that differ between two versions that follow each other, the newest first."""
        return sorted(changes(self.versions), key=lambda change: Version(change.after), reverse=True)

    @property
    def metrics(self) -> list[str]:
        """Names of all numbers."""
        return list(dict.fromkeys(name for one in self.versions for name in one.numbers))

    def line(self, metric: str) -> str:
        """Give a number over the versions as the points of a line, its logarithm upwards."""
        known = [(place, one.numbers[metric]) for place, one in enumerate(self.versions) if metric in one.numbers]
        heights = [math.log10(value) if value > 0 else -16.0 for _, value in known]
        low, size = min(heights), max(max(heights) - min(heights), 1e-3)
        last = max(len(self.versions) - 1, 1)
        places = [MARGIN + place / last * (WIDTH - 2 * MARGIN) for place, _ in known]
        rises = [HEIGHT - MARGIN - (height - low) / size * (HEIGHT - 2 * MARGIN) for height in heights]
        return " ".join(f"{x:.1f},{y:.1f}" for x, y in zip(places, rises, strict=True))


def engine_histories(folder: Path) -> list[EngineHistory]:
    """Read all histories and cards in a folder and below it.

    Raises
    ------
    ParameterError
        If there is none, or a file is not what its name says.
    """
    found: dict[str, dict[str, VersionNumbers]] = defaultdict(dict)
    for file in sorted(folder.rglob("*.json")):
        if file.name.endswith((".bench.json", ".badge.json")):
            continue
        for name, measured in _read(file):
            before = found[name].get(measured.version, VersionNumbers(measured.version, measured.date, {}))
            numbers = {**before.numbers, **measured.numbers}
            found[name][measured.version] = VersionNumbers(
                measured.version, measured.date or before.date, numbers, measured.reason or before.reason
            )
    if not found:
        raise ParameterError(
            f"{folder} has neither a history nor a card; allowed: files of `history --store` or `card`"
        )
    return [
        EngineHistory(name, tuple(sorted(versions.values(), key=lambda one: Version(one.version))))
        for name, versions in sorted(found.items())
    ]


def _read(file: Path) -> Iterator[tuple[str, VersionNumbers]]:
    """Give the versions of an engine in a file: a history has several, a card one."""
    try:
        data: Any = json.loads(file.read_text(encoding="utf-8"))
        name, known = read_history(data) if "engine" in data else _of_card(data)
        for one in known:
            Version(one.version)
    except (OSError, ValueError, TypeError, KeyError, AttributeError, InvalidVersion, RecursionError):
        raise ParameterError(f"{file} is neither a history nor a card; allowed: another folder") from None
    for one in known:
        if not NAME.fullmatch(name) or not all(map(math.isfinite, one.numbers.values())):
            raise ParameterError(f"engine = {shown(name)} of {file}; allowed: small letters, and finite numbers")
        yield name, one


def _of_card(data: Mapping[str, Any]) -> tuple[str, list[VersionNumbers]]:
    """Give the errors of a card, by formulation and preset."""
    numbers: dict[str, float] = {}
    for own in data["variants"]:
        variant = str(own["variant"]).partition(":")[2] or "joint:tuned"
        if own["largest_db"] is not None:
            numbers[f"{variant}: error to truth, largest [dB]"] = float(own["largest_db"])
        for row in own["rows"]:
            if row["value"] is not None:
                unit = f" [{row['unit']}]" if row["unit"] else ""
                numbers[f"{variant}: error of {row['name']}, {row['case']}{unit}"] = abs(row["value"] - row["exact"])
    return str(data["name"]).partition("@")[0], [VersionNumbers(str(data["version"]), "", numbers)]


def write_site(histories: Sequence[EngineHistory], folder: Path) -> list[Path]:
    """Write the pages and the feed; gives them, the index first."""
    checked_output_folder("--out", folder)
    pages = environment(TEMPLATES, SUITE_TEMPLATES)
    texts = {INDEX: pages.get_template("site_index.html").render(engines=histories, feed=FEED)}
    for own in histories:
        texts[f"{own.name}.html"] = pages.get_template("site_engine.html").render(
            engine=own, index=INDEX, width=WIDTH, height=HEIGHT
        )
    texts[FEED] = pages.get_template("site_feed.xml").render(entries=_entries(histories))
    for name, text in texts.items():
        write_whole(folder / name, text)
    return [folder / name for name in texts]


def _entries(histories: Sequence[EngineHistory]) -> list[dict[str, str]]:
    """Give an entry of the feed for each version that changed something, the newest first."""
    entries = []
    for own in histories:
        dates = {one.version: one.date for one in own.versions}
        for version in dict.fromkeys(change.after for change in own.changes):
            lines = [str(change) for change in own.changes if change.after == version]
            day = dates[version] or f"{datetime.now(UTC):%Y-%m-%d}"
            entries.append(
                {"engine": own.name, "version": version, "updated": f"{day}T00:00:00Z", "text": "\n".join(lines)}
            )
    return sorted(entries, key=lambda entry: entry["updated"], reverse=True)
